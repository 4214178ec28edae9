/** Points and displacements as three numbers, in double precision. */

export type Vec3 = readonly [number, number, number];
export type Axis = "x" | "y" | "z";

export const AXES: readonly Axis[] = ["x", "y", "z"];

export const axisIndex = (axis: Axis): 0 | 1 | 2 => (axis === "x" ? 0 : axis === "y" ? 1 : 2);

export const add = (a: Vec3, b: Vec3): Vec3 => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec3, by: number): Vec3 => [a[0] * by, a[1] * by, a[2] * by];
export const distance = (a: Vec3, b: Vec3): number => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
export const equal = (a: Vec3, b: Vec3): boolean => a[0] === b[0] && a[1] === b[1] && a[2] === b[2];

/** All coordinates in a row, as the core takes them. */
export function flatten(points: readonly Vec3[]): Float64Array<ArrayBuffer> {
  const flat = new Float64Array(3 * points.length);
  points.forEach((point, i) => flat.set(point, 3 * i));
  return flat;
}

/** The i-th point of such a row. */
export const pointAt = (flat: ArrayLike<number>, i: number): Vec3 => [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]];
