/** Twins across a plane of symmetry, which is perpendicular to an axis and goes through the middle of the shape's box. */

import type { Orientation } from "./orientation.ts";
import type { ControlPoint, Pair, PointId, Session } from "./session.ts";
import { type Axis, axisIndex, distance, subtract, type Vec3 } from "./vec3.ts";

/** How far off its mirror image a twin may be, relative to half of the box's longest side. */
const TOLERANCE = 0.05;

/** A displacement, mirrored. */
export function mirrorVector(v: Vec3, axis: Axis): Vec3 {
  const mirrored: [number, number, number] = [...v];
  mirrored[axisIndex(axis)] = -v[axisIndex(axis)];
  return mirrored;
}

/** A place, mirrored at the plane through `centre`. */
export function mirrorPoint(v: Vec3, axis: Axis, centre: Vec3): Vec3 {
  const mirrored: [number, number, number] = [...v];
  mirrored[axisIndex(axis)] = 2 * centre[axisIndex(axis)] - v[axisIndex(axis)];
  return mirrored;
}

/** Mirrored: what of the axis lies in the mirror's plane turns round. */
export function mirrorOrientation(orientation: Orientation, axis: Axis): Orientation {
  return { ...orientation, axis: subtract([0, 0, 0], mirrorVector(orientation.axis, axis)) };
}

/** Whether a place is so close to the plane that it is its own twin. */
export function isOnPlane(v: Vec3, axis: Axis, centre: Vec3, half: number): boolean {
  return Math.abs(v[axisIndex(axis)] - centre[axisIndex(axis)]) < 0.5 * TOLERANCE * half;
}

/** Pairs of control points that are each other's nearest mirror image. */
export function findPairs(points: readonly ControlPoint[], axis: Axis, centre: Vec3, half: number): Pair[] {
  const twinOf = points.map((point) => {
    if (isOnPlane(point.position, axis, centre, half)) return -1;
    const image = mirrorPoint(point.position, axis, centre);
    let [best, nearest] = [-1, TOLERANCE * half];
    points.forEach((other, j) => {
      const away = distance(other.position, image);
      if (other !== point && away <= nearest) [best, nearest] = [j, away];
    });
    return best;
  });
  return twinOf.flatMap((j, i) => (j > i && twinOf[j] === i ? [[points[i].id, points[j].id] as const] : []));
}

/** The twin of a control point, if it has one. */
export function twinOf(session: Session, id: PointId): PointId | undefined {
  const pair = session.pairs.find(([a, b]) => a === id || b === id);
  return pair && (pair[0] === id ? pair[1] : pair[0]);
}
