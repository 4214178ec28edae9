/** Control points that carry a rotation, as `crates/core/src/mls/oriented.rs` has them. */

import { rotationOf, type Rotation, type Turn } from "../model/turn.ts";

/** A control point that is turned. */
export interface TurnedPoint {
  /** Which one. */
  index: number;
  /** Row-major. */
  rotation: Rotation;
  scale: number;
  /** The square of the distance to the nearest other control point; 1 if there is none. */
  square: number;
}

/** The turned ones of the control points `p`, m x 3. */
export function turnedPoints(p: Float64Array, turns: readonly (Turn | undefined)[]): TurnedPoint[] {
  return turns.flatMap((turn, index) => {
    if (!turn) return [];
    let least = Infinity;
    for (let i = 0; i < p.length; i += 3) {
      const square = [0, 1, 2].reduce((sum, c) => sum + (p[i + c] - p[3 * index + c]) ** 2, 0);
      if (square > 0) least = Math.min(least, square);
    }
    return [{ index, rotation: rotationOf(turn), scale: turn.scale, square: least < Infinity ? least : 1 }];
  });
}

/** Whether a control point is as it was. */
export const isStill = ({ rotation, scale }: TurnedPoint): boolean =>
  scale === 1 && rotation.every((e, at) => e === (at % 4 === 0 ? 1 : 0));
