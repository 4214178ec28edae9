/** What is set for the whole shape: the weight function, the map, the temperature, the mirror. */

import type { Axis } from "./vec3.ts";

export type Transform = "rigid" | "similarity" | "affine";
export const TRANSFORMS: readonly Transform[] = ["rigid", "similarity", "affine"];

export type WeightsKind = "neural" | "classic";

/** Parameters of the neural weights. `steps` null: until every control point has 0.9 of the weight at its own place. */
export interface NeuralParameters {
  readonly width: number;
  readonly seed: number;
  readonly steps: number | null;
}

/** Parameters of the classic weights, `1 / (d^(2 alpha) + epsilon)`, d in units of half of the box's longest side. */
export interface ClassicParameters {
  readonly alpha: number;
  readonly epsilon: number;
}

export interface Settings {
  readonly kind: WeightsKind;
  readonly neural: NeuralParameters;
  readonly classic: ClassicParameters;
  readonly transform: Transform;
  readonly temperature: number;
  /** How far control points are taken from near their targets (0, the paper) towards them (1: they arrive). */
  readonly adherence: number;
  /** The axis across which twins are mirrored; null: no mirroring. */
  readonly mirror: Axis | null;
}

/** As `neuralmls deform` has them. */
export const DEFAULT_SETTINGS: Settings = {
  kind: "neural",
  neural: { width: 1024, seed: 0, steps: null },
  classic: { alpha: 1, epsilon: 0 },
  transform: "rigid",
  temperature: 1,
  adherence: 1,
  mirror: null,
};

/** What the logits depend on besides the control points' places: the same key, the same logits. */
export function weightsKey(settings: Settings): string {
  return JSON.stringify(settings.kind === "neural" ? settings.neural : settings.classic);
}

const within = (low: number, high: number) => (value: unknown): value is number =>
  typeof value === "number" && value >= low && value <= high;
const isWhole = (low: number, high: number) => (value: unknown): value is number =>
  within(low, high)(value) && Number.isInteger(value);

/** Settings out of a file: what is missing or out of its range is as by default. */
export function settingsFrom(found: unknown): Settings {
  const source = asRecord(found);
  const neural = asRecord(source.neural);
  const classic = asRecord(source.classic);
  const take = <T>(value: unknown, accepts: (value: unknown) => value is T, otherwise: T): T =>
    accepts(value) ? value : otherwise;
  const oneOf = <T>(...values: T[]) => (value: unknown): value is T => values.includes(value as T);
  const { neural: n, classic: c, ...rest } = DEFAULT_SETTINGS;
  return {
    kind: take(source.kind, oneOf<WeightsKind>("neural", "classic"), rest.kind),
    neural: {
      width: take(neural.width, isWhole(1, 16384), n.width),
      seed: take(neural.seed, isWhole(0, Number.MAX_SAFE_INTEGER), n.seed),
      steps: take<number | null>(neural.steps, isWhole(1, 100_000), n.steps),
    },
    classic: {
      alpha: take(classic.alpha, within(Number.MIN_VALUE, 100), c.alpha),
      epsilon: take(classic.epsilon, within(0, 1e6), c.epsilon),
    },
    transform: take(source.transform, oneOf(...TRANSFORMS), rest.transform),
    temperature: take(source.temperature, within(1e-3, 1e3), rest.temperature),
    adherence: take(source.adherence, within(0, 1), rest.adherence),
    mirror: take(source.mirror, oneOf<Axis | null>("x", "y", "z", null), rest.mirror),
  };
}

export function asRecord(value: unknown): Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Record<string, unknown>) : {};
}
