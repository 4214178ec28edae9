/** How a control point is oriented: a rotation about an axis and a scale, as session files have them. */

import { distance, type Vec3 } from "./vec3.ts";

export interface Orientation {
  /** Not all 0, of any length; in the plane (0, 0, 1). Seen from its tip, positive angles turn counterclockwise. */
  readonly axis: Vec3;
  readonly degrees: number;
  /** How much larger what is near becomes; > 0. */
  readonly scale: number;
}

/** x, y, z, w; of length 1. */
export type Quaternion = readonly [number, number, number, number];

/** Row-major 3 x 3. */
export type Rotation = [number, number, number, number, number, number, number, number, number];

/** Closer to no rotation than double precision tells. */
const NONE = 1e-12;

export function quaternionOf({ axis, degrees }: Orientation): Quaternion {
  const half = ((degrees % 360) * Math.PI) / 360;
  const by = Math.sin(half) / Math.hypot(...axis);
  return [axis[0] * by, axis[1] * by, axis[2] * by, Math.cos(half)];
}

/** A control point's orientation, rotated further. */
export function rotatedBy(orientation: Orientation | undefined, [x, y, z, w]: Quaternion): Orientation {
  const [a, b, c, d] = orientation ? quaternionOf(orientation) : [0, 0, 0, 1];
  const product = [w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a, w * c + x * b - y * a + z * d];
  const real = w * d - x * a - y * b - z * c;
  const side = real < 0 ? -1 : 1;
  const length = Math.hypot(...product);
  const scale = orientation?.scale ?? 1;
  if (length < NONE) return { axis: [0, 0, 1], degrees: 0, scale };
  const [i, j, k] = product.map((part) => (side * part) / length + 0);
  return { axis: [i, j, k], degrees: (2 * Math.atan2(length, side * real) * 180) / Math.PI, scale };
}

export function sameOrientation(a: Orientation | undefined, b: Orientation | undefined): boolean {
  if (!a || !b) return a === b;
  return distance(a.axis, b.axis) === 0 && a.degrees === b.degrees && a.scale === b.scale;
}

/** The rotation of an orientation, without its scale. */
export function rotationOf(orientation: Orientation): Rotation {
  const length = Math.hypot(...orientation.axis);
  const [x, y, z] = orientation.axis.map((c) => c / length);
  const angle = ((orientation.degrees % 360) * Math.PI) / 180;
  const [s, c] = [Math.sin(angle), 1 - Math.cos(angle)];
  return [
    1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y,
    c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x,
    c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y),
  ]; // prettier-ignore
}

/** What the core takes: of each control point its rotation times its scale, NaN for one that has none; undefined where none has. */
export function orientationsOf(list: readonly (Orientation | undefined)[]): Float64Array | undefined {
  if (!list.some(Boolean)) return undefined;
  const flat = new Float64Array(9 * list.length).fill(Number.NaN);
  list.forEach((orientation, i) => orientation && flat.set(rotationOf(orientation).map((e) => e * orientation.scale), 9 * i));
  return flat;
}
