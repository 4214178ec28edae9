/** Control points that arrive: live, undone, saved, and left soft where they must be. */

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { choose, drop, expect, fitted, opened, openSample, save, screenOf, session, test } from "./fixtures.ts";
import { difference, neuralmls as command, picture, samples, vertices } from "./tools.ts";

const chair = vertices(readFileSync(join(samples, "chair.obj"), "utf8"));
const given: number[][] = JSON.parse(readFileSync(join(samples, "chair.points.json"), "utf8")).control_points.map(
  (point: { position: number[] }) => point.position,
);

/** The vertex nearest to each of the sample's control points, so that what the surface does there can be read. */
const at = given.map((place) => {
  const away = (i: number) => Math.hypot(...place.map((c, k) => c - chair[3 * i + k]));
  return Array.from({ length: chair.length / 3 }, (_, i) => i).reduce((best, i) => (away(i) < away(best) ? i : best));
});

async function openOnVertices(editor: Page) {
  await drop(editor, join(samples, "chair.obj"), join(samples, "chair.mtl"));
  await opened(editor, "chair.obj");
  const control_points = at.map((i) => ({ name: `v${i}`, position: chair.slice(3 * i, 3 * i + 3) }));
  const file = { format: "neuralmls-control-points", version: 1, control_points };
  await drop(editor, { name: "vertices.json", bytes: Buffer.from(JSON.stringify(file)) });
  await expect.poll(async () => (await session(editor)).points.length).toBe(at.length);
  await fitted(editor);
}

/** How far the surface is from the target of its control point, at most, as a fraction of the box. */
async function miss(editor: Page): Promise<number> {
  const { points } = await session(editor);
  const shown = await editor.evaluate((at) => {
    const read = neuralmls.readback()!;
    return at.map((i) => [...read.slice(3 * i, 3 * i + 3)]);
  }, at);
  return Math.max(...points.map(({ target }, n) => Math.hypot(...target.map((c, k) => c - shown[n][k])))) / side;
}

const side = Math.max(...[0, 1, 2].map((k) => {
  const axis = chair.filter((_, i) => i % 3 === k);
  return Math.max(...axis) - Math.min(...axis);
}));

const exact = (editor: Page) => editor.getByRole("switch", { name: "Handles arrive" });

test("while a control point is dragged the surface stays under it, and with the switch off it stays behind", async ({ editor }) => {
  await openOnVertices(editor);
  await expect(exact(editor)).toBeChecked();
  const foot = (await session(editor)).points[0];
  const from = await screenOf(editor, foot.target);
  await editor.mouse.move(from.x, from.y);
  await editor.mouse.down();
  for (let step = 1; step <= 4; step++) {
    await editor.mouse.move(from.x - 20 * step, from.y + 8 * step);
    // The panels' session follows a drag at a distance; the mouse is held until it is there.
    await expect.poll(() => miss(editor)).toBeLessThan(1e-5);
    if (step === 3) await editor.screenshot({ path: picture("exact.png") });
  }
  await editor.mouse.up();
  expect((await session(editor)).points[0].target).not.toEqual(foot.target);
  await expect(editor.locator(".status-bar")).toContainText("on target");

  // The switch is live, is undone, and asks for no new fit.
  const fit = await editor.evaluate(() => neuralmls.state().fit);
  await exact(editor).click();
  await expect.poll(() => miss(editor)).toBeGreaterThan(1e-3);
  await expect(editor.locator(".status-bar")).toContainText("off target by at most");
  await editor.keyboard.press("Control+z");
  await expect(exact(editor)).toBeChecked();
  await expect.poll(() => miss(editor)).toBeLessThan(1e-5);
  expect(await editor.evaluate(() => neuralmls.state().fit)).toEqual(fit);
});

test("what is saved with half of the way is what the command line makes of the session", async ({ editor }, info) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const before = await editor.evaluate(() => [...neuralmls.readback()!]);
  const field = editor.getByRole("textbox", { name: "How closely" });
  await field.fill("7"); // is no part of it
  await field.press("Enter");
  expect((await session(editor)).settings.handles).toBe("auto");
  await field.fill("0.5");
  await field.press("Enter");
  expect((await session(editor)).settings.handles).toBe(0.5);
  const saved = await save(editor, /^Bent OBJ/);
  const points = await save(editor, /^Control points/);
  writeFileSync(info.outputPath("session.json"), points.bytes);
  const bend = (...options: string[]) => {
    const bent = info.outputPath("bent.obj");
    command("deform", join(samples, "chair.obj"), "--points", info.outputPath("session.json"), "-o", bent, "-q", "--force", ...options);
    return vertices(readFileSync(bent, "utf8"));
  };
  const right = bend();
  expect(difference(right, vertices(saved.bytes.toString()))).toBeLessThan(1e-6);
  expect(difference(right, await editor.evaluate(() => [...neuralmls.readback()!]))).toBeLessThan(1e-4);
  for (const other of [bend("--handles", "auto"), bend("--handles", "soft")]) expect(difference(right, other)).toBeGreaterThan(1e-3);
  // And the reverse: the editor takes up what the file says.
  await exact(editor).click();
  await drop(editor, { name: "session.json", bytes: points.bytes });
  await expect(editor.getByRole("textbox", { name: "How closely" })).toHaveValue("0.5");
  await fitted(editor);
  expect(difference(before, await editor.evaluate(() => [...neuralmls.readback()!]))).toBeGreaterThan(1e-4);
});

test("control points that own little are left soft, with a line that says what would help", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const { points } = await session(editor);
  await choose(editor, points[0].name);
  const temperature = editor.getByRole("textbox", { name: "Temperature" });
  await temperature.fill("8");
  await temperature.press("Enter");
  const line = editor.locator(".panel").getByText(/^Left soft: .* of the weight at its own place/);
  await expect(line).toBeVisible();
  await line.scrollIntoViewIfNeeded();
  await editor.screenshot({ path: picture("soft.png") });
  const [, helps] = /at temperature (\S+) they arrive/.exec(await line.innerText())!;
  await temperature.fill(helps);
  await temperature.press("Enter");
  await expect(line).toHaveCount(0);
  await expect(editor.locator(".status-bar")).toContainText("on target");
});

test("when a drag has ended it is said what is likely bad, and about which control points", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const advice = editor.locator(".advice");
  await editor.waitForTimeout(1500); // it would be there by now
  await expect(advice).toHaveCount(0);
  const { points } = await session(editor);
  const left = points.find(({ name }) => name === "back-top-left")!;
  await choose(editor, left.name);
  const field = editor.getByRole("textbox", { name: "Target x" });
  await field.fill(String(-2 * left.target[0]));
  await field.press("Enter");
  const line = editor.locator(".advice").getByText(/of the shape is folded over|Torn between/).first();
  await expect(line).toBeVisible();
  await line.scrollIntoViewIfNeeded();
  await editor.screenshot({ path: picture("advice.png") });
  const told = await editor.evaluate(() => neuralmls.state().advice);
  await line.click();
  expect(told.some(({ ids }) => ids.includes(left.id))).toBe(true);
  const { selection } = await session(editor);
  expect(told[0].ids).toEqual(expect.arrayContaining([...selection]));
  await editor.keyboard.press("Control+z"); // the selection
  await editor.keyboard.press("Control+z"); // and the move
  await expect(line).toHaveCount(0);
});
