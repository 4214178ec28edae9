/** What the application asks of the view. */

import type { Slot } from "../model/slot.ts";
import type { View } from "../model/view.ts";
import type { Deformed, Files, Opened } from "../worker/protocol.ts";
import type { BoundWeights } from "./weights.ts";

export interface Display {
  /** Shows another shape; resolves when it is to be seen. Tells whether the file has materials or colours of its own. */
  showShape(opened: Opened, files: Files): Promise<{ hasAppearance: boolean }>;
  /** False where the GPU cannot hold them. Undefined: there are none. */
  setWeights(slot: Slot, weights: BoundWeights | undefined): boolean;
  showFrame(slot: Slot, positions: Float64Array, maps: Float64Array): void;
  setView(view: View): void;
  focus(what: "all" | "selection"): void;
  /** Ends a drag as if it had not been; false where there was none. */
  cancel(): boolean;
  /** A small picture of the view, as the address of an image; "" where there is none. */
  thumbnail(): string;
  /** A picture of the view (PNG). */
  picture(): Promise<Blob>;
  /** The shape at rest with the deformed one as a morph target (GLB). */
  morphTarget(deformed: Deformed): Promise<Uint8Array<ArrayBuffer>>;
  /** One page that holds the shape and its weights, to be dragged offline (HTML). */
  page(title: string): Promise<string>;
}
