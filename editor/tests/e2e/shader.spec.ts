/** The shader solves the same problem as the core, by the same rule: 1e-4 of the box, whatever the map and the temperature. */

import { expect, test } from "@playwright/test";
import type { Orientation } from "../../src/model/orientation.ts";
import { compare, published, sample } from "./cases.ts";

const neural = { kind: "neural", width: 1024, seed: 0, steps: null };
const inverseDistance = { kind: "inverse-distance", alpha: 1, epsilon: 0 };

for (const name of ["chair", "airplane", "car", "table", "ShapeNetChair1"]) {
  test(`the shader agrees with the core: ${name}`, async ({ page }) => {
    const given = name === "ShapeNetChair1" ? published() : sample(name);
    test.skip(!given, "there is no folder of real files: set NEURALMLS_DATA");
    for (const weights of [neural, inverseDistance]) {
      for (const { transform, temperature, handles, worst, moved, leaning } of await compare(page, given!, weights)) {
        const what = `${weights.kind}, ${transform}, T = ${temperature}, handles ${handles}`;
        test.info().annotations.push({ type: "error", description: `${what}: ${worst.toExponential(1)}` });
        expect(moved, what).toBeGreaterThan(0.01);
        expect(worst, what).toBeLessThan(1e-4);
        expect(leaning, what).toBeLessThan(0.01);
      }
    }
  });
}

for (const name of ["chair", "airplane"]) {
  test(`the shader agrees with the core on oriented control points: ${name}`, async ({ page }) => {
    const given = sample(name);
    const oriented = given.p.map((_, i): Orientation | undefined =>
      i % 3 === 1 ? undefined : { axis: [1, i, -2], degrees: 25 * Math.cos(i), scale: 1 + 0.1 * Math.sin(i) },
    );
    for (const weights of [neural, inverseDistance]) {
      const plain = await compare(page, given, weights);
      for (const [at, { transform, temperature, worst, moved }] of (await compare(page, given, weights, oriented)).entries()) {
        const what = `${weights.kind}, ${transform}, T = ${temperature}`;
        test.info().annotations.push({ type: "error", description: `${what}: ${worst.toExponential(1)}` });
        expect(moved, what).not.toBeCloseTo(plain[at]!.moved, 6);
        expect(worst, what).toBeLessThan(1e-4);
      }
    }
  });
}

test("normals stay on the side of the winding under a reflection", async ({ page }) => {
  const table = sample("table");
  const compared = await compare(page, { ...table, q: table.p.map(([x, y, z]) => [-x, y, z]) }, inverseDistance);
  const affine = compared.filter(({ transform }) => transform === "affine");
  expect(affine).toHaveLength(6); // three temperatures, soft and exact
  for (const { leaning } of affine) expect(leaning).toBeLessThan(0.01);
});
