/**
 * What the main thread and the workers say to each other. The rest of the editor talks to `CoreClient` (client.ts) only.
 *
 * Sessions go to the core as documents of session files. All coordinates are in the units of the shape's file and in double precision, but
 * for `Opened.positions`, which are relative to the shape's box. Symbols as in ARCHITECTURE.md: n points, m control points.
 */

import type { SessionDocument } from "../model/document.ts";
import type { Constants, Handles } from "../model/handles.ts";
import type { Settings } from "../model/settings.ts";
import type { Slot } from "../model/slot.ts";
import type { Vec3 } from "../model/vec3.ts";

export type { Constants, Handles, SessionDocument, Settings, Slot, Vec3 };

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

/** What the core says once and for all. */
export interface Rules {
  /** The settings that hold where nothing is said. */
  defaults: Settings;
  constants: Constants;
}

/** Control points that were read. */
export interface ReadSession {
  document: SessionDocument;
  /** What was left out, and what a person should know of them beside the shape, a sentence each. */
  notes: string[];
}

/** Weights fitted and evaluated. */
export interface Fitted {
  /** n x m, row by row (point by point). +Infinity is possible for inverse distance with epsilon 0. */
  logits: Float32Array<ArrayBuffer>;
  /** m x m: the logits at the control points' own places; softmax(row i / T)[i] is the weight that i has there. */
  ownLogits: Float32Array<ArrayBuffer>;
  /** Mean cross-entropy after the training; null for weights that are not trained. */
  loss: number | null;
  /** Steps that were trained; 0 for weights that are not. */
  steps: number;
  /** Milliseconds of the fit, and of the evaluation at the points. */
  milliseconds: { train: number; evaluate: number };
}

/** What happens to the control points (crates/session/src/report.rs). */
export interface Report {
  /** Where they land, m x dim. */
  places: number[];
  /** How far each ends from its target. */
  distances: number[];
  /** How closely they are met, in a few words. */
  handles: string;
  /** Why all of them are left soft although more is asked for, and what would help; null where they are not. */
  soft: string | null;
  /** What a person should know, a sentence each. */
  warnings: string[];
}

/** The core's result, for what is saved, and for what the GPU cannot show. */
export interface Deformed {
  /** n x 3 in file units. */
  positions: Float64Array<ArrayBuffer>;
  /** The local maps M, row-major, n x 9. */
  maps: Float64Array<ArrayBuffer>;
}

/** One thing that is likely bad about a deformation (crates/session/src/advice.rs). */
export interface Advice {
  kind: "misses" | "stiff" | "folds" | "torn" | "ungoverned";
  /** What, where, and what would help. */
  sentence: string;
  /** The control points that it is about, by their numbers, the worst first. */
  control_points: number[];
  amount: number;
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
  /** What it says once and for all. */
  rules(): Promise<Rules>;
  /**
   * Reads a shape. The open one stays as it is until this one has been read: a refused file changes nothing.
   * `name` is a key of `files`; the others are what it may name.
   */
  open(files: Files, name: string, options?: CallOptions): Promise<Opened>;
  /** Reads control points for the open shape, of any kind; those of two files are joined: where they are at rest, and where they go. */
  readSession(files: Files, names: readonly string[]): Promise<ReadSession>;
  /** The text of a session file; `fitted`: with the frame in which the slot "main" was fitted to its control points. */
  sessionText(session: SessionDocument, fitted: boolean): Promise<string>;
  /**
   * Fits the weights of a session and evaluates them at the points of the open shape. A newer fit of the same slot aborts this one. The fit
   * of the slot "main" is what the calls below use, unless they name another: with sessions of the same control points at rest and weights,
   * and `relax` above 0 only where it was at the fit.
   */
  fit(session: SessionDocument, options?: CallOptions & { slot?: Slot }): Promise<Fitted>;
  /** Deforms by the last fit; waits for one that is on its way. */
  deform(session: SessionDocument, options?: CallOptions & { slot?: Slot }): Promise<Deformed>;
  /** What happens to the control points: cheap. */
  report(session: SessionDocument, options?: CallOptions): Promise<Report>;
  /** What is likely bad about a deformation; nothing where all is well. */
  advise(session: SessionDocument, options?: CallOptions): Promise<Advice[]>;
  /** Where to aim, for this thread: for a session that was fitted to the open shape, with the logits of that fit. */
  handles(session: SessionDocument, ownLogits: Float32Array): Promise<Handles>;
  /**
   * The open shape's file with the core's double-precision result; `session` null: as it was read, byte for byte. `name` is the new
   * file's name; changed side files are called after it.
   */
  save(name: string, session: SessionDocument | null, options?: CallOptions): Promise<Saved>;
  /** `count` places spread over the open shape, count x 3 in file units, by the rule of `neuralmls points` (placement.rs). */
  farthestPoints(count: number, seed?: number, options?: CallOptions): Promise<Float64Array<ArrayBuffer>>;
  /** Ends the workers. */
  close(): void;
}

/** What was wrong, in one sentence for a person. */
export class CoreError extends Error {
  override name = "CoreError";
}
