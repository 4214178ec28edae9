import { describe, expect, it } from "vitest";
import { restMesh, weld } from "../../src/viewport/restVertices.ts";

/** A cube's 8 corners and 12 triangles, outward. */
const cube = {
  positions: new Float32Array([0, 1].flatMap((z) => [0, 1].flatMap((y) => [0, 1].flatMap((x) => [x, y, z])))),
  triangles: new Uint32Array([
    0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5,
  ]), // prettier-ignore
};

describe("vertices for drawing", () => {
  it("of a cube are three at each corner, with the normals of its faces", () => {
    const { points, normals, index } = restMesh(cube.positions, cube.triangles);
    expect(points).toHaveLength(24);
    for (let v = 0; v < 24; v++) {
      expect([...normals.slice(3 * v, 3 * v + 3)].map(Math.abs).sort()).toEqual([0, 0, 1]);
    }
    expect([...index].map((v) => points[v])).toEqual([...cube.triangles]);
  });

  it("are one where faces meet smoothly, in a soup too", () => {
    const strip = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.1]);
    const mesh = restMesh(strip, new Uint32Array([0, 1, 2, 1, 3, 2]));
    expect(mesh.points).toHaveLength(4);
    const soup = new Float32Array([0, 1, 2, 1, 3, 2].flatMap((v) => [...strip.slice(3 * v, 3 * v + 3)]));
    const apart = restMesh(soup, new Uint32Array([0, 1, 2, 3, 4, 5]));
    expect(apart.points).toHaveLength(6);
    // Corners 1 and 3 of the soup are at one place, and shaded alike.
    expect([...apart.normals.slice(3 * apart.index[1], 3 * apart.index[1] + 3)]).toEqual([
      ...apart.normals.slice(3 * apart.index[3], 3 * apart.index[3] + 3),
    ]);
  });

  it("are apart where their texture coordinates are", () => {
    const flat = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]);
    const triangles = new Uint32Array([0, 1, 2, 1, 3, 2]);
    const seam = { data: new Float32Array([0, 0, 1, 0, 0, 1, 5, 5, 1, 1, 0, 1]), size: 2 };
    const mesh = restMesh(flat, triangles, [seam]);
    expect(mesh.points).toHaveLength(5);
    expect([...mesh.index].flatMap((v) => [...mesh.extras[0].slice(2 * v, 2 * v + 2)])).toEqual([...seam.data]);
  });

  it("survive degenerate triangles and points without any", () => {
    const mesh = restMesh(new Float32Array([0, 0, 0, 1, 0, 0, 2, 0, 0, 9, 9, 9]), new Uint32Array([0, 1, 2, 0, 0, 0]));
    expect(mesh.normals.every(Number.isFinite)).toBe(true);
  });

  it("are welded by place, the zeros of either sign alike", () => {
    expect([...weld(new Float32Array([0, 1, 2, -0, 1, 2, 0, 1, 3, 0, 1, 2]))]).toEqual([0, 0, 2, 0]);
  });
});
