/** The built editor as `neuralmls edit` serves it, in a page that notes what it should not do. */

import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { type BrowserContext, test as base, expect, type Page } from "@playwright/test";
import type { State } from "../../src/app/state.ts";
import { program } from "./tools.ts";

declare global {
  var neuralmls: {
    readback(): Float64Array | undefined;
    screenOf(place: readonly [number, number, number]): { x: number; y: number };
    state(): State;
  };
}

/** A running `neuralmls edit`. */
export interface Server {
  url: string;
  stop(): Promise<number | null>;
}

export async function serve(...options: string[]): Promise<Server> {
  const child = spawn(program, ["edit", "--no-browser", ...options], { stdio: ["ignore", "pipe", "pipe"] });
  const ended = new Promise<number | null>((resolve) => child.on("exit", resolve));
  for await (const line of createInterface(child.stderr)) {
    const url = /http:\/\/\S+/.exec(line)?.[0];
    if (url) {
      child.stderr.resume();
      return { url, stop: () => (child.kill("SIGINT"), ended) };
    }
    throw new Error(line);
  }
  throw new Error("neuralmls edit said nothing");
}

/** What pages asked for and what went wrong in them. */
export interface Notes {
  requests: string[];
  /** Those that the browser refused, and why. */
  refused: Map<string, string>;
  errors: string[];
}

export function note(context: BrowserContext): Notes {
  const notes: Notes = { requests: [], refused: new Map(), errors: [] };
  context.on("request", (request) => notes.requests.push(request.url()));
  context.on("requestfailed", (request) => notes.refused.set(request.url(), request.failure()?.errorText ?? ""));
  context.on("weberror", (error) => notes.errors.push(String(error.error())));
  context.on("console", (message) => {
    if (message.type() === "error") notes.errors.push(message.text());
  });
  return notes;
}

/** The editor without a shape, in an empty browser; every test also holds that nothing went wrong, and nobody else was asked. */
export const test = base.extend<{ editor: Page; notes: Notes }, { server: Server }>({
  server: [
    // biome-ignore lint: Playwright reads the names of the first argument
    async ({}, use) => {
      const server = await serve();
      await use(server);
      expect(await server.stop()).toBe(0);
    },
    { scope: "worker" },
  ],
  notes: async ({ context, server }, use) => {
    const notes = note(context);
    await use(notes);
    const foreign = notes.requests.filter((url) => !url.startsWith(server.url) && !/^(blob|data):/.test(url));
    expect(foreign, "requests to other places").toEqual([]);
    expect(notes.errors, "errors in the console").toEqual([]);
  },
  editor: async ({ page, notes, server }, use) => {
    void notes;
    await page.goto(server.url);
    await expect(page.getByRole("heading", { name: "Drop a shape here" })).toBeVisible();
    await use(page);
  },
});

export { expect };

/** Drops files on the page, as a person's hand does. */
export async function drop(page: Page, ...files: (string | { name: string; bytes: Buffer })[]): Promise<void> {
  const contents = files.map((file) =>
    typeof file === "string"
      ? { name: basename(file), base64: readFileSync(file).toString("base64") }
      : { name: file.name, base64: file.bytes.toString("base64") },
  );
  const transfer = await page.evaluateHandle((contents) => {
    const transfer = new DataTransfer();
    for (const { name, base64 } of contents) {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      transfer.items.add(new File([bytes], name));
    }
    return transfer;
  }, contents);
  for (const type of ["dragenter", "dragover", "drop"]) await page.dispatchEvent("body", type, { dataTransfer: transfer });
}

/** The session as the editor has it. */
export const session = (page: Page) => page.evaluate(() => neuralmls.state().session);

/** Waits until the weights belong to the control points. */
export async function fitted(page: Page): Promise<void> {
  await expect(page.locator(".fit")).toHaveText(/^Ready/, { timeout: 20_000 });
}

export async function opened(page: Page, name: string): Promise<void> {
  await expect(page.locator(".file-name strong")).toHaveText(name, { timeout: 20_000 });
  await expect(page.locator(".busy")).toHaveCount(0);
}

export async function openSample(page: Page, title: string): Promise<void> {
  await page.getByRole("button", { name: title, exact: true }).click();
  await opened(page, `${title.toLowerCase()}.obj`);
}

/** Selects a control point in the list. */
export async function choose(page: Page, name: string): Promise<void> {
  await page.getByRole("list", { name: "Control points" }).getByRole("button", { name }).first().click();
  await expect(page.getByRole("textbox", { name: "Name" })).toHaveValue(name);
}

/** Where a place of the shape is seen. */
export const screenOf = (page: Page, place: readonly number[]) =>
  page.evaluate((place) => neuralmls.screenOf(place as [number, number, number]), place);

/** Clicks on the shape where a place is seen. */
export async function clickAt(page: Page, place: readonly number[]): Promise<void> {
  const { x, y } = await screenOf(page, place);
  await page.mouse.click(x, y);
}

/** What a click on an entry of the menu Save downloads: file names and texts. */
export async function save(page: Page, entry: RegExp): Promise<{ name: string; bytes: Buffer }> {
  await page.getByRole("button", { name: "Save" }).click();
  const [download] = await Promise.all([
    page.waitForEvent("download", { timeout: 20_000 }),
    page.getByRole("menuitem", { name: entry }).click(),
  ]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

/** The pixels of a picture, four bytes each. */
export async function pixels(page: Page, png: Buffer): Promise<{ width: number; height: number; rgba: Uint8Array }> {
  const { width, height, base64 } = await page.evaluate(async (base64) => {
    const blob = new Blob([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], { type: "image/png" });
    const image = await createImageBitmap(blob);
    const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d")!;
    canvas.drawImage(image, 0, 0);
    const { data } = canvas.getImageData(0, 0, image.width, image.height);
    let text = "";
    for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
    return { width: image.width, height: image.height, base64: btoa(text) };
  }, png.toString("base64"));
  return { width, height, rgba: new Uint8Array(Buffer.from(base64, "base64")) };
}
