/** The elastic finish in the editor: fitted as it leaves 0, live in a drag, saved as it is shown, taken up again. */

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import { drop, expect, fitted, openSample, save, screenOf, session, test } from "./fixtures.ts";
import { difference, neuralmls as command, picture, samples, vertices } from "./tools.ts";

const relax = (editor: Page) => editor.getByRole("textbox", { name: "Relax" });
const shown = (editor: Page) => editor.evaluate(() => [...neuralmls.readback()!]);
const fit = (editor: Page) => editor.evaluate(() => neuralmls.state().fit);

async function setRelax(editor: Page, value: string): Promise<void> {
  await relax(editor).fill(value);
  await relax(editor).press("Enter");
  await fitted(editor);
}

test.setTimeout(180_000); // the command line runs six times

test("relaxed, the shape is shown in a drag as it is saved, and as the command line makes it", async ({ editor }, info) => {
  await openSample(editor, "Chair");
  await editor.locator("label", { hasText: /^Inverse distance$/ }).click();
  await fitted(editor);

  // The core's result of the session as it is, with options of its own.
  const expected = async (...options: string[]) => {
    const { points, settings } = await session(editor);
    const control_points = points.map(({ name, position, target }) => ({ name, position, target }));
    const { relax, temperature, transform, handles } = settings;
    const document = { control_points, settings: { weights: { kind: settings.kind, ...settings.weights["inverse-distance"] }, relax, temperature, transform, handles } };
    writeFileSync(info.outputPath("now.json"), JSON.stringify({ format: "neuralmls-control-points", version: 2, ...document }));
    command("deform", join(samples, "chair.obj"), "--points", info.outputPath("now.json"), "-o", info.outputPath("now.obj"), "-q", "--force", ...options);
    return vertices(readFileSync(info.outputPath("now.obj"), "utf8"));
  };
  const plainFit = await fit(editor);
  await setRelax(editor, "1");
  expect(await fit(editor)).not.toEqual(plainFit);
  const relaxedFit = await fit(editor);

  const { points } = await session(editor);
  const foot = points.find(({ name }) => name === "front-left-foot")!;
  const at = await screenOf(editor, foot.target);
  await editor.mouse.move(at.x, at.y);
  await editor.mouse.down();
  await editor.mouse.move(at.x + 30, at.y + 50, { steps: 12 });
  // Still held; what the editor tells of itself follows a drag at a distance.
  await expect
    .poll(async () => {
      const { target } = (await session(editor)).points.find(({ id }) => id === foot.id)!;
      const now = await screenOf(editor, target);
      return Math.hypot(now.x - at.x - 30, now.y - at.y - 50);
    })
    .toBeLessThan(0.5);
  const right = await expected();
  expect(difference(right, await expected("--relax", "0"))).toBeGreaterThan(0.01);
  await expect.poll(async () => difference(right, await shown(editor))).toBeLessThan(1e-5);
  await editor.screenshot({ path: picture("relax.png") });
  await editor.mouse.up();
  expect(difference(right, await shown(editor))).toBeLessThan(1e-5);

  const saved = await save(editor, /^Bent OBJ/);
  expect(difference(right, vertices(saved.bytes.toString()))).toBeLessThan(1e-6);
  const file = await save(editor, /^Control points/);
  expect(JSON.parse(file.bytes.toString()).settings.relax).toBe(1);

  // Sliding and undoing fit nothing, and the shape follows.
  await setRelax(editor, "0.5");
  const half = await expected();
  await expect.poll(async () => difference(half, await shown(editor))).toBeLessThan(1e-5);
  await setRelax(editor, "0");
  const plain = await expected();
  await expect.poll(async () => difference(plain, await shown(editor))).toBeLessThan(1e-4);
  await editor.getByRole("button", { name: "Undo: Relax" }).click();
  await editor.getByRole("button", { name: "Undo: Relax" }).click();
  expect((await session(editor)).settings.relax).toBe(1);
  await expect.poll(async () => difference(right, await shown(editor))).toBeLessThan(1e-5);
  expect(await fit(editor)).toEqual(relaxedFit);

  // And the reverse: the editor takes up what the file says.
  await setRelax(editor, "0");
  await drop(editor, { name: "session.json", bytes: file.bytes });
  await expect(relax(editor)).toHaveValue("1");
  await fitted(editor);
  await expect.poll(async () => difference(right, await shown(editor))).toBeLessThan(1e-5);

  // A page is dragged by the graphics card alone, which knows nothing of it.
  await editor.getByRole("button", { name: "Save" }).click();
  await editor.getByRole("menuitem", { name: /page/i }).click();
  await expect(editor.getByRole("alert").filter({ hasText: "A page is dragged without relax" })).toBeVisible();
});
