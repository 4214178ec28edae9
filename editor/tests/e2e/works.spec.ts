/** Accidents: whatever happens to a tab, the work is there. */

import { copyFileSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import type { State } from "../../src/app/state.ts";
import { choose, drop, expect, fitted, note, opened, openSample, serve, session, test } from "./fixtures.ts";
import { samples } from "./tools.ts";

/** Moves the first control point of the open shape, as a person does with its field; tells the session then. */
async function move(page: Page, by = 0.2): Promise<State["session"]> {
  await fitted(page);
  const { points } = await session(page);
  await choose(page, points[0].name);
  const field = page.getByRole("textbox", { name: "Target y" });
  await field.fill(String(points[0].target[1] + by));
  await field.press("Enter");
  const after = await session(page);
  expect(after.points[0].target[1]).toBeCloseTo(points[0].target[1] + by, 6);
  return after;
}

/** Until the browser has all of it. */
const kept = (page: Page) => expect(page.getByText(/^kept /)).toBeVisible();

const told = ({ points, settings }: State["session"]) => ({ settings, points: points.map(({ name, position, target }) => ({ name, position, target })) });

async function isThere(page: Page, before: State["session"], name: string): Promise<void> {
  await opened(page, name);
  await expect.poll(async () => told(await session(page))).toEqual(told(before));
}

/** What the list of earlier work names. */
const card = (page: Page, name: string) => page.locator(".work-card", { hasText: name });

test("the page is loaded again", async ({ editor }) => {
  await openSample(editor, "Table");
  const before = await move(editor);
  await kept(editor);
  await editor.reload();
  await isThere(editor, before, "table.obj");
});

test("the page is loaded again at once", async ({ editor }) => {
  await openSample(editor, "Table");
  await move(editor);
  await kept(editor);
  const before = await move(editor, 0.1);
  await editor.reload();
  await isThere(editor, before, "table.obj");
});

test("the tab is closed at once, and another one opened", async ({ editor, context, server }) => {
  await openSample(editor, "Table");
  await move(editor);
  await kept(editor);
  const before = await move(editor, 0.1);
  await editor.close({ runBeforeUnload: true });
  const again = await context.newPage();
  await again.goto(server.url);
  await card(again, "table.obj").click();
  await isThere(again, before, "table.obj");
});

test("the tab crashes", async ({ editor, context, server }) => {
  await openSample(editor, "Table");
  const before = await move(editor);
  await kept(editor);
  const crashed = editor.waitForEvent("crash");
  editor.goto("chrome://crash").catch(() => undefined);
  await crashed;
  const again = await context.newPage();
  await again.goto(server.url);
  await card(again, "table.obj").click();
  await isThere(again, before, "table.obj");
});

test("another shape is opened, and dropped: the first is one click away, with its picture", async ({ editor }) => {
  await openSample(editor, "Table");
  const before = await move(editor);
  await drop(editor, join(samples, "chair.obj"), join(samples, "chair.mtl"));
  await opened(editor, "chair.obj");
  await expect(editor.getByText("Your work on table.obj is kept")).toBeVisible();
  await editor.getByRole("button", { name: "Go back to it" }).click();
  await isThere(editor, before, "table.obj");

  await editor.getByRole("button", { name: "Samples" }).click();
  await editor.getByRole("menuitem", { name: "Car" }).click();
  await opened(editor, "car.obj");
  await editor.getByRole("button", { name: "Recent" }).click();
  await editor.getByRole("menuitem", { name: "table.obj" }).click();
  await isThere(editor, before, "table.obj");
  await editor.evaluate(() => sessionStorage.clear());
  await editor.reload();
  await expect(card(editor, "table.obj").locator("img")).toHaveAttribute("src", /^data:image/);
});

test("two tabs keep two works", async ({ editor, context, server }) => {
  const other = await context.newPage();
  await other.goto(server.url);
  await openSample(editor, "Table");
  await openSample(other, "Chair");
  const [table, chair] = [await move(editor), await move(other, 0.1)];
  await Promise.all([kept(editor), kept(other)]);
  await editor.reload();
  await isThere(editor, table, "table.obj");
  await editor.close();
  await other.close();
  const again = await context.newPage();
  await again.goto(server.url);
  await card(again, "chair.obj").click();
  await isThere(again, chair, "chair.obj");
  await again.getByRole("button", { name: "Recent" }).click();
  await again.getByRole("menuitem", { name: "table.obj" }).click();
  await isThere(again, table, "table.obj");
});

test("a duplicated tab has a copy of its own", async ({ editor, context, server }) => {
  await openSample(editor, "Table");
  const before = await move(editor);
  await kept(editor);
  const id = await editor.evaluate(() => sessionStorage.getItem("neuralmls-work"));
  const duplicate = await context.newPage();
  await duplicate.addInitScript((id) => sessionStorage.getItem("neuralmls-work") ?? sessionStorage.setItem("neuralmls-work", id!), id);
  await duplicate.goto(server.url);
  await isThere(duplicate, before, "table.obj");
  await move(duplicate, 0.3);
  await kept(duplicate);
  expect(await duplicate.evaluate(() => sessionStorage.getItem("neuralmls-work"))).not.toBe(id);
  await editor.reload();
  await isThere(editor, before, "table.obj");
});

test("neuralmls edit: the page is loaded again; and the same file is opened on another day", async ({ browser }) => {
  const folder = mkdtempSync(join(tmpdir(), "neuralmls-"));
  for (const name of ["table.obj", "table.mtl", "table.points.json"]) copyFileSync(join(samples, name), join(folder, name));
  const options = [join(folder, "table.obj"), "--points", join(folder, "table.points.json")];
  const context = await browser.newContext();
  const notes = note(context);
  const server = await serve(...options);
  const page = await context.newPage();
  await page.goto(server.url);
  await opened(page, "table.obj");
  const before = await move(page);
  await kept(page);
  await page.reload();
  await isThere(page, before, "table.obj");
  await page.close();

  // The address of another day may be of another port, to which a browser's storage does not belong; this one goes on.
  const again = await context.newPage();
  await again.goto(server.url);
  await expect(again.getByText(/You have worked on table\.obj before/)).toBeVisible();
  await again.getByRole("button", { name: "Take it up again" }).click();
  await isThere(again, before, "table.obj");
  expect(notes.errors).toEqual([]);
  await context.close();
  expect(await server.stop()).toBe(0);
});

test("the browser has no room: it says so, and asks before the work is replaced", async ({ editor }) => {
  await editor.evaluate(() => {
    IDBObjectStore.prototype.put = () => {
      throw new DOMException("full", "QuotaExceededError");
    };
  });
  await openSample(editor, "Table");
  const before = await move(editor);
  await expect(editor.getByText(/The browser does not keep this work/)).toBeVisible();
  await expect(editor.getByText("not kept: save it")).toBeVisible();
  const asked: string[] = [];
  editor.once("dialog", (dialog) => (asked.push(dialog.message()), dialog.dismiss()));
  await drop(editor, join(samples, "chair.obj"), join(samples, "chair.mtl"));
  await expect.poll(() => asked).toEqual(["The browser did not keep the work on table.obj. Open chair.obj, and lose it?"]);
  await isThere(editor, before, "table.obj");
  editor.once("dialog", (dialog) => dialog.accept());
  await drop(editor, join(samples, "chair.obj"), join(samples, "chair.mtl"));
  await opened(editor, "chair.obj");
});

test("all workers are killed", async ({ editor }) => {
  await openSample(editor, "Table");
  await fitted(editor);
  for (const worker of editor.workers()) await worker.evaluate(() => self.close()).catch(() => undefined);
  const { points } = await session(editor);
  await choose(editor, points[0].name);
  const field = editor.getByRole("textbox", { name: "Target y" });
  await field.fill(String(points[0].target[1] + 0.2));
  await field.press("Enter");
  const before = await session(editor);
  await kept(editor);
  await editor.reload();
  await isThere(editor, before, "table.obj");
});

test("what is not wanted is forgotten", async ({ editor, context, server }) => {
  await openSample(editor, "Table");
  await move(editor);
  await kept(editor);
  await editor.close();
  const again = await context.newPage();
  await again.goto(server.url);
  await again.getByRole("button", { name: "Forget table.obj" }).click();
  await expect(card(again, "table.obj")).toHaveCount(0);
  await again.reload();
  await expect(again.getByRole("heading", { name: "Drop a shape here" })).toBeVisible();
  await expect(card(again, "table.obj")).toHaveCount(0);
});
