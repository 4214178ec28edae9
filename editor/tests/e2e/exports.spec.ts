/** What the editor saves besides the bent file: a page to drag, a GLB with a morph target, a picture. */

import { writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { expect, fitted, note, openSample, save, test } from "./fixtures.ts";
import { difference, vertices } from "./tools.ts";

test("the page to drag works offline, from a file, and asks nobody", async ({ editor, browser }, info) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const page = await save(editor, /^Page to drag/);
  expect(page.name).toBe("chair.html");
  writeFileSync(info.outputPath("chair.html"), page.bytes);

  const context = await browser.newContext({ viewport: { width: 900, height: 700 } });
  await context.setOffline(true);
  const notes = note(context);
  const offline = await context.newPage();
  const address = pathToFileURL(info.outputPath("chair.html")).href;
  await offline.goto(address);
  await expect(offline.locator("canvas")).toBeVisible();
  const picture = () => offline.locator("#view").screenshot();
  const settled = async () => {
    let before = await picture();
    for (;;) {
      const now = await picture();
      if (now.equals(before)) return now;
      before = now;
    }
  };
  const before = await settled();
  // A warmer temperature bends it otherwise; Undo takes that back.
  await offline.locator("#temperature").fill("360");
  const warm = await settled();
  expect(warm.equals(before)).toBe(false);
  await offline.locator("#temperature").blur();
  await offline.getByRole("button", { name: "Undo" }).click();
  await offline.mouse.move(5, 5);
  expect((await settled()).equals(before)).toBe(true);
  await offline.getByRole("button", { name: "Reset" }).click();
  expect((await settled()).equals(before)).toBe(false);
  expect(notes.requests.filter((url) => url !== address && !/^(data|blob):/.test(url))).toEqual([]);
  expect(notes.errors).toEqual([]);
  await context.close();
});

test("the GLB holds the shape at rest, and as a morph target the bent one", async ({ editor }) => {
  await openSample(editor, "Table");
  await fitted(editor);
  const bent = vertices((await save(editor, /^Bent OBJ/)).bytes.toString());
  const { name, bytes } = await save(editor, /^GLB/);
  expect(name).toBe("table-morph.glb");
  expect(bytes.subarray(0, 4).toString()).toBe("glTF");
  const length = bytes.readUInt32LE(12);
  const document = JSON.parse(bytes.subarray(20, 20 + length).toString());
  const binary = bytes.subarray(20 + length + 8);
  const floats = (accessor: number): Float32Array => {
    const { bufferView, byteOffset = 0, count } = document.accessors[accessor];
    const start = (document.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
    return new Float32Array(binary.buffer.slice(binary.byteOffset + start, binary.byteOffset + start + 12 * count));
  };
  const [primitive] = document.meshes[0].primitives;
  const rest = floats(primitive.attributes.POSITION);
  const by = floats(primitive.targets[0].POSITION);
  // Each vertex of the mesh, moved, is one of the bent file's.
  const key = (x: number, y: number, z: number) => [x, y, z].map((c) => Math.round(c * 1e4)).join();
  const near = new Set<string>();
  for (let i = 0; i < bent.length; i += 3) {
    for (const [a, b, c] of corners) near.add(key(bent[i] + a, bent[i + 1] + b, bent[i + 2] + c));
  }
  const moved = Float32Array.from(rest, (c, at) => c + by[at]);
  for (let i = 0; i < moved.length; i += 3) expect(near.has(key(moved[i], moved[i + 1], moved[i + 2]))).toBe(true);
  expect(difference(moved, rest)).toBeGreaterThan(0.01);
});

test("the picture is a PNG of the view", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const { name, bytes } = await save(editor, /^Picture/);
  expect(name).toBe("chair.png");
  expect(bytes.subarray(1, 4).toString()).toBe("PNG");
  const [width, height] = [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
  expect(width).toBeGreaterThan(800);
  expect(height).toBeGreaterThan(500);
  expect(bytes.length).toBeGreaterThan(20_000);
});

const corners = [-5e-5, 0, 5e-5].flatMap((a) => [-5e-5, 0, 5e-5].flatMap((b) => [-5e-5, 0, 5e-5].map((c) => [a, b, c])));
