/** Control points that arrive: where to aim so that they do, by the core (crates/core/src/aim). */

import type { ControlPoint } from "./session.ts";
import type { Settings } from "./settings.ts";

/** What of a control point says with what it moves, and whether. */
export type Hold = Pick<ControlPoint, "group" | "locked">;

/** Where to aim, and what local maps follow where the control points around them leave something open. Overwritten by the next. */
export interface Aim {
  /** Effective targets, m x 3 in file units, which go with the targets without a jump; the targets themselves where they are left soft. */
  readonly targets: Float64Array;
  /** Of the map that fits all control points with equal weights: row-major 3 x 3. */
  readonly rotation: Float32Array;
  readonly scale: number;
  readonly linear: Float32Array;
  /** Of each control point its rotation times its scale, m x 9, NaN for one that has none: its own, or its group's. */
  readonly orientations: Float64Array;
}

export interface Handles {
  /** The square of each control point's distance to the nearest other one, in file units: what an oriented one counts by. */
  readonly squares: Float64Array;
  /**
   * For the targets (m x 3 in file units) and orientations (m x 9, as `orientationsOf` has them) of the control points, and what holds
   * them (undefined: one that is not there any more). Computed at once: 0.1 to 0.3 ms for a dozen control points.
   */
  aim(
    targets: Float64Array,
    orientations: Float64Array | undefined,
    settings: Settings,
    holds: readonly (Hold | undefined)[],
  ): Aim;
  /** Gives the memory back. */
  free(): void;
}

/** What the shader's arithmetic takes from the core's (crates/core/src/mls). */
export interface Constants {
  /** How much the map of all control points counts against the local moments, relative to their size. */
  readonly anchorWeight: number;
  /** What stands for a missing extent of the control points, relative to the one that they have. */
  readonly ridge: number;
}
