/** How a control point is turned: a rotation about an axis and a scale, as control-point files have them. */

import { mirrorVector } from "./mirror.ts";
import { type Axis, distance, subtract, type Vec3 } from "./vec3.ts";

export interface Turn {
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

export function quaternionOf({ axis, degrees }: Turn): Quaternion {
  const half = ((degrees % 360) * Math.PI) / 360;
  const by = Math.sin(half) / Math.hypot(...axis);
  return [axis[0] * by, axis[1] * by, axis[2] * by, Math.cos(half)];
}

/** A control point's turn, turned further. */
export function turnedBy(turn: Turn | undefined, [x, y, z, w]: Quaternion): Turn {
  const [a, b, c, d] = turn ? quaternionOf(turn) : [0, 0, 0, 1];
  const product = [w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a, w * c + x * b - y * a + z * d];
  const real = w * d - x * a - y * b - z * c;
  const side = real < 0 ? -1 : 1;
  const length = Math.hypot(...product);
  const scale = turn?.scale ?? 1;
  if (length < NONE) return { axis: [0, 0, 1], degrees: 0, scale };
  const [i, j, k] = product.map((part) => (side * part) / length + 0);
  return { axis: [i, j, k], degrees: (2 * Math.atan2(length, side * real) * 180) / Math.PI, scale };
}

/** Mirrored: what of the axis lies in the mirror's plane turns round. */
export function mirrorTurn(turn: Turn, axis: Axis): Turn {
  return { ...turn, axis: subtract([0, 0, 0], mirrorVector(turn.axis, axis)) };
}

export function sameTurn(a: Turn | undefined, b: Turn | undefined): boolean {
  if (!a || !b) return a === b;
  return distance(a.axis, b.axis) === 0 && a.degrees === b.degrees && a.scale === b.scale;
}

/** The rotation of a turn, without its scale. */
export function rotationOf(turn: Turn): Rotation {
  const length = Math.hypot(...turn.axis);
  const [x, y, z] = turn.axis.map((c) => c / length);
  const angle = ((turn.degrees % 360) * Math.PI) / 180;
  const [s, c] = [Math.sin(angle), 1 - Math.cos(angle)];
  return [
    1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y,
    c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x,
    c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y),
  ]; // prettier-ignore
}

const NO_TURN: readonly number[] = new Array<number>(9).fill(Number.NaN);

/** What the core takes: of each control point its rotation times its scale, NaN for one that is not turned; nothing where none is. */
export function turnsOf(turned: readonly (Turn | undefined)[]): { turns?: Float64Array } {
  if (!turned.some(Boolean)) return {};
  return { turns: Float64Array.from(turned.flatMap((turn) => (turn ? rotationOf(turn).map((e) => e * turn.scale) : NO_TURN))) };
}
