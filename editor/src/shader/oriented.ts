/** Control points that carry a rotation, as `crates/core/src/mls/oriented.rs` has them. */

import type { Rotation } from "../model/orientation.ts";

export interface OrientedPoint {
  /** Which one. */
  index: number;
  /** Row-major. */
  rotation: Rotation;
  scale: number;
  /** The square of the distance to the nearest other control point, in the units of `p`. */
  square: number;
}

/**
 * The oriented ones of control points: `orientations` as the core has them, m x 9; `squares` in units of which the shader's are
 * `unit` long.
 */
export function orientedPoints(orientations: Float64Array, squares: Float64Array, unit: number): OrientedPoint[] {
  return [...squares].flatMap((square, index) => {
    const scaled = orientations.subarray(9 * index, 9 * index + 9);
    if (Number.isNaN(scaled[0])) return [];
    // Each row has its own: beyond the dimension of the file there is none.
    const scales = [0, 3, 6].map((at) => Math.hypot(scaled[at], scaled[at + 1], scaled[at + 2]));
    const rotation = [...scaled].map((e, at) => e / scales[Math.floor(at / 3)]) as Rotation;
    return [{ index, rotation, scale: scales[0], square: square / unit ** 2 }];
  });
}

/** Whether a control point is as it was. */
export const isStill = ({ rotation, scale }: OrientedPoint): boolean =>
  scale === 1 && rotation.every((e, at) => e === (at % 4 === 0 ? 1 : 0));
