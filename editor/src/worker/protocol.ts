/**
 * What the main thread and the workers say to each other. The rest of the editor talks to `CoreClient` (client.ts) only.
 *
 * All coordinates are in the units of the shape's file and in double precision, but for `Opened.positions`, which are relative to
 * the shape's box. Symbols as in ARCHITECTURE.md: x points, p control points, q targets, n points, m control points.
 */

import type { Handles, Soft } from "../model/handles.ts";
import type { Transform } from "../model/settings.ts";
import type { Slot } from "../model/slot.ts";
import type { Vec3 } from "../model/vec3.ts";

export type { Handles, Slot, Soft, Transform, Vec3 };

/** Files that belong together, by name: a shape, its materials, textures and buffers. */
export type Files = ReadonlyMap<string, Uint8Array>;

/** A shape as the editor shows it. */
export interface Opened {
  /** The main file's name. */
  name: string;
  /** "OBJ", "PLY", "OFF", "STL", "glTF", "GLB", "XYZ/CSV" or "NPY". */
  format: string;
  /** Endings of files of this format, without the dot. */
  extensions: string[];
  /** Coordinates a point in the file: 3, or 1 or 2 for narrow tables. Here they are always 3; the missing ones are 0. */
  dim: 1 | 2 | 3;
  /** n */
  count: number;
  /** `x_file = centre + half * x`; `half` is half of the box's longest side. */
  frame: Frame;
  /** (x_file - centre) / half, n x 3, in [-1, 1]. */
  positions: Float32Array<ArrayBuffer>;
  /** Triangles, f x 3, indices into the points; null for a cloud. N-gons are fans. */
  triangles: Uint32Array<ArrayBuffer> | null;
  /** The box in file units. */
  bounds: { min: Vec3; max: Vec3 };
  /** What else the file holds, for a person to read: ["materials", "oak, steel"]. */
  facts: [string, string][];
  hasNormals: boolean;
  /** Files that it names: buffers, images, material libraries. */
  namedFiles: string[];
  /** Sentences for a toast: named files that were not given. */
  warnings: string[];
}

export interface Frame {
  centre: Vec3;
  half: number;
}

/** A weight function. */
export type WeightsSpec =
  | {
      kind: "neural";
      /** Neurons a hidden layer: 1 to 16384. */
      width: number;
      /** An integer from 0 on. */
      seed: number;
      /** A fixed number; null: until every control point has 0.9 of the weight at its own place (at most 2000). */
      steps: number | null;
    }
  | {
      kind: "classic";
      /** > 0 */
      alpha: number;
      /** >= 0, in units of half of the box's longest side */
      epsilon: number;
    };

/** A weight function evaluated. */
export interface Fitted {
  /** m */
  controlPoints: number;
  /** n x m, row by row (point by point). +Infinity is possible for classic weights with epsilon 0. */
  logits: Float32Array<ArrayBuffer>;
  /** m x m: the logits at the control points' own places; softmax(row i / T)[i] is the weight that i has there. */
  ownLogits: Float32Array<ArrayBuffer>;
  /** Mean cross-entropy after the training; null for classic weights. */
  loss: number | null;
  /** Steps that were trained; 0 for classic weights. */
  steps: number;
  /** Milliseconds of the training (0 for classic weights), and of the evaluation at the points. */
  milliseconds: { train: number; evaluate: number };
  /**
   * Control points that the whole training did not part from others (own weight below 0.85 at temperature 1), and which stop short of
   * their targets, for a warning as the command line's. Empty for classic weights and for a fixed number of steps.
   */
  shared: number[];
}

/** How the control points are moved. */
export interface Motion {
  /** m x 3 in file units (for narrow tables the missing coordinates are passed over). */
  targets: Float64Array;
  /** m x 9: how each turns, a rotation times a scale, row-major; NaN for those that do not say. Without it none does. */
  turns?: Float64Array;
  transform: Transform;
  temperature: number;
  /** From 0, near the targets, to 1, onto them; control points that this would harm are left soft. */
  adherence: number;
}

/** Where the control points land. */
export interface Landed {
  /** m x 3 in file units */
  places: Float64Array<ArrayBuffer>;
  /** Why they do not arrive as the adherence says, if they do not. */
  soft: Soft | null;
}

/** The core's result, for checks, statistics and where the GPU has no float textures. */
export interface Deformed {
  /** n x 3 in file units. */
  positions: Float64Array<ArrayBuffer>;
  /** The local maps M, row-major, n x 9. */
  maps: Float64Array<ArrayBuffer>;
  landed: Landed;
}

/** One thing that is likely bad about a deformation (crates/core/src/advice.rs). */
export interface Advice {
  kind: "folds" | "torn" | "ungoverned";
  /** The part of the shape that is folded; the greatest stretch; how many spacings of the control points away. */
  amount: number;
  /** The control points next to the worst place, by their numbers. */
  near: number[];
  /** What at least halves it, tried: another temperature, or soft handles; and the part of the shape that is left. */
  better: number | "soft" | null;
  left: number;
}

/** Files to be given to the person: the shape first, then its changed side files (buffers of a .gltf). */
export interface Saved {
  files: { name: string; bytes: Uint8Array<ArrayBuffer> }[];
}

/** Tells how far a call is: a stage, and the fraction of it done (0 to 1). */
export type OnProgress = (stage: Stage, fraction: number) => void;
export type Stage = "read" | "train" | "evaluate" | "deform" | "write";

export interface CallOptions {
  progress?: OnProgress;
  /** Aborting rejects the promise with a DOMException called "AbortError", at once. */
  signal?: AbortSignal;
}

/** The core, as the editor sees it. Every promise is rejected with a `CoreError` (one sentence for a person) or an AbortError. */
export interface Core {
  /**
   * Reads a shape. The open one stays as it is until this one has been read: a refused file changes nothing.
   * `name` is a key of `files`; the others are what it may name.
   */
  open(files: Files, name: string, options?: CallOptions): Promise<Opened>;
  /**
   * Fits weights to the control points (m x 3, file units, m >= 1) and evaluates them at the points of the open shape. A newer fit
   * of the same slot aborts this one. The fit of the slot "main" is what `deform`, `land` and `save` use.
   */
  fit(controlPoints: Float64Array, weights: WeightsSpec, options?: CallOptions & { slot?: Slot }): Promise<Fitted>;
  /** Deforms by the last fit of the slot; waits for one that is on its way. */
  deform(motion: Motion, options?: CallOptions & { slot?: Slot }): Promise<Deformed>;
  /** Where the control points land: cheap, for each one's distance to its target. */
  land(motion: Motion, options?: CallOptions & { slot?: Slot }): Promise<Landed>;
  /** What is likely bad about a deformation; nothing where all is well. */
  advise(motion: Motion, options?: CallOptions): Promise<Advice[]>;
  /** Exact handles for this thread; `controlPoints` (m x 3) and `ownLogits` (m x m) of a fit to the open shape. */
  handles(controlPoints: Float64Array, ownLogits: Float32Array): Promise<Handles>;
  /**
   * The open shape's file with the core's double-precision result; `motion` null: as it was read, byte for byte. `name` is the new
   * file's name; changed side files are called after it.
   */
  save(name: string, motion: Motion | null, options?: CallOptions): Promise<Saved>;
  /** `count` places spread over the open shape, count x 3 in file units, by the rule of `neuralmls points` (placement.rs). */
  farthestPoints(count: number, seed?: number, options?: CallOptions): Promise<Float64Array<ArrayBuffer>>;
  /** Ends the workers. */
  close(): void;
}

/** What was wrong, in one sentence for a person. */
export class CoreError extends Error {
  override name = "CoreError";
}

/*
 * Control-point files (JSON and CSV) are read and written in the model layer by docs/control-points.md and its schema, not here:
 * a session file is a control-point JSON file with the editor's own keys ("editor": {...}) beside the three that version 1 knows.
 */
