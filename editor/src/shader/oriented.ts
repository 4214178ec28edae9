/** Control points that carry a rotation, as `crates/core/src/mls/oriented.rs` has them. */

import { type Orientation, type Rotation, rotationOf } from "../model/orientation.ts";

export interface OrientedPoint {
  /** Which one. */
  index: number;
  /** Row-major. */
  rotation: Rotation;
  scale: number;
  /** The square of the distance to the nearest other control point, in the units of `p`. */
  square: number;
}

/** The oriented ones of control points; `squares` in units of which the shader's are `unit` long. */
export function orientedPoints(orientations: readonly (Orientation | undefined)[], squares: Float64Array, unit: number): OrientedPoint[] {
  return orientations.flatMap((orientation, index) => {
    if (!orientation) return [];
    return [{ index, rotation: rotationOf(orientation), scale: orientation.scale, square: squares[index] / unit ** 2 }];
  });
}

/** Whether a control point is as it was. */
export const isStill = ({ rotation, scale }: OrientedPoint): boolean =>
  scale === 1 && rotation.every((e, at) => e === (at % 4 === 0 ? 1 : 0));
