/** The shader solves the same problem as the core, by the same rule: 1e-4 of the box, whatever the map and the temperature. */

import { expect, test } from "@playwright/test";
import { compare, published, sample } from "./cases.ts";

const neural = { kind: "neural", width: 1024, seed: 0, steps: null };
const classic = { kind: "classic", alpha: 1, epsilon: 0 };

for (const name of ["chair", "airplane", "car", "table", "ShapeNetChair1"]) {
  test(`the shader agrees with the core: ${name}`, async ({ page }) => {
    const given = name === "ShapeNetChair1" ? published() : sample(name);
    test.skip(!given, "there is no folder of real files: set NEURALMLS_DATA");
    for (const weights of [neural, classic]) {
      for (const { transform, temperature, adherence, worst, moved } of await compare(page, given!, weights)) {
        const what = `${weights.kind}, ${transform}, T = ${temperature}, adherence ${adherence}`;
        test.info().annotations.push({ type: "error", description: `${what}: ${worst.toExponential(1)}` });
        expect(moved, what).toBeGreaterThan(0.01);
        expect(worst, what).toBeLessThan(1e-4);
      }
    }
  });
}
