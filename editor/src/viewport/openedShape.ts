import type { Vector3 } from "three";

/** A shape as it was opened; the worker's `Opened` is one, but for `isAt`. */
export interface OpenedShape {
  name: string;
  format: string;
  /** n x 3, relative to the shape's box. */
  positions: Float32Array<ArrayBuffer>;
  triangles: Uint32Array<ArrayBuffer> | null;
  /** Whether a point is at a place (in file units), but for a tolerance relative to the box. */
  isAt(point: number, place: Vector3, tolerance: number): boolean;
}
