/** Normals of vertices under the maps M of their points (n x 9, row by row): along the cofactors of M, whose rows are cross products of its rows. */
export function turnedBy(maps: Float64Array, points: Uint32Array, normals: Float32Array): Float32Array<ArrayBuffer> {
  const turned = new Float32Array(normals.length);
  for (let i = 0; i < points.length; i++) {
    const at = 9 * points[i];
    const [x, y, z] = [normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]];
    const [a, b, c, d, e, f] = [maps[at], maps[at + 1], maps[at + 2], maps[at + 3], maps[at + 4], maps[at + 5]];
    const [g, h, k] = [maps[at + 6], maps[at + 7], maps[at + 8]];
    const u = (e * k - f * h) * x + (f * g - d * k) * y + (d * h - e * g) * z;
    const v = (h * c - k * b) * x + (k * a - g * c) * y + (g * b - h * a) * z;
    const w = (b * f - c * e) * x + (c * d - a * f) * y + (a * e - b * d) * z;
    const length = Math.sqrt(u * u + v * v + w * w) || 1;
    turned[3 * i] = u / length;
    turned[3 * i + 1] = v / length;
    turned[3 * i + 2] = w / length;
  }
  return turned;
}
