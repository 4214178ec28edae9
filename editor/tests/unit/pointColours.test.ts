import { expect, test } from "vitest";
import type { OpenedShape } from "../../src/viewport/openedShape.ts";
import { pointColours } from "../../src/viewport/appearance.ts";

const coloured = (type: string, ...rows: string[]): Uint8Array =>
  new TextEncoder().encode(
    [
      "ply", "format ascii 1.0", `element vertex ${rows.length}`,
      ...["x", "y", "z"].map((name) => `property float ${name}`),
      ...["red", "green", "blue"].map((name) => `property ${type} ${name}`),
      "end_header", ...rows, "",
    ].join("\n"),
  ); // prettier-ignore

const shape = (points: number): OpenedShape => ({
  name: "a.ply",
  format: "PLY",
  positions: new Float32Array(3 * points),
  triangles: null,
  isAt: () => true,
});

test.each([
  ["uchar", ["0 0 0 255 0 0", "1 0 0 0 0 255"]],
  ["ushort", ["0 0 0 65535 0 0", "1 0 0 0 0 65535"]],
  ["float", ["0 0 0 1 0 0", "1 0 0 0 0 1"]],
])("colours of a PLY file are parts of one, as %s too", async (type, rows) => {
  const colours = await pointColours(shape(2), new Map([["a.ply", coloured(type, ...rows)]]));
  expect([...(colours ?? [])]).toEqual([1, 0, 0, 0, 0, 1]);
});
