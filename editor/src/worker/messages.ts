/** The messages between `remote.ts` and `worker.ts`: what a worker can be asked, and what it gives. */

import type { Advice, Fitted, Landed, Motion, Opened, Saved, Stage, WeightsSpec } from "./protocol.ts";

/** Questions and answers by name. A worker holds at most one shape, one set of points and one fit. */
export interface Operations {
  /** Reads a shape and keeps it; gives its exact positions (n x dim) too, for the workers that fit. */
  open: { ask: { files: [string, Uint8Array][]; name: string }; give: { opened: Opened; x: Float64Array<ArrayBuffer> } };
  /** Takes points to fit weights to. */
  load: { ask: { x: Float64Array; dim: number }; give: null };
  fit: { ask: { controlPoints: Float64Array; weights: WeightsSpec }; give: Fitted };
  deform: { ask: { motion: Motion; maps: boolean }; give: Moved };
  land: { ask: { motion: Motion }; give: Landed };
  /** Places all over the shape, for `advise` (k x dim). */
  sample: { ask: { count: number }; give: Float64Array<ArrayBuffer> };
  advise: { ask: { motion: Motion; places: Float64Array }; give: Advice[] };
  /** The shape's file with other positions; null: as it was read. */
  write: { ask: { name: string; moved: Moved | null }; give: Saved };
  farthestPoints: { ask: { count: number; seed: number }; give: Float64Array<ArrayBuffer> };
}

/** New positions (n x dim) and local maps (n x dim x dim) where they were asked for. */
export interface Moved {
  positions: Float64Array<ArrayBuffer>;
  maps: Float64Array<ArrayBuffer> | null;
}

export type Operation = keyof Operations;
export type Ask<O extends Operation> = Operations[O]["ask"];
export type Give<O extends Operation> = Operations[O]["give"];

/** The first message to a worker is the compiled core; then come these. */
export interface Question<O extends Operation = Operation> {
  id: number;
  operation: O;
  ask: Ask<O>;
}

export type Answer =
  | { id: number; kind: "progress"; stage: Stage; fraction: number }
  | { id: number; kind: "done"; give: Give<Operation> }
  /** A sentence for a person. */
  | { id: number; kind: "refused"; message: string }
  /** The core is in an unknown state: the worker must be ended. */
  | { id: number; kind: "crashed"; message: string };
