import { Matrix3, Vector3 } from "three";
import { expect, it } from "vitest";
import { turnedBy } from "../../src/viewport/turned.ts";

const MAPS = [
  [1, 0, 0, 0, 1, 0, 0, 0, 1],
  [0, -1, 0, 1, 0, 0, 0, 0, 1],
  [2, 0.5, 0, 0, 0.3, 0.1, 0.2, 0, 1],
  [-1, 0, 0, 0, 1, 0, 0, 0.5, 1], // a reflection
];

it("turns normals by the inverse transpose, and keeps them outside of a reflected shape", () => {
  const points = Uint32Array.from(MAPS.flatMap((_, i) => [i, i, i]));
  const normals = Float32Array.from(MAPS.flatMap(() => [1, 0, 0, 0, 1, 0, 0, 0.6, 0.8]));
  const found = turnedBy(Float64Array.from(MAPS.flat()), points, normals);
  points.forEach((point, i) => {
    const map = new Matrix3().set(...(MAPS[point] as Parameters<Matrix3["set"]>));
    const side = Math.sign(map.determinant());
    const expected = new Vector3().fromArray(normals, 3 * i).applyMatrix3(map.invert().transpose()).normalize().multiplyScalar(side);
    expected.toArray().forEach((c, k) => expect(found[3 * i + k]).toBeCloseTo(c, 6));
  });
});

it("leaves no number behind that is none, where a map is flat", () => {
  const found = turnedBy(new Float64Array(9), Uint32Array.of(0), Float32Array.of(0, 1, 0));
  expect([...found]).toEqual([0, 0, 0]);
});
