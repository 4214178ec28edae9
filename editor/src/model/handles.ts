/** Control points that arrive: where to aim so that they do, by the core (crates/core/src/exact.rs). */

import type { Settings } from "./settings.ts";

export interface Handles {
  /**
   * Effective targets for the targets of the control points, both m x 3 in file units; the targets themselves where control points are
   * left soft. `turns` (m x 9) as `turnsOf` has them. Computed at once: 0.1 to 0.3 ms for a dozen control points.
   */
  aim(targets: Float64Array, settings: Pick<Settings, "transform" | "temperature" | "adherence"> & { turns?: Float64Array }): Float64Array;
  /** Gives the memory back. */
  free(): void;
}

/** Why control points are left where plain moving least squares takes them, though more adherence is set. */
export interface Soft {
  /** One has too little of the weight at its own place, or would stay off its target all the same. */
  readonly reason: "shared" | "unreached";
  /** Which one. */
  readonly index: number;
  /** The weight that it has there, or the distance that it would stay off. */
  readonly amount: number;
  /** With what they would arrive, tried: a temperature, or the affine map. */
  readonly remedy: number | "affine" | null;
}
