/** Control points that arrive: where to aim so that they do, by the core (crates/core/src/aim). */

import type { Settings } from "./settings.ts";

export interface Handles {
  /**
   * Effective targets for the targets of the control points, both m x 3 in file units, which go with them without a jump; the targets
   * themselves where control points are left soft. `turns` (m x 9) as `turnsOf` has them. Computed at once: 0.1 to 0.3 ms for a dozen control points.
   */
  aim(targets: Float64Array, settings: Pick<Settings, "transform" | "temperature" | "adherence"> & { turns?: Float64Array }): Float64Array;
  /** Gives the memory back. */
  free(): void;
}

/** Why control points do not arrive as the adherence says. */
export interface Soft {
  /** One has too little of the weight at its own place, so that all are left soft; or they go as far as they can, and one stays off. */
  readonly reason: "shared" | "unreached";
  /** Which one. */
  readonly index: number;
  /** The weight that it has there, or the distance that it stays off. */
  readonly amount: number;
  /** With what they would arrive, tried: a temperature, or the affine map. */
  readonly remedy: number | "affine" | null;
}
