/** What is set for the whole shape. Defaults, ranges and the sentences about them are the core's (crates/session). */

import type { Axis } from "./vec3.ts";

export type Transform = "rigid" | "similarity" | "affine";

/** Parameters of the neural weights. `steps` null: until every control point has 0.9 of the weight at its own place. */
export interface NeuralParameters {
  readonly width: number;
  readonly seed: number;
  readonly steps: number | null;
}

/** Parameters of `1 / (d^(2 alpha) + epsilon)`, d in units of half of the frame's longest side. */
export interface InverseDistanceParameters {
  readonly alpha: number;
  readonly epsilon: number;
}

/** The parameters of each kind of weights, as a session file has them: with those that the editor does not know. */
export interface Weights {
  readonly neural: NeuralParameters;
  readonly "inverse-distance": InverseDistanceParameters;
  readonly "shape-aware": object;
}

export type WeightsKind = keyof Weights;

/** How closely control points arrive at their targets; a number: the part of the way from where `soft` leaves them. */
export type HandlesSetting = "auto" | "exact" | "soft" | number;

export interface Settings {
  readonly kind: WeightsKind;
  /** Those of the other kinds too, for when they are chosen or compared with. */
  readonly weights: Weights;
  readonly transform: Transform;
  readonly temperature: number;
  readonly handles: HandlesSetting;
  /** How far the elastic finish goes, 0 to 1. */
  readonly relax: number;
  /** The axis across which twins are mirrored; null: no mirroring. */
  readonly mirror: Axis | null;
  /** Keys of other programs, kept. */
  readonly others: object;
}

/** What stands beside the shape: the weights that are edited are compared with these. */
export const otherKind = (kind: WeightsKind): WeightsKind => (kind === "neural" ? "inverse-distance" : "neural");
