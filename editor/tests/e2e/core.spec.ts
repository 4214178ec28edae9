/** The core in its workers, in a real browser, against the command line: without the editor's user interface. */

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect, test, type Page } from "@playwright/test";
import type { Core, WeightsSpec } from "../../src/worker/protocol.ts";
import { data, difference, neuralmls, pages, samples, vertices } from "./tools.ts";

declare global {
  interface Window {
    core: Core;
  }
}

const chair = readFileSync(join(samples, "chair.obj"));
const points: { position: number[]; target: number[] }[] = JSON.parse(
  readFileSync(join(samples, "chair.points.json"), "utf8"),
).control_points;
const moved = points.map(({ position: [x, y, z] }, i) => [x! + 0.1 * Math.sin(i), y! + 0.05 * i, z!]);

test.beforeEach(async ({ page }) => {
  await page.goto(`${pages}/core.html`);
  await page.waitForFunction(() => window.core);
});

/** Opens a file in the page, which gets its bytes as text of base 64. */
async function open(page: Page, name: string, bytes: Buffer) {
  return page.evaluate(
    async ([name, text]) => {
      const binary = Uint8Array.from(atob(text!), (c) => c.charCodeAt(0));
      const { count, format, triangles, bounds, frame, warnings } = await window.core.open(new Map([[name!, binary]]), name!);
      return { count, format, triangles: triangles && triangles.length / 3, bounds, frame, warnings };
    },
    [name, bytes.toString("base64")],
  );
}

/** Fits, and saves with the targets moved; gives the file's text. */
async function bend(page: Page, weights: WeightsSpec, transform: "rigid" | "similarity" | "affine", temperature: number, adherence: number) {
  return page.evaluate(
    async ([p, q, weights, transform, temperature, adherence]) => {
      const fitted = await window.core.fit(Float64Array.from(p.flat()), weights);
      const targets = Float64Array.from(q.flat());
      const saved = await window.core.save("bent.obj", { targets, transform, temperature, adherence });
      const { loss, steps, milliseconds, shared } = fitted;
      return { text: new TextDecoder().decode(saved.files[0]!.bytes), loss, steps, milliseconds, shared };
    },
    [points.map((p) => p.position), moved, weights, transform, temperature, adherence] as const,
  );
}

const cases: [string, WeightsSpec, "rigid" | "similarity" | "affine", number, number, string[]][] = [
  ["neural, rigid", { kind: "neural", width: 1024, seed: 0, steps: null }, "rigid", 1, 1, []],
  ["another seed and width, affine", { kind: "neural", width: 256, seed: 7, steps: null }, "affine", 1, 1, ["--width", "256", "--seed", "7"]],
  ["48 steps, similarity", { kind: "neural", width: 1024, seed: 0, steps: 48 }, "similarity", 2, 0, ["--steps", "48", "--no-exact"]],
  ["classic", { kind: "classic", alpha: 2, epsilon: 0.01 }, "rigid", 1, 1, ["--weights", "inverse-distance", "--alpha", "2", "--epsilon", "0.01"]],
];

for (const [name, weights, transform, temperature, adherence, options] of cases) {
  test(`saves what the command line saves: ${name}`, async ({ page }, info) => {
    await open(page, "chair.obj", chair);
    const { text } = await bend(page, weights, transform, temperature, adherence);
    const file = {
      format: "neuralmls-control-points",
      version: 1,
      control_points: points.map(({ position }, i) => ({ name: `p${i}`, position, target: moved[i] })),
    };
    writeFileSync(info.outputPath("points.json"), JSON.stringify(file));
    const common = ["--transform", transform, "--temperature", `${temperature}`, "-q", "--force"];
    neuralmls("deform", join(samples, "chair.obj"), "--points", info.outputPath("points.json"), "-o", info.outputPath("bent.obj"), ...common, ...options);
    const expected = readFileSync(info.outputPath("bent.obj"), "utf8");
    expect(difference(vertices(expected), vertices(chair.toString()))).toBeGreaterThan(0.05);
    expect(difference(vertices(expected), vertices(text))).toBeLessThan(1e-5);
    const others = (file: string) => file.split("\n").filter((line) => !line.startsWith("v ") && !line.startsWith("vn "));
    expect(others(text)).toEqual(others(expected));
  });
}

test("an unmoved shape is saved byte for byte", async ({ page }) => {
  await open(page, "chair.obj", chair);
  const same = await page.evaluate(async () => {
    const saved = await window.core.save("same.obj", null);
    return new TextDecoder().decode(saved.files[0]!.bytes);
  });
  expect(same).toBe(chair.toString());
});

test("a glTF is saved with its buffer, which is called after it", async ({ page }) => {
  const positions = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
  const document = {
    asset: { version: "2.0", extras: "kept" },
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [0, 0, 0], max: [1, 1, 1] }],
    bufferViews: [{ buffer: 0, byteLength: 48 }],
    buffers: [{ uri: "data/points.bin", byteLength: 48 }],
  };
  const saved = await page.evaluate(
    async ([text, numbers]) => {
      const files = new Map([
        ["shape.gltf", new TextEncoder().encode(text)],
        ["points.bin", new Uint8Array(Float32Array.from(numbers).buffer)],
      ]);
      const { namedFiles, warnings } = await window.core.open(files, "shape.gltf");
      await window.core.fit(Float64Array.from([0, 0, 0]), { kind: "classic", alpha: 1, epsilon: 0 });
      const motion = { targets: Float64Array.from([0, 0.5, 0]), transform: "rigid", temperature: 1, adherence: 0 } as const;
      const saved = await window.core.save("bent.gltf", motion);
      const missing = await window.core.open(new Map([["shape.gltf", files.get("shape.gltf")!]]), "shape.gltf").catch((error) => error.message);
      return { namedFiles, warnings, missing, files: saved.files.map(({ name, bytes }) => ({ name, bytes: [...bytes] })) };
    },
    [JSON.stringify(document), [...positions]] as const,
  );
  expect(saved.namedFiles).toEqual(["data/points.bin"]);
  expect(saved.warnings).toEqual([]);
  expect(saved.missing).toMatch(/^shape\.gltf: .*data\/points\.bin/);
  expect(saved.files.map((file) => file.name)).toEqual(["bent.gltf", "bent.bin"]);
  const written = JSON.parse(Buffer.from(saved.files[0].bytes).toString());
  expect(written.buffers[0].uri).toBe("bent.bin");
  expect(written.asset.extras).toBe("kept");
  const moved = new Float32Array(Uint8Array.from(saved.files[1].bytes).buffer);
  expect([...moved]).toEqual([...positions].map((c, at) => (at % 3 === 1 ? c + 0.5 : c)));
});

test("a refused file is one sentence, and leaves the open shape as it is", async ({ page }) => {
  await open(page, "chair.obj", chair);
  for (const [name, text, words] of [
    ["broken.obj", "v 1 2\n", "line 1"],
    ["empty.ply", "", "empty"],
    ["point.obj", "v 1 2 3\n", "only one vertex"],
    ["what.xyz7", "\0\0\0\0", "what.xyz7"],
    ["huge.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n", "huge.ply"],
  ] as const) {
    await expect(open(page, name, Buffer.from(text)), name).rejects.toThrow(new RegExp(`CoreError: ${name}: .*${words === name ? "" : words}`));
  }
  const { text } = await bend(page, { kind: "classic", alpha: 1, epsilon: 0 }, "rigid", 1, 1);
  expect(vertices(text).length).toBe(vertices(chair.toString()).length);
});

test("a newer fit takes the place of an older one, and an aborted one ends at once", async ({ page }) => {
  await open(page, "chair.obj", chair);
  const [older, newer, stopped, afterwards] = await page.evaluate(async (p) => {
    const { core } = window;
    const controlPoints = Float64Array.from(p.flat());
    const weights = { kind: "neural", width: 4096, seed: 0, steps: 100_000 } as const;
    const told: number[] = [];
    const slow = core.fit(controlPoints, weights, { progress: (_, fraction) => told.push(fraction) }).catch((error) => error.name);
    while (told.length < 2) await new Promise((resolve) => setTimeout(resolve, 20));
    const classic = { kind: "classic", alpha: 1, epsilon: 0 } as const;
    const fast = await core.fit(controlPoints, classic);
    const older = await slow;
    const abort = new AbortController();
    const began = performance.now();
    const third = core.fit(controlPoints, weights, { signal: abort.signal }).catch((error) => error.name);
    setTimeout(() => abort.abort(), 200);
    const name = await third;
    const fourth = await core.fit(controlPoints, classic);
    return [older, fast.controlPoints, [name, performance.now() - began], fourth.controlPoints] as const;
  }, points.map((p) => p.position));
  expect(older).toBe("AbortError");
  expect(newer).toBe(points.length);
  expect(stopped[0]).toBe("AbortError");
  expect(stopped[1]).toBeLessThan(10_000);
  expect(afterwards).toBe(points.length);
});

test("the control points land where the core says, and places are found for new ones", async ({ page }) => {
  await open(page, "chair.obj", chair);
  const { landed, deformed, exact, places, again } = await page.evaluate(
    async ([p, q]) => {
      const { core } = window;
      await core.fit(Float64Array.from(p!.flat()), { kind: "neural", width: 1024, seed: 0, steps: null });
      const motion = { targets: Float64Array.from(q!.flat()), transform: "rigid", temperature: 1, adherence: 0 } as const;
      const deformed = await core.deform(motion);
      return {
        landed: [...(await core.land(motion)).places],
        deformed: [...deformed.landed.places],
        exact: [...(await core.land({ ...motion, adherence: 1 })).places],
        places: [...(await core.farthestPoints(12))],
        again: [...(await core.farthestPoints(12))],
      };
    },
    [points.map((p) => p.position), moved],
  );
  expect(landed).toEqual(deformed);
  expect(difference(landed, moved.flat())).toBeLessThan(0.05);
  expect(difference(landed, moved.flat())).toBeGreaterThan(1e-4);
  expect(difference(exact, moved.flat())).toBeLessThan(1e-9);
  expect(places).toHaveLength(36);
  expect(again).toEqual(places);
});

test("opens real files of every kind", async ({ page }) => {
  test.skip(!data, "there is no folder of real files: set NEURALMLS_DATA");
  const { execFileSync } = await import("node:child_process");
  const list = execFileSync("find", [data!, "-type", "f", "-size", "-3M"], { encoding: "utf8" }).trim().split("\n");
  const kinds = new Map<string, string>();
  for (const path of list.filter((path) => !path.includes("torture"))) {
    const ending = path.split(".").pop()!.toLowerCase();
    if (["obj", "ply", "off", "stl", "glb", "xyz", "npy"].includes(ending) && !kinds.has(ending)) kinds.set(ending, path);
  }
  expect(kinds.size).toBeGreaterThan(2);
  for (const [ending, path] of kinds) {
    const { count } = await open(page, `file.${ending}`, readFileSync(path));
    const told = JSON.parse(neuralmls("inspect", path, "--json"));
    expect(count, path).toBe(told.vertices);
  }
});
