/** Points of 1 or 2 coordinates in the file have 3 in the editor. */

import { CoreError, type Frame, type Vec3 } from "./protocol.ts";

/** n x dim -> n x 3, with zeros. */
export function widen(points: Float64Array<ArrayBuffer>, dim: number): Float64Array<ArrayBuffer> {
  if (dim === 3) return points;
  const wide = new Float64Array((points.length / dim) * 3);
  widenInto(wide, points, dim);
  return wide;
}

/** As many points as fit into `wide` (n x 3), of n x dim numbers and more. */
export function widenInto(wide: Float64Array, points: Float64Array, dim: number): void {
  const count = (wide.length / 3) * dim;
  for (let i = 0; i < count; i++) wide[3 * Math.floor(i / dim) + (i % dim)] = points[i]!;
}

/** n x 3 -> n x dim. */
export function narrow(points: Float64Array, dim: number): Float64Array {
  if (dim === 3) return points;
  const slim = new Float64Array((points.length / 3) * dim);
  for (let i = 0; i < slim.length; i++) slim[i] = points[3 * Math.floor(i / dim) + (i % dim)]!;
  return slim;
}

/** n x dim x dim -> n x 3 x 3, with the identity beyond the dimension. */
export function widenMaps(maps: Float64Array<ArrayBuffer>, dim: number): Float64Array<ArrayBuffer> {
  if (dim === 3) return maps;
  const count = maps.length / (dim * dim);
  const wide = new Float64Array(count * 9);
  for (let i = 0; i < count; i++) {
    for (let row = 0; row < 3; row++) {
      for (let column = 0; column < 3; column++) {
        const inside = row < dim && column < dim;
        wide[9 * i + 3 * row + column] = inside ? maps[dim * (dim * i + row) + column]! : row === column ? 1 : 0;
      }
    }
  }
  return wide;
}

/** m x 3 x 3 -> m x dim x dim. */
export function narrowMaps(maps: Float64Array, dim: number): Float64Array {
  return dim === 3 ? maps : maps.filter((_, at) => at % 3 < dim && Math.floor((at % 9) / 3) < dim);
}

/** The box of points, n x 3, and the frame by which it becomes [-1, 1]; refused where there is no size to measure by. */
export function measure(points: Float64Array): { bounds: { min: Vec3; max: Vec3 }; frame: Frame } {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    const k = i % 3;
    if (points[i]! < min[k]!) min[k] = points[i]!;
    if (points[i]! > max[k]!) max[k] = points[i]!;
  }
  const size = Math.max(...min.map((low, k) => max[k]! - low));
  const count = points.length / 3;
  if (!(size > 0)) {
    const found = count === 1 ? "there is only one vertex" : `all ${count} vertices are in one place`;
    throw new CoreError(`${found}, so that there is no size to measure by`);
  }
  if (!(size < 1e150)) {
    throw new CoreError("the shape is more than 1e150 units long: no coordinates of a real thing");
  }
  const centre = min.map((low, k) => low + 0.5 * (max[k]! - low)) as [number, number, number];
  return { bounds: { min, max }, frame: { centre, half: 0.5 * size } };
}

/** (x - centre) / half in single precision. */
export function relative(points: Float64Array, { centre, half }: Frame): Float32Array<ArrayBuffer> {
  const result = new Float32Array(points.length);
  for (let i = 0; i < points.length; i++) result[i] = (points[i]! - centre[i % 3]!) / half;
  return result;
}
