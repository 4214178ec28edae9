import { describe, expect, it } from "vitest";
import { anchor, bestRotation, IDENTITY, type Matrix } from "../../src/shader/anchor.ts";

/** Numbers from a seed. */
function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 31 - 1;
  };
}

function rotation([w, x, y, z]: number[]): Matrix {
  const l = Math.hypot(w, x, y, z);
  [w, x, y, z] = [w / l, x / l, y / l, z / l];
  return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
}

const apply = (m: Matrix, points: number[]): number[] =>
  points.map((_, at) => [0, 1, 2].reduce((sum, k) => sum + m[3 * (at % 3) + k] * points[3 * Math.floor(at / 3) + k], 0));
const close = (found: ArrayLike<number>, expected: ArrayLike<number>): void =>
  // The rule itself lets the identity count for 1e-9 against what the control points say.
  Array.from(expected).forEach((e, i) => expect(found[i]).toBeCloseTo(e, 7));

describe("the anchor", () => {
  const next = random(7);
  const points = (m: number): number[] => Array.from({ length: 3 * m }, next);

  it("of a rigid motion is its rotation, and the scale is 1", () => {
    const [p, turn] = [points(5), rotation([next(), next(), next(), next()])];
    const found = anchor(p, apply(turn, p).map((c, at) => c + [3, -2, 1][at % 3]));
    close(found.rotation, turn);
    close(found.linear, turn);
    expect(found.scale).toBeCloseTo(1, 9);
  });

  it("of an affine motion is its linear part", () => {
    const [p, map] = [points(6), points(3) as Matrix];
    close(anchor(p, apply(map, p)).linear, map);
  });

  it("of a scaling is the scale", () => {
    const p = points(4);
    expect(anchor(p, p.map((c) => 2.5 * c)).scale).toBeCloseTo(2.5, 9);
  });

  it("of one, two or aligned control points that only shift is the identity", () => {
    // Numbers that shift without rounding: along what is open, an error of 1e-16 counts against a ridge of 1e-12.
    for (const p of [[0.25, 0.5, -0.75], [0.25, 0.5, -0.75, 1, -2, 0.5], [0, 0, 0, 1, 2, 3, 2, 4, 6]]) {
      const found = anchor(p, p.map((c) => c + 0.5));
      close(found.rotation, IDENTITY);
      close(found.linear, IDENTITY);
    }
  });

  it("is never a reflection", () => {
    const p = points(6);
    const [a, b, c, d, e, f, g, h, i] = anchor(p, p.map((v, at) => (at % 3 === 0 ? -v : v))).rotation;
    expect(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)).toBeCloseTo(1, 9);
  });

  it("uses the rotation that no random one beats", () => {
    const c = points(3) as Matrix;
    const value = (r: Matrix): number => [0, 1, 2].reduce((sum, i) => sum + [0, 1, 2].reduce((s, k) => s + r[3 * i + k] * c[3 * k + i], 0), 0);
    const best = value(bestRotation(c));
    for (let i = 0; i < 200; i++) expect(value(rotation([next(), next(), next(), next()]))).toBeLessThanOrEqual(best + 1e-12);
  });
});
