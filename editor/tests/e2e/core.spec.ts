/** The core in its workers, in a real browser, against the command line: without the editor's user interface. */

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { expect, test, type Page } from "@playwright/test";
import type { SettingsEntry } from "../../src/model/document.ts";
import type { Core, SessionDocument } from "../../src/worker/protocol.ts";
import { data, difference, neuralmls, pages, samples, vertices } from "./tools.ts";

declare global {
  interface Window {
    core: Core;
    documentOf(p: number[][], q: number[][], settings?: Given): SessionDocument;
  }
}

/** Settings, with the parameters of the weights. */
type Given = Partial<Omit<SettingsEntry, "weights"> & { weights: { kind: string; [parameter: string]: unknown } }>;

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
async function bend(page: Page, given: Given) {
  return page.evaluate(
    async ([p, q, given]) => {
      const document = window.documentOf(p, q, given);
      await window.core.fit(document);
      const saved = await window.core.save("bent.obj", document);
      return new TextDecoder().decode(saved.files[0]!.bytes);
    },
    [points.map((p) => p.position), moved, given] as const,
  );
}

const cases: [string, Given, string[]][] = [
  ["neural, rigid", {}, []],
  ["another seed and width, affine", { weights: { kind: "neural", width: 256, seed: 7, steps: null }, transform: "affine" }, ["--width", "256", "--seed", "7"]],
  ["48 steps, similarity", { weights: { kind: "neural", width: 1024, seed: 0, steps: 48 }, transform: "similarity", temperature: 2, handles: "soft" }, ["--steps", "48", "--handles", "soft"]],
  ["inverse distance", { weights: { kind: "inverse-distance", alpha: 2, epsilon: 0.01 } }, ["--weights", "inverse-distance", "--alpha", "2", "--epsilon", "0.01"]],
];

for (const [name, given, options] of cases) {
  test(`saves what the command line saves: ${name}`, async ({ page }, info) => {
    await open(page, "chair.obj", chair);
    const text = await bend(page, given);
    const file = {
      format: "neuralmls-control-points",
      version: 1,
      control_points: points.map(({ position }, i) => ({ name: `p${i}`, position, target: moved[i] })),
    };
    writeFileSync(info.outputPath("points.json"), JSON.stringify(file));
    const common = ["--transform", given.transform ?? "rigid", "--temperature", `${given.temperature ?? 1}`, "-q", "--force"];
    neuralmls("deform", join(samples, "chair.obj"), "--points", info.outputPath("points.json"), "-o", info.outputPath("bent.obj"), ...common, ...options);
    const expected = readFileSync(info.outputPath("bent.obj"), "utf8");
    expect(difference(vertices(expected), vertices(chair.toString()))).toBeGreaterThan(0.05);
    expect(difference(vertices(expected), vertices(text))).toBeLessThan(1e-6);
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
      const document = window.documentOf([[0, 0, 0]], [[0, 0.5, 0]], { weights: { kind: "inverse-distance", alpha: 1, epsilon: 0 } });
      await window.core.fit(document);
      const saved = await window.core.save("bent.gltf", document);
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
  const text = await bend(page, { weights: { kind: "inverse-distance", alpha: 1, epsilon: 0 } });
  expect(vertices(text).length).toBe(vertices(chair.toString()).length);
});

test("a newer fit takes the place of an older one, and an aborted one ends at once", async ({ page }) => {
  await open(page, "chair.obj", chair);
  const [older, newer, stopped, afterwards] = await page.evaluate(async (p) => {
    const { core } = window;
    const endless = window.documentOf(p, p, { weights: { kind: "neural", width: 4096, seed: 0, steps: 100_000 } });
    const quick = window.documentOf(p, p, { weights: { kind: "inverse-distance", alpha: 1, epsilon: 0 } });
    const told: number[] = [];
    const slow = core.fit(endless, { progress: (_, fraction) => told.push(fraction) }).catch((error) => error.name);
    while (told.length < 2) await new Promise((resolve) => setTimeout(resolve, 20));
    const fast = await core.fit(quick);
    const older = await slow;
    const abort = new AbortController();
    const began = performance.now();
    const third = core.fit(endless, { signal: abort.signal }).catch((error) => error.name);
    setTimeout(() => abort.abort(), 200);
    const name = await third;
    const fourth = await core.fit(quick);
    return [older, Math.sqrt(fast.ownLogits.length), [name, performance.now() - began], Math.sqrt(fourth.ownLogits.length)] as const;
  }, points.map((p) => p.position));
  expect(older).toBe("AbortError");
  expect(newer).toBe(points.length);
  expect(stopped[0]).toBe("AbortError");
  expect(stopped[1]).toBeLessThan(10_000);
  expect(afterwards).toBe(points.length);
});

test("the control points land where the core says, and places are found for new ones", async ({ page }) => {
  await open(page, "chair.obj", chair);
  const { soft, distances, exact, places, again } = await page.evaluate(
    async ([p, q]) => {
      const { core, documentOf } = window;
      await core.fit(documentOf(p!, q!));
      const soft = await core.report(documentOf(p!, q!, { handles: "soft" }));
      return {
        soft: soft.places,
        distances: soft.distances,
        exact: (await core.report(documentOf(p!, q!))).places,
        places: [...(await core.farthestPoints(12))],
        again: [...(await core.farthestPoints(12))],
      };
    },
    [points.map((p) => p.position), moved],
  );
  expect(difference(soft, moved.flat())).toBeLessThan(0.05);
  expect(difference(soft, moved.flat())).toBeGreaterThan(1e-4);
  distances.forEach((away, i) => expect(away).toBeCloseTo(Math.hypot(...moved[i].map((c, k) => c - soft[3 * i + k])), 12));
  expect(difference(exact, moved.flat())).toBeLessThan(1e-9);
  expect(places).toHaveLength(36);
  expect(again).toEqual(places);
});

test("opens real files of every kind", async ({ page }) => {
  test.skip(!data, "there is no folder of real files: set NEURALMLS_DATA");
  const { execFileSync } = await import("node:child_process");
  const list = execFileSync("find", [data!, "-type", "f", "-size", "-3M"], { encoding: "utf8" }).trim().split("\n");
  const kinds = new Map<string, string>();
  // Those are to be refused, or have no size.
  for (const path of list.filter((path) => !/\/(torture|cases|splats)\//.test(path))) {
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
