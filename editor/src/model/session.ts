/** A session: the control points and all that is set. Never changed in place, so that undo is to take the former one. */

import type { Orientation } from "./orientation.ts";
import type { Settings } from "./settings.ts";
import { equal, type Vec3 } from "./vec3.ts";

export type PointId = number;

/** A control point: where it is at rest (p) and where it is moved to (q), in the units of the shape's file. */
export interface ControlPoint {
  readonly id: PointId;
  readonly name: string;
  readonly position: Vec3;
  readonly target: Vec3;
  /** How it rotates what is near it; without it, it does not resist rotations. */
  readonly orientation?: Orientation;
  /** How closely it is to be met, 0 to 1, of what the handles are set to. */
  readonly weight: number;
  /** It stays as it is at rest, and holds what is around it; moves pass it over. */
  readonly locked: boolean;
  /** Control points of one group move as one piece; one of them that is locked keeps all. */
  readonly group?: string;
  /** What a file has of it besides: keys of other programs. Kept. */
  readonly others?: object;
}

/** What a move moves: where control points are moved to, or where they are at rest. */
export type Moves = "target" | "position";

/** Two control points of which a move of one moves the other, mirrored. */
export type Pair = readonly [PointId, PointId];

export interface Session {
  readonly points: readonly ControlPoint[];
  /** The last one leads: numbers are shown for it, and its twin follows it. */
  readonly selection: readonly PointId[];
  readonly pairs: readonly Pair[];
  readonly settings: Settings;
  /** The box in which weights are trained, where a file says it; else that of the shape. */
  readonly frame?: object;
  /** Keys of other programs, and the editor's own that this one does not know. Kept. */
  readonly others: object;
}

export const emptySession = (settings: Settings): Session => ({ points: [], selection: [], pairs: [], settings, others: {} });

export const isMoved = (point: ControlPoint): boolean => point.orientation !== undefined || !equal(point.position, point.target);

export function find(session: Session, id: PointId): ControlPoint | undefined {
  return session.points.find((point) => point.id === id);
}

/** The selected control points in the order of the list. */
export function selected(session: Session): ControlPoint[] {
  const ids = new Set(session.selection);
  return session.points.filter((point) => ids.has(point.id));
}

/** The selected control point that leads. */
export function leader(session: Session): ControlPoint | undefined {
  const last = session.selection.at(-1);
  return last === undefined ? undefined : find(session, last);
}

/** The others of a control point's group, and itself. */
export function piece(session: Session, { id, group }: ControlPoint): readonly ControlPoint[] {
  return session.points.filter((point) => point.id === id || (group !== undefined && point.group === group));
}

/** Whether it stays at rest. */
export const stays = (session: Session, point: ControlPoint): boolean => piece(session, point).some(({ locked }) => locked);

export function nextId(session: Session): PointId {
  return session.points.reduce((most, point) => Math.max(most, point.id), 0) + 1;
}

/** The first of p1, p2 ... that are free. */
export function freeNames(session: Session, count: number): string[] {
  const taken = new Set(session.points.map((point) => point.name));
  const names: string[] = [];
  for (let i = 1; names.length < count; i++) {
    if (!taken.has(`p${i}`)) names.push(`p${i}`);
  }
  return names;
}
