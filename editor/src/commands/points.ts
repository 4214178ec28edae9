/** Commands on control points: add, remove, name, lock, group. */

import { isOnPlane, mirrorPoint, mirrorVector } from "../model/mirror.ts";
import { type ControlPoint, find, freeNames, isMoved, nextId, type PointId, type Session } from "../model/session.ts";
import { add, equal, subtract, type Vec3 } from "../model/vec3.ts";
import type { Command } from "./history.ts";

/** The middle and half of the longest side of the shape's box. */
export interface Box {
  readonly centre: Vec3;
  readonly half: number;
}

/** A place for a control point: at rest, and where the shape is moved to there. */
export interface Place {
  readonly position: Vec3;
  readonly target: Vec3;
}

/** Adds a control point and selects it; with a mirror set, its twin too, unless it lies on the plane. */
export function addPoint(place: Place, box: Box): Command {
  return {
    label: "Add control point",
    apply(session) {
      const axis = session.settings.mirror;
      const withTwin = axis !== null && !isOnPlane(place.position, axis, box.centre, box.half);
      if (!withTwin) return withPoints(session, [place]);
      const position = mirrorPoint(place.position, axis, box.centre);
      const target = add(position, mirrorVector(subtract(place.target, place.position), axis));
      const next = withPoints(session, [place, { position, target }]);
      if (next === session) return session;
      const [a, b] = next.selection;
      if (b === undefined) return next;
      return { ...next, pairs: [...next.pairs, [a, b]], selection: [a] };
    },
  };
}

/** Adds many control points and selects them. */
export function addPoints(places: readonly Place[]): Command {
  return { label: `Place ${places.length} control points`, apply: (session) => withPoints(session, places) };
}

/** The same, but control points that are neither moved nor held give way to them. */
export function placeAnew(places: readonly Place[]): Command {
  return {
    label: `Place ${places.length} control points`,
    apply(session) {
      const points = session.points.filter((point) => point.locked || point.group !== undefined || isMoved(point));
      const stays = new Set(points.map((point) => point.id));
      const pairs = session.pairs.filter(([a, b]) => stays.has(a) && stays.has(b));
      return withPoints({ ...session, points, selection: [], pairs }, places);
    },
  };
}

function withPoints(session: Session, places: readonly Place[]): Session {
  // Two control points at one place cannot both have it.
  const fresh = places.filter((place) => !session.points.some((point) => equal(point.position, place.position)));
  if (fresh.length === 0) return session;
  const names = freeNames(session, fresh.length);
  const first = nextId(session);
  const added = fresh.map((place, i): ControlPoint => ({ id: first + i, name: names[i], ...place, weight: 1, locked: false }));
  return { ...session, points: [...session.points, ...added], selection: added.map((point) => point.id) };
}

/** Removes the selected control points. */
export function removeSelected(): Command {
  return {
    label: "Delete",
    apply(session) {
      const gone = new Set(session.selection);
      if (gone.size === 0) return session;
      const pairs = session.pairs.filter(([a, b]) => !gone.has(a) && !gone.has(b));
      return { ...session, points: session.points.filter(({ id }) => !gone.has(id)), selection: [], pairs };
    },
  };
}

/** Names a control point; a name that is empty or taken changes nothing. */
export function rename(id: PointId, name: string): Command {
  const trimmed = name.trim();
  return {
    label: "Rename",
    apply(session) {
      const taken = session.points.some((point) => point.name === trimmed);
      return trimmed === "" || taken ? session : change(session, [id], (point) => ({ ...point, name: trimmed }));
    },
  };
}

/** Locks the control points if any of them is free, else frees them. */
export function toggleLock(ids: readonly PointId[]): Command {
  return {
    label: "Lock or free",
    apply(session) {
      const locked = ids.some((id) => find(session, id)?.locked === false);
      return change(session, ids, (point) => (point.locked === locked ? point : { ...point, locked }));
    },
  };
}

/** Makes one group of control points, whichever groups they were in. */
export function group(ids: readonly PointId[]): Command {
  return {
    label: "Group",
    apply(session) {
      if (ids.length < 2) return session;
      const name = freeGroup(session);
      return change(session, ids, (point) => ({ ...point, group: name }));
    },
  };
}

/** Takes control points out of their groups. */
export function ungroup(ids: readonly PointId[]): Command {
  return {
    label: "Ungroup",
    apply: (session) => change(session, ids, (point) => {
      const { group: before, ...free } = point;
      return before === undefined ? point : free;
    }),
  };
}

/** The first of group 1, group 2 ... that is free. */
function freeGroup(session: Session): string {
  const taken = new Set(session.points.map((point) => point.group));
  let i = 1;
  while (taken.has(`group ${i}`)) i++;
  return `group ${i}`;
}

/** Replaces some control points; the same session where none of them changes. */
export function change(
  session: Session,
  ids: readonly PointId[],
  how: (point: ControlPoint) => ControlPoint,
): Session {
  const wanted = new Set(ids);
  let changed = false;
  const points = session.points.map((point) => {
    const next = wanted.has(point.id) ? how(point) : point;
    changed ||= next !== point;
    return next;
  });
  return changed ? { ...session, points } : session;
}
