/** The messages between `remote.ts` and `worker.ts`: what a worker can be asked, and what it gives. */

import type { Advice, Fitted, Opened, Report, Saved, SessionDocument, Stage } from "./protocol.ts";

/** Questions and answers by name. A worker holds at most one shape, one set of points and one fit. */
export interface Operations {
  /** Reads a shape and keeps it; gives its exact positions (n x dim) too, for the workers that fit. */
  open: { ask: { files: [string, Uint8Array][]; name: string }; give: { opened: Opened; x: Float64Array<ArrayBuffer> } };
  /** Takes points to fit weights to. */
  load: { ask: { x: Float64Array; dim: number; triangles: Uint32Array | null }; give: null };
  fit: { ask: { session: SessionDocument }; give: Fitted };
  deform: { ask: { session: SessionDocument; maps: boolean }; give: Moved };
  report: { ask: { session: SessionDocument }; give: Report };
  advise: { ask: { session: SessionDocument }; give: Advice[] };
  /** The text of a session file, with the frame of the fit. */
  sessionText: { ask: { session: SessionDocument }; give: string };
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
