/** Moves of control points: of their targets (a drag), or of their places at rest (which asks for a new fit). */

import { mirrorOrientation, mirrorVector, twinOf } from "../model/mirror.ts";
import { type Orientation, type Quaternion, rotatedBy, sameOrientation } from "../model/orientation.ts";
import { type ControlPoint, find, type Moves, piece, type PointId, type Session, stays } from "../model/session.ts";
import { add, equal, subtract, type Vec3 } from "../model/vec3.ts";
import type { Command } from "./history.ts";
import { change } from "./points.ts";

/** Moves the selected control points to where `to` takes their targets (or places). Twins follow, locked ones stay. */
export function moveSelected(session: Session, moves: Moves, to: (place: Vec3) => Vec3): Session {
  const axis = session.settings.mirror;
  const led = leading(session);
  let next = change(session, led, (point) => movedTo(session, point, moves, to(point[moves])));
  if (axis === null) return next;
  for (const id of led) {
    const [twin, before, after] = [twinOf(session, id), find(session, id), find(next, id)];
    if (twin === undefined || !before || !after || before === after) continue;
    next = change(next, [twin], (point) => {
      const by = mirrorVector(
        // Targets mirror the whole displacement, so that twins that had parted come together again.
        moves === "target" ? subtract(after.target, after.position) : subtract(after.position, before.position),
        axis,
      );
      return movedTo(session, point, moves, add(point.position, by));
    });
  }
  return next;
}

/** The selected control points but for twins of others that are: a twin of the leader follows it even if it is selected too. */
function leading(session: Session): PointId[] {
  const followers = new Set<PointId>();
  return [...session.selection].reverse().filter((id) => {
    if (followers.has(id)) return false;
    const twin = session.settings.mirror === null ? undefined : twinOf(session, id);
    if (twin !== undefined) followers.add(twin);
    return true;
  });
}

/**
 * Rotates the selected control point, or those of several that are oriented already: the others of several rotate by where they go.
 * Twins follow, locked ones stay.
 */
export function rotateSelected(session: Session, by: Quaternion): Session {
  const axis = session.settings.mirror;
  const alone = session.selection.length === 1;
  let next = session;
  for (const id of leading(session)) {
    const before = find(session, id);
    if (!before || stays(session, before) || !(alone || before.orientation)) continue;
    const orientation = rotatedBy(before.orientation, by);
    next = change(next, [id], (point) => orientedTo(session, point, orientation));
    const twin = axis === null ? undefined : twinOf(session, id);
    if (axis === null || twin === undefined) continue;
    next = change(next, [twin], (point) => orientedTo(session, point, mirrorOrientation(orientation, axis)));
  }
  return next;
}

function orientedTo(session: Session, point: ControlPoint, orientation: Orientation): ControlPoint {
  return stays(session, point) || sameOrientation(point.orientation, orientation) ? point : { ...point, orientation };
}

function movedTo(session: Session, point: ControlPoint, moves: Moves, place: Vec3): ControlPoint {
  if (equal(point[moves], place) || stays(session, point)) return point;
  if (moves === "target") return { ...point, target: place };
  // Its displacement stays as it is.
  return { ...point, position: place, target: add(point.target, subtract(place, point.position)) };
}

/** Moves the selected control points by `by`. */
export function nudge(moves: Moves, by: Vec3): Command {
  return {
    label: "Nudge",
    mergeKey: `nudge ${moves}`,
    apply: (session) => moveSelected(session, moves, (place) => add(place, by)),
  };
}

/** Puts the target (or place) of one control point at a place that was typed; its group goes along. */
export function put(id: PointId, moves: Moves, place: Vec3): Command {
  return {
    label: "Move",
    apply(session) {
      if (!place.every(Number.isFinite)) return session;
      if (moves === "position" && session.points.some((other) => other.id !== id && equal(other.position, place))) {
        return session;
      }
      const point = find(session, id);
      if (!point) return session;
      const selection = piece(session, point).map((one) => one.id);
      const by = subtract(place, point[moves]);
      // Itself to the last bit.
      const moved = moveSelected({ ...session, selection }, moves, (from) => (from === point[moves] ? place : add(from, by)));
      return moved.points === session.points ? session : { ...moved, selection: session.selection };
    },
  };
}

/** Takes control points back to their places at rest, and to no orientation: the selected ones, or all. Locked ones stay where they are. */
export function resetTargets(which: "selected" | "all"): Command {
  return {
    label: "Reset",
    apply(session) {
      const ids = which === "all" ? session.points.map((point) => point.id) : session.selection;
      return change(session, ids, (point) => {
        const { orientation, ...plain } = point;
        return movedTo(session, orientation && !stays(session, point) ? plain : point, "target", point.position);
      });
    },
  };
}
