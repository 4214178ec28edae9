/** The editor's figures, for `python -m benchmarks --only editor`: written as JSON to the file that $NEURALMLS_FIGURES names. */

import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { compare, published, sample } from "../e2e/cases.ts";
import { drop, expect, fitted, opened, openSample, save, session, test } from "../e2e/fixtures.ts";
import { difference, neuralmls as command, root, samples, vertices } from "../e2e/tools.ts";

declare global {
  var measured: Promise<{ frames: number; fit: number }>;
}

const quick = process.env.NEURALMLS_QUICK === "1";
const rounds = quick ? 1 : 7;
const figures: { what: string; value: number; unit: "s" | "B"; bar: number | null }[] = [];
const answers: { what: string; error: number; tolerance: number }[] = [];
const notes: string[] = [];

test.describe.configure({ mode: "serial", timeout: 120_000 });

test.afterAll(() => {
  if (process.env.NEURALMLS_FIGURES) writeFileSync(process.env.NEURALMLS_FIGURES, JSON.stringify({ figures, answers, notes }));
});

const median = (values: number[]) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

test("first load", async ({ context, server }) => {
  const seconds: number[] = [];
  for (let round = 0; round < rounds; round++) {
    const page = await context.newPage();
    await page.goto(server.url);
    seconds.push(
      await page.evaluate(
        () =>
          new Promise<number>((resolve) => {
            // Interactive: the samples can be clicked, and a task that comes now is not kept waiting.
            const look = () => {
              if (document.querySelector(".samples button")) setTimeout(() => resolve(performance.now() / 1000));
              else requestAnimationFrame(look);
            };
            look();
          }),
      ),
    );
    await page.close();
  }
  figures.push({ what: "first load to interactive", value: median(seconds), unit: "s", bar: 2 });
  const folder = join(root, "python/neuralmls/editor_server/static/assets");
  for (const ending of [".js", ".wasm"]) {
    const files = readdirSync(folder).filter((name) => name.endsWith(ending));
    const bytes = files.reduce((sum, name) => sum + gzipSync(readFileSync(join(folder, name))).length, 0);
    figures.push({ what: `  all ${ending.slice(1).toUpperCase()}, compressed`, value: bytes, unit: "B", bar: 1e6 });
  }
});

test("refit after adding a control point", async ({ editor }) => {
  await drop(editor, join(samples, "chair.obj"));
  await opened(editor, "chair.obj");
  const count = editor.getByRole("textbox", { name: "How many control points to place" });
  await count.fill("9");
  await count.press("Enter");
  await editor.getByRole("button", { name: "Place 9" }).click();
  await fitted(editor);
  expect((await session(editor)).points).toHaveLength(9);
  const seat = await editor.evaluate(() => neuralmls.screenOf([0, 0.47, 0.05]));
  await editor.mouse.click(120, 640); // beside the shape: nothing is selected, and no gizmo lies above the seat
  const [fits, feedback]: number[][] = [[], []];
  for (let round = 0; round < rounds; round++) {
    await editor.evaluate(() => {
      globalThis.measured = new Promise((resolve) => {
        const began = () => {
          const start = performance.now();
          let [frames, seen] = [0, 0];
          const look = () => {
            frames++;
            const { fit, session } = neuralmls.state();
            const added = session.points.length === 10;
            // The point in the list, and the word that weights are being fitted.
            if (!seen && added && document.querySelectorAll(".points li").length === 10) seen = frames;
            if (added && fit.status === "ready") resolve({ frames: seen, fit: (performance.now() - start) / 1000 });
            else requestAnimationFrame(look);
          };
          requestAnimationFrame(look);
        };
        addEventListener("pointerup", began, { once: true, capture: true });
      });
    });
    await editor.mouse.click(seat.x, seat.y);
    const { frames, fit } = await editor.evaluate(() => measured);
    fits.push(fit);
    feedback.push(frames);
    expect((await session(editor)).points).toHaveLength(10);
    await editor.keyboard.press("Control+z");
    await fitted(editor);
  }
  figures.push({ what: "refit after adding a point, chair, 10 points, width 1024", value: median(fits), unit: "s", bar: 1 });
  notes.push(`the new point and the word that weights are being fitted are seen in frame ${median(feedback)} after the click (bar: 1)`);
});

test("JavaScript of a frame while dragging", async ({ editor }) => {
  const rows = quick ? 40 : 316;
  await drop(editor, { name: "bumps.obj", bytes: Buffer.from(bumps(rows)) });
  await opened(editor, "bumps.obj");
  await editor.getByRole("button", { name: "Place 12" }).click();
  await fitted(editor);
  const { points } = await session(editor);
  expect(points).toHaveLength(12);
  // The one nearest to the middle of the view, where nothing lies above it.
  const places = await editor.evaluate((points) => points.map(({ target }) => neuralmls.screenOf(target)), points);
  const middle = { x: 487, y: 380 };
  const away = (at: { x: number; y: number }) => Math.hypot(at.x - middle.x, at.y - middle.y);
  const at = places.reduce((best, place) => (away(place) < away(best) ? place : best));
  await editor.mouse.move(at.x, at.y);
  await editor.mouse.down();
  const steps = quick ? 10 : 60;
  const page = await editor.context().newCDPSession(editor);
  await page.send("Performance.enable", { timeDomain: "threadTicks" });
  const scripts = async () => (await page.send("Performance.getMetrics")).metrics.find(({ name }) => name === "ScriptDuration")!.value;
  const before = await scripts();
  const began = Date.now();
  for (let step = 0; step < steps; step++) {
    await editor.mouse.move(at.x + 40 * Math.sin(step / 5), at.y - step);
    await editor.evaluate(() => new Promise(requestAnimationFrame));
  }
  const seconds = (Date.now() - began) / 1000;
  const busy = (await scripts()) - before;
  await editor.mouse.up();
  const durations = await editor.evaluate(() => performance.getEntriesByName("neuralmls-drag-frame").map(({ duration }) => duration));
  expect(durations.length).toBeGreaterThan(steps / 3);
  const what = `JavaScript of a drag frame, ${(rows * rows).toLocaleString("en")} vertices, 12 points`;
  figures.push({ what, value: median(durations) / 1000, unit: "s", bar: 0.002 });
  figures.push({ what: "  the whole frame, drawn by the processor", value: seconds / steps, unit: "s", bar: null });
  notes.push(
    "JavaScript of a drag frame: all handlers of the pointer's events and the frame, until all is handed to the graphics card, in wall time " +
      "beside a graphics card in software",
    `all scripts of the page, with the panels, which follow a drag ten times a second: ${((100 * busy) / seconds).toFixed(1)} % of a processor`,
  );
});

test("the shader against the core, the saved file against the command line", async ({ editor, browser }, info) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const saved = await save(editor, /^Bent OBJ/);
  const points = await save(editor, /^Control points/);
  writeFileSync(info.outputPath("session.json"), points.bytes);
  command("deform", join(samples, "chair.obj"), "--points", info.outputPath("session.json"), "-o", info.outputPath("bent.obj"), "-q");
  const right = vertices(readFileSync(info.outputPath("bent.obj"), "utf8"));
  answers.push({ what: "the editor's file against neuralmls deform", error: difference(right, vertices(saved.bytes.toString())), tolerance: 1e-5 });
  const page = await browser.newPage();
  for (const given of quick ? [sample("table")] : [...["chair", "airplane", "car", "table"].map(sample), published()]) {
    if (!given) continue;
    const compared = await compare(page, given, { kind: "neural", width: 1024, seed: 0, steps: null });
    for (const transform of ["rigid", "similarity", "affine"]) {
      const worst = Math.max(...compared.filter((one) => one.transform === transform).map((one) => one.worst));
      answers.push({ what: `the shader against the core, ${given.name}, ${transform}`, error: worst, tolerance: 1e-4 });
    }
  }
  await page.close();
});

/** A field of bumps of rows x rows vertices. */
function bumps(rows: number): string {
  const lines: string[] = [];
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < rows; j++) {
      const [x, z] = [i / (rows - 1) - 0.5, j / (rows - 1) - 0.5];
      lines.push(`v ${x.toFixed(6)} ${(0.1 * Math.sin(9 * x) * Math.cos(7 * z)).toFixed(6)} ${z.toFixed(6)}`);
    }
  }
  for (let i = 0; i + 1 < rows; i++) {
    for (let j = 0; j + 1 < rows; j++) {
      const a = i * rows + j + 1;
      lines.push(`f ${a} ${a + 1} ${a + rows + 1} ${a + rows}`);
    }
  }
  return lines.join("\n");
}
