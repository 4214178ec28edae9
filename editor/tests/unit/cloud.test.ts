import { describe, expect, it } from "vitest";
import { discDiameter } from "../../src/viewport/cloud.ts";

/** Places on a ball of radius 1, which fills the shape's box: random ones, from a seed. */
function ball(count: number, seed: number): Float32Array {
  let state = seed;
  const next = (): number => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
  const places = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) {
    const [z, turn] = [2 * next() - 1, 2 * Math.PI * next()];
    const r = Math.sqrt(1 - z * z);
    places.set([r * Math.cos(turn), r * Math.sin(turn), z], 3 * i);
  }
  return places;
}

/** A square of side x side points. */
const grid = (side: number): Float32Array =>
  Float32Array.from({ length: 3 * side * side }, (_, at) => {
    const i = Math.floor(at / 3);
    return at % 3 === 2 ? 0 : (2 * (at % 3 === 0 ? i % side : Math.floor(i / side))) / (side - 1) - 1;
  });

describe("the discs of a cloud of points", () => {
  it.each([2500, 10_000])("close a surface of %d random points, but for next to nothing", (count) => {
    const [points, places] = [ball(count, 1), ball(2000, 2)];
    const reach = (discDiameter(points) / 2) ** 2;
    let open = 0;
    for (let k = 0; k < places.length; k += 3) {
      let covered = false;
      for (let i = 0; i < points.length && !covered; i += 3) {
        covered = (points[i] - places[k]) ** 2 + (points[i + 1] - places[k + 1]) ** 2 + (points[i + 2] - places[k + 2]) ** 2 < reach;
      }
      if (!covered) open++;
    }
    expect(open).toBeLessThan(0.01 * 2000);
  });

  it("close a grid, and are not larger than three of its cells", () => {
    const spacing = 2 / 49;
    const diameter = discDiameter(grid(50));
    expect(diameter).toBeGreaterThan(Math.SQRT2 * spacing);
    expect(diameter).toBeLessThan(3 * spacing);
  });

  it("close a grid of which every point is there several times", () => {
    const once = grid(50);
    const often = Float32Array.from({ length: 9 * once.length }, (_, at) => once[at % once.length]);
    expect(discDiameter(often)).toBeGreaterThan((Math.SQRT2 * 2) / 49);
  });

  it("of a few points are no larger than a tenth of the shape", () => {
    expect(discDiameter(ball(40, 3))).toBeLessThanOrEqual(2 / 10);
    expect(discDiameter(new Float32Array([0, 0, 0]))).toBeLessThanOrEqual(2 / 10);
  });
});
