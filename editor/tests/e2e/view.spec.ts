/** What is seen, and what pointers and fingers do on the view. */

import { join } from "node:path";
import type { Browser, Page } from "@playwright/test";
import { choose, drop, expect, fitted, opened, openSample, pixels, save, screenOf, session, test } from "./fixtures.ts";
import { samples } from "./tools.ts";

test("a finger selects in a box with the tool for it, and two fingers still move the view", async ({ browser, server }) => {
  const page = await tablet(browser, server.url);
  const { points } = await session(page);
  const before = await screenOf(page, points[0].target);
  await page.getByRole("button", { name: "A drag selects in a box" }).tap();
  const fingers = await fingersOf(page);
  await fingers.drag([[[180, 120], [660, 420]]]);
  const places = await Promise.all(points.map(async ({ id, target }) => ({ id, at: await screenOf(page, target) })));
  const inside = places.filter(({ at: { x, y } }) => x > 180 && x < 660 && y > 120 && y < 420).map(({ id }) => id);
  expect(inside.length).toBeGreaterThan(2);
  expect(inside.length).toBeLessThan(points.length);
  expect([...(await session(page)).selection].sort()).toEqual(inside.sort());
  const still = await screenOf(page, points[0].target);
  expect(Math.hypot(still.x - before.x, still.y - before.y)).toBeLessThan(0.01);
  // A tap on one of them takes it away from the others; one beside the shape takes all away.
  const last = places.find(({ id }) => id === inside[0])!;
  await page.touchscreen.tap(last.at.x, last.at.y);
  expect((await session(page)).selection).not.toContain(inside[0]);
  await page.touchscreen.tap(150, 700);
  expect((await session(page)).selection).toEqual([]);
  expect((await session(page)).points).toHaveLength(points.length);
  await fingers.drag([[[300, 300], [360, 340]], [[500, 300], [560, 340]]]);
  const after = await screenOf(page, points[0].target);
  expect(Math.hypot(after.x - before.x, after.y - before.y)).toBeGreaterThan(20);
  expect((await session(page)).selection).toEqual([]);
  await page.context().close();
});

test("with Ctrl the gizmo moves in steps", async ({ editor }) => {
  await drop(editor, join(samples, "chair.obj"), join(samples, "chair.points.json"));
  await opened(editor, "chair.obj");
  await fitted(editor);
  const [point] = (await session(editor)).points;
  await choose(editor, point.name);
  const at = await screenOf(editor, point.target);
  const above = await screenOf(editor, [point.target[0], point.target[1] + 0.1, point.target[2]]);
  const length = Math.hypot(above.x - at.x, above.y - at.y);
  const along = (far: number) => [at.x + (far * (above.x - at.x)) / length, at.y + (far * (above.y - at.y)) / length] as const;
  await editor.waitForTimeout(300); // the gizmo is there with the next frame
  await editor.mouse.move(...along(55), { steps: 4 });
  await editor.mouse.down();
  await editor.keyboard.down("Control");
  await editor.mouse.move(...along(122), { steps: 8 });
  await editor.mouse.up();
  await editor.keyboard.up("Control");
  const moved = (await session(editor)).points[0];
  const steps = (moved.target[1] - point.target[1]) / 0.02; // the chair is 0.98 high
  expect(steps).toBeGreaterThan(1.5);
  expect(Math.abs(steps - Math.round(steps))).toBeLessThan(1e-6);
});

test("in the comparison the gizmo is on the side that takes the pointer alone", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const { points } = await session(editor);
  await editor.getByRole("button", { name: "Compare" }).click();
  await expect.poll(() => editor.evaluate(() => neuralmls.state().comparisonFit.status), { timeout: 60_000 }).toBe("ready");
  await choose(editor, points[0].name);
  const half = (await editor.locator(".pane").boundingBox())!;
  const shown = () => seen(editor, { ...half, x: half.x + half.width });
  const chosen = await shown();
  await editor.getByRole("button", { name: "Delete the selected" }).focus(); // Escape is for the view, not for a field
  await editor.keyboard.press("Escape");
  expect((await session(editor)).selection).toEqual([]);
  const none = await shown();
  const at = await screenOf(editor, points[0].target);
  let [near, far] = [0, 0];
  for (let i = 0; i < none.rgba.length; i += 4) {
    const changed = [0, 1, 2].some((c) => Math.abs(none.rgba[i + c] - chosen.rgba[i + c]) > 8);
    const [x, y] = [(i / 4) % none.width, Math.floor(i / 4 / none.width)];
    if (changed) Math.hypot(x - at.x + half.x, y - at.y + half.y) < 20 ? near++ : far++;
  }
  expect(near).toBeGreaterThan(20);
  expect(far).toBe(0);
});

test("while one drags by an axis of the gizmo, a line in its colour shows it", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  await choose(editor, "armrest-left");
  const { target } = (await session(editor)).points.find(({ name }) => name === "armrest-left")!;
  const at = await screenOf(editor, target);
  const above = await screenOf(editor, [target[0], target[1] + 0.1, target[2]]);
  const length = Math.hypot(above.x - at.x, above.y - at.y);
  const along = (far: number) => ({ x: at.x + (far * (above.x - at.x)) / length, y: at.y + (far * (above.y - at.y)) / length });
  /** The part of the axis that is green, beyond the gizmo. */
  const green = async () => {
    const { width, rgba } = await pixels(editor, await editor.screenshot());
    const far = Array.from({ length: 60 }, (_, i) => along(100 + 2 * i));
    const isGreen = ({ x, y }: { x: number; y: number }) =>
      [-1, 0, 1].some((beside) => {
        const [r, g, b] = rgba.subarray(4 * (Math.round(y) * width + Math.round(x) + beside));
        return g! > r! + 10 && g! > b! + 10;
      });
    return far.filter(isGreen).length / far.length;
  };
  const drag = async () => {
    await editor.mouse.move(along(55).x, along(55).y, { steps: 4 });
    await editor.mouse.down();
    for (const far of [60, 65, 70]) await editor.mouse.move(along(far).x, along(far).y);
  };
  await editor.waitForTimeout(300); // the gizmo is there with the next frame
  expect(await green()).toBe(0);
  await drag();
  await expect.poll(green).toBeGreaterThan(0.9);
  await editor.keyboard.press("Escape");
  await expect.poll(green).toBe(0);
  await editor.mouse.up();
  await drag();
  await expect.poll(green).toBeGreaterThan(0.9);
  await editor.mouse.up();
  await expect.poll(green).toBe(0);
});

test("in the comparison both halves take the pointer", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const before = (await session(editor)).points.find(({ name }) => name === "back-top-left")!;
  await editor.getByRole("button", { name: "Compare" }).click();
  await expect.poll(() => editor.evaluate(() => neuralmls.state().comparisonFit.status), { timeout: 60_000 }).toBe("ready");
  const left = await screenOf(editor, before.target);
  const { width } = (await editor.locator(".pane").boundingBox())!;

  // A drag of a control point, which follows the mouse.
  await editor.mouse.move(left.x + width, left.y);
  await editor.mouse.down();
  await editor.mouse.move(left.x + width + 40, left.y - 30, { steps: 5 });
  await editor.mouse.up();
  const moved = (await session(editor)).points.find(({ id }) => id === before.id)!;
  const there = await screenOf(editor, moved.target);
  expect(Math.hypot(there.x - left.x - width - 40, there.y - left.y + 30)).toBeLessThan(2);

  // A click meets the surface that is seen there, which the other weights have taken elsewhere.
  const click = async (x: number, y: number) => {
    const { points } = await session(editor);
    await editor.mouse.move(x, y);
    await editor.mouse.click(x, y);
    const after = (await session(editor)).points;
    expect(after).toHaveLength(points.length + 1);
    const added = after.at(-1)!;
    const seen = await screenOf(editor, added.target);
    expect(Math.hypot(seen.x - x, seen.y - y)).toBeLessThan(1);
    await editor.keyboard.press("Control+z");
    await fitted(editor);
    return added.position;
  };
  await editor.keyboard.press("Escape"); // the gizmo is not in the way
  const cushion = await screenOf(editor, [0, 0.47, 0]);
  const onRight = await click(cushion.x, cushion.y);
  const onLeft = await click(cushion.x - width, cushion.y);
  expect(Math.hypot(...onRight.map((c, k) => c - onLeft[k]!))).toBeGreaterThan(1e-4);

  // Turning and zooming, seen in both halves alike.
  const empty = { x: width + 60, y: 600 };
  await editor.mouse.move(empty.x, empty.y);
  const turned = await screenOf(editor, before.target);
  await editor.mouse.down();
  await editor.mouse.move(empty.x + 60, empty.y, { steps: 4 });
  await editor.mouse.up();
  const zoomed = await screenOf(editor, before.target);
  expect(Math.hypot(zoomed.x - turned.x, zoomed.y - turned.y)).toBeGreaterThan(10);
  await editor.mouse.wheel(0, -500);
  await expect.poll(async () => {
    const now = await screenOf(editor, before.target);
    return Math.hypot(now.x - zoomed.x, now.y - zoomed.y);
  }).toBeGreaterThan(10);
});

test("in the comparison a finger selects in the right half", async ({ browser, server }) => {
  const page = await tablet(browser, server.url);
  await page.getByRole("button", { name: "Compare" }).tap();
  await expect.poll(() => page.evaluate(() => neuralmls.state().comparisonFit.status), { timeout: 60_000 }).toBe("ready");
  const [point] = (await session(page)).points;
  const at = await screenOf(page, point!.target);
  const { width } = (await page.locator(".pane").boundingBox())!;
  await page.touchscreen.tap(at.x + width, at.y);
  expect((await session(page)).selection).toEqual([point!.id]);
  await page.context().close();
});

test("names are whole in the list of control points, and the panel's end can be reached in a low window", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  await editor.locator("label", { hasText: /^X$/ }).click();
  await expect.poll(async () => (await session(editor)).settings.mirror).toBe("x");
  const list = editor.getByRole("list", { name: "Control points" });
  const cut = await list.locator(".name").evaluateAll((names) => names.filter((name) => name.scrollWidth > name.clientWidth).map((name) => name.textContent));
  expect(cut).toEqual([]);
  // What is chosen on the shape is brought into sight in the list.
  const { points } = await session(editor);
  await editor.evaluate(() => (document.activeElement as HTMLElement).blur());
  await editor.keyboard.press("Shift+N");
  expect((await session(editor)).selection).toEqual([points.at(-1)!.id]);
  await expect(list.getByRole("button").last()).toBeInViewport({ ratio: 1 });
  const panel = editor.locator(".panel");
  await panel.evaluate((panel) => panel.scrollTo(0, panel.scrollHeight));
  await expect(editor.getByRole("slider", { name: "How closely" })).toBeInViewport({ ratio: 1 });
});

test("a cloud of points is shaded by depth", async ({ editor }) => {
  const lines: string[] = [];
  // A ball in front of a wall.
  for (let i = 0; i < 20_000; i++) {
    const [z, turn] = [1 - (2 * i + 1) / 20_000, 2.399963 * i];
    const r = Math.sqrt(1 - z * z);
    lines.push(`${0.4 * r * Math.cos(turn)} ${0.4 * r * Math.sin(turn)} ${0.4 * z}`);
    lines.push(`${2 * ((i * 0.618034) % 1) - 1} ${(2 * i) / 20_000 - 1} -0.6`);
  }
  await drop(editor, { name: "ball.xyz", bytes: Buffer.from(lines.join("\n")) });
  await opened(editor, "ball.xyz");
  const { rgba } = await pixels(editor, (await save(editor, /^Picture/)).bytes);
  const shades: number[] = [];
  for (let i = 0; i < rgba.length; i += 4) if (rgba[i + 3] === 255) shades.push(rgba[i]);
  const brightest = shades.reduce((most, shade) => Math.max(most, shade), 0);
  const dark = shades.filter((shade) => shade < 0.8 * brightest).length / shades.length;
  expect(shades.length).toBeGreaterThan(50_000);
  expect(dark).toBeGreaterThan(0.005);
  expect(dark).toBeLessThan(0.5);
});

/** The chair on a screen for fingers. */
async function tablet(browser: Browser, url: string): Promise<Page> {
  const context = await browser.newContext({ viewport: { width: 1024, height: 768 }, hasTouch: true });
  const page = await context.newPage();
  await page.goto(url);
  await page.getByRole("button", { name: "Chair", exact: true }).tap();
  await opened(page, "chair.obj");
  await fitted(page);
  return page;
}

/** A part of the page when nothing moves in it any more. */
async function seen(page: Page, clip: { x: number; y: number; width: number; height: number }) {
  let before = await page.screenshot({ clip });
  for (;;) {
    const now = await page.screenshot({ clip });
    if (now.equals(before)) return pixels(page, now);
    before = now;
  }
}

/** Real fingers, which Playwright has for taps only. */
async function fingersOf(page: Page) {
  const browser = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", touchPoints: { x: number; y: number; id: number }[]) =>
    browser.send("Input.dispatchTouchEvent", { type, touchPoints });
  return {
    /** Each finger from a place to another. */
    async drag(ways: [[number, number], [number, number]][]) {
      const at = (share: number) =>
        ways.map(([from, to], id) => ({ x: from[0] + share * (to[0] - from[0]), y: from[1] + share * (to[1] - from[1]), id }));
      for (let fingers = 1; fingers <= ways.length; fingers++) await touch("touchStart", at(0).slice(0, fingers));
      for (let step = 1; step <= 6; step++) await touch("touchMove", at(step / 6));
      await touch("touchEnd", []);
    },
  };
}
