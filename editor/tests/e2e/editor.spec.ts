/** What a person does with the editor, with a real mouse and real keys, and what comes of it. */

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { choose, clickAt, drop, expect, fitted, opened, openSample, save, screenOf, serve, session, test } from "./fixtures.ts";
import { difference, neuralmls as command, picture, samples, vertices } from "./tools.ts";

const chair = readFileSync(join(samples, "chair.obj"), "utf8");
const control_points: { name: string; position: number[] }[] = JSON.parse(
  readFileSync(join(samples, "chair.points.json"), "utf8"),
).control_points;

test("drop, click, drag, undo, redo, mirror, temperature, save: the file is that of the command line", async ({ editor }, info) => {
  await editor.screenshot({ path: picture("empty.png") });
  await drop(editor, join(samples, "chair.obj"), join(samples, "chair.mtl"));
  await opened(editor, "chair.obj");

  // Five points by clicking on the chair.
  for (const [i, { position }] of spread(control_points.map((point) => point.position), 5).entries()) {
    await clickAt(editor, position);
    await expect(editor.getByRole("list", { name: "Control points" }).getByRole("button")).toHaveCount(i + 1);
  }
  await fitted(editor);
  const placed = await session(editor);
  expect(placed.points.every(({ position, target }) => position.every((c, k) => c === target[k]))).toBe(true);
  await editor.screenshot({ path: picture("points.png") });

  // One of them by the gizmo's vertical axis.
  const last = placed.points.at(-1)!;
  const at = await screenOf(editor, last.target);
  const above = await screenOf(editor, last.target.map((c, k) => (k === 1 ? c + 0.1 : c)));
  const length = Math.hypot(above.x - at.x, above.y - at.y);
  const along = [(above.x - at.x) / length, (above.y - at.y) / length];
  const grip = { x: at.x + 55 * along[0], y: at.y + 55 * along[1] };
  await editor.mouse.move(grip.x, grip.y, { steps: 4 });
  await editor.mouse.down();
  for (let step = 1; step <= 8; step++) {
    await editor.mouse.move(grip.x + 10 * step * along[0], grip.y + 10 * step * along[1]);
    if (step === 6) await editor.screenshot({ path: picture("drag.png") });
  }
  await editor.mouse.up();
  const dragged = (await session(editor)).points.at(-1)!;
  expect(dragged.target[1] - last.target[1]).toBeGreaterThan(0.03);
  expect(dragged.target[0]).toBeCloseTo(last.target[0], 9);
  expect(dragged.target[2]).toBeCloseTo(last.target[2], 9);
  expect(dragged.position).toEqual(last.position);

  // The whole drag is one step of undo.
  await editor.keyboard.press("Control+z");
  expect((await session(editor)).points.at(-1)).toEqual(last);
  await editor.keyboard.press("Control+Shift+z");
  expect((await session(editor)).points.at(-1)).toEqual(dragged);

  await editor.locator("label", { hasText: /^X$/ }).click();
  await expect.poll(async () => (await session(editor)).settings.mirror).toBe("x");
  await editor.getByRole("textbox", { name: "Temperature" }).fill("0.6");
  await editor.keyboard.press("Enter");
  expect((await session(editor)).settings.temperature).toBe(0.6);
  await fitted(editor);

  // What the editor saves, the command line makes of the saved session; and the screen shows it.
  const saved = await save(editor, /^Bent OBJ/);
  const points = await save(editor, /^Control points/);
  // The session says in which box its weights were fitted.
  const places = vertices(chair);
  const corner = (pick: (...values: number[]) => number) => [0, 1, 2].map((k) => places.filter((_, at) => at % 3 === k).reduce((a, b) => pick(a, b)));
  expect(JSON.parse(points.bytes.toString()).frame).toEqual({ min: corner(Math.min), max: corner(Math.max) });
  writeFileSync(info.outputPath("session.json"), points.bytes);
  const bent = info.outputPath("bent.obj");
  command("deform", join(samples, "chair.obj"), "--points", info.outputPath("session.json"), "-o", bent, "-q");
  const expected = readFileSync(bent, "utf8");
  const right = vertices(expected);
  expect(difference(right, vertices(chair))).toBeGreaterThan(0.01);
  expect(difference(right, vertices(saved.bytes.toString()))).toBeLessThan(1e-6);
  const shown = await editor.evaluate(() => [...neuralmls.readback()!]);
  expect(difference(right, shown)).toBeLessThan(1e-4);
  const others = (text: string) => text.split("\n").filter((line) => !/^vn? /.test(line));
  expect(others(saved.bytes.toString()).join("\n") === others(expected).join("\n")).toBe(true);
});

test("a mirrored move moves the twin too", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  await editor.locator("label", { hasText: /^X$/ }).click();
  const before = await session(editor);
  expect(before.pairs.length).toBeGreaterThan(0);
  const [a, b] = before.pairs[0];
  const of = (points: typeof before.points, id: number) => points.find((point) => point.id === id)!;
  await choose(editor, of(before.points, a).name);
  const field = editor.getByRole("textbox", { name: "Target x" });
  await field.fill(String(of(before.points, a).target[0] + 0.05));
  await field.press("Enter");
  const after = await session(editor);
  expect(of(after.points, b).target[0]).toBeCloseTo(of(before.points, b).target[0] - 0.05, 6);
});

test("the gizmo rotates a control point, its twin mirrored: the file is that of the command line", async ({ editor }, info) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  await editor.locator("label", { hasText: /^X$/ }).click();
  const before = await session(editor);
  const of = ({ points }: typeof before, name: string) => points.find((point) => point.name === name)!;
  await choose(editor, "armrest-left");
  await editor.keyboard.press("e");
  // The gizmo's outermost ring turns about the line of sight: three quarters of its unit from its middle.
  const at = await screenOf(editor, of(before, "armrest-left").target);
  const { height } = (await editor.locator(".pane").boundingBox())!;
  const radius = (0.75 * (1.9 * 0.78 * height)) / 8;
  const grip = (degrees: number): [number, number] => {
    const angle = (degrees * Math.PI) / 180;
    return [at.x + radius * Math.cos(angle), at.y - radius * Math.sin(angle)];
  };
  await editor.mouse.move(...grip(60), { steps: 4 });
  await editor.mouse.down();
  for (let degrees = 60; degrees <= 110; degrees += 5) await editor.mouse.move(...grip(degrees));
  await editor.waitForTimeout(300); // the frame after
  await editor.screenshot({ path: picture("oriented.png") });
  await editor.mouse.up();
  const after = await session(editor);
  const oriented = of(after, "armrest-left");
  const { orientation } = oriented;
  expect(orientation!.degrees).toBeCloseTo(50, 0);
  expect(oriented).toEqual({ ...of(before, "armrest-left"), orientation });
  await expect(editor.getByText(`Rotated by ${orientation!.degrees.toFixed(1)}°`)).toBeVisible();
  const twin = of(after, "armrest-right").orientation!;
  expect(twin.degrees).toBe(orientation!.degrees);
  twin.axis.forEach((c, k) => expect(c).toBeCloseTo(k === 0 ? orientation!.axis[k]! : -orientation!.axis[k]!, 12));

  // The whole drag is one step of undo.
  await editor.keyboard.press("Control+z");
  expect((await session(editor)).points).toEqual(before.points);
  await editor.keyboard.press("Control+Shift+z");
  expect((await session(editor)).points).toEqual(after.points);

  const saved = await save(editor, /^Bent OBJ/);
  const points = await save(editor, /^Control points/);
  writeFileSync(info.outputPath("session.json"), points.bytes);
  const bent = info.outputPath("bent.obj");
  command("deform", join(samples, "chair.obj"), "--points", info.outputPath("session.json"), "-o", bent, "-q");
  const right = vertices(readFileSync(bent, "utf8"));
  const document = JSON.parse(points.bytes.toString());
  const unoriented = document.control_points.map(({ rotation: _, ...entry }: { rotation?: object }) => entry);
  writeFileSync(info.outputPath("plain.json"), JSON.stringify({ ...document, control_points: unoriented }));
  const plain = info.outputPath("plain.obj");
  command("deform", join(samples, "chair.obj"), "--points", info.outputPath("plain.json"), "-o", plain, "-q");
  expect(difference(right, vertices(readFileSync(plain, "utf8")))).toBeGreaterThan(0.01);
  expect(difference(right, vertices(saved.bytes.toString()))).toBeLessThan(1e-6);
  const shown = await editor.evaluate(() => [...neuralmls.readback()!]);
  expect(difference(right, shown)).toBeLessThan(1e-4);
});

test("Escape takes a drag back, and a free drag of a point follows the mouse", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const before = await session(editor);
  const top = before.points.findIndex((point) => point.name === "back-top-left");
  const at = await screenOf(editor, before.points[top].target);
  await editor.mouse.move(at.x, at.y);
  await editor.mouse.down();
  await editor.mouse.move(at.x + 40, at.y - 30, { steps: 5 });
  await editor.keyboard.press("Escape");
  await editor.mouse.up();
  expect((await session(editor)).points).toEqual(before.points);
  await editor.mouse.move(at.x, at.y);
  await editor.mouse.down();
  await editor.mouse.move(at.x + 40, at.y - 30, { steps: 5 });
  await editor.mouse.up();
  const moved = (await session(editor)).points[top];
  const now = await screenOf(editor, moved.target);
  expect(Math.hypot(now.x - at.x - 40, now.y - at.y + 30)).toBeLessThan(2);
});

test("heat map, comparison and dark are shown", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const { points } = await session(editor);
  await choose(editor, points[0].name);
  await editor.locator("label", { hasText: /^Weight$/ }).click();
  await expect(editor.getByText(`weight of ${points[0].name}`)).toBeVisible();
  await editor.waitForTimeout(300); // the frame after
  await editor.screenshot({ path: picture("heat.png") });
  await editor.locator("label", { hasText: /^Material$/ }).click();
  const field = editor.getByRole("textbox", { name: "Target y" });
  await field.fill(String(points[0].target[1] + 0.25));
  await field.press("Enter");
  await editor.getByRole("button", { name: "Compare" }).click();
  await expect.poll(() => editor.evaluate(() => neuralmls.state().comparisonFit.status), { timeout: 60_000 }).toBe("ready");
  await editor.waitForTimeout(300);
  await editor.screenshot({ path: picture("comparison.png") });
  await editor.getByRole("button", { name: "Compare" }).click();
  await editor.getByRole("button", { name: /^Theme/ }).click();
  await expect(editor.locator("html")).toHaveAttribute("data-theme", "dark");
  await editor.waitForTimeout(300);
  await editor.screenshot({ path: picture("dark.png") });
});

test("hostile files are one sentence each, and leave the open shape", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const before = await editor.evaluate(() => [...neuralmls.readback()!]);
  const hostile: [string, string, RegExp][] = [
    ["broken.obj", "v 0 0 0\nv 1 0\n", /broken\.obj: line 2/],
    ["faces.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", /faces\.obj: line 4/],
    ["nan.obj", "v nan 0 0\n", /nan\.obj: line 1/],
    ["empty.stl", "", /empty\.stl: .*empty/],
    ["huge.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty float x\nproperty float y\nproperty float z\nend_header\n", /huge\.ply: /],
    ["bad.glb", "glTF\x02\0\0\0\xff\xff\xff\xff", /bad\.glb: /],
    ["picture.png", "\x89PNG\r\n", /picture\.png: expected a shape/],
    ["points.json", '{"format": "something else"}', /points\.json: .*format/],
    ["deep.json", "[".repeat(100_000), /deep\.json: /],
    ["<img src=x onerror=alert(1)>.obj", "v 1\n", /<img src=x onerror=alert\(1\)>\.obj: line 1/],
  ];
  for (const [name, text, says] of hostile) {
    await drop(editor, { name, bytes: Buffer.from(text, "latin1") });
    const toast = editor.getByRole("alert").filter({ hasText: says });
    await expect(toast, name).toBeVisible();
    expect((await toast.innerText()).split("\n").length, name).toBeLessThanOrEqual(2);
    await toast.getByRole("button", { name: "Dismiss" }).click();
    await expect(editor.locator(".file-name strong")).toHaveText("chair.obj");
  }
  expect(await editor.evaluate(() => [...neuralmls.readback()!])).toEqual(before);
});

test("control points of any kind open, and what is wrong with them is said as the command line says it", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const before = await session(editor);
  const [a, b] = control_points.slice(0, 2).map(({ position }) => position);
  const text = (document: object) => Buffer.from(JSON.stringify({ format: "neuralmls-control-points", version: 2, control_points: [{ name: "a", position: a }], ...document }));
  const refused: [string, Buffer, RegExp][] = [
    ["cold.json", text({ settings: { temperature: -1 } }), /cold\.json: .*temperature/],
    ["half.csv", Buffer.from("name,x,y,z,target_y\na,0,0,0,1\n"), /half\.csv: /],
    ["flat.csv", Buffer.from("name,x,y\na,0,0\n"), /flat\.csv: /],
  ];
  for (const [name, bytes, says] of refused) {
    await drop(editor, { name, bytes });
    const toast = editor.getByRole("alert").filter({ hasText: says });
    await expect(toast, name).toBeVisible();
    await toast.getByRole("button", { name: "Dismiss" }).click();
    expect(await session(editor)).toEqual(before);
  }
  // Landmarks of another tool in two files: where they are, and where they go. One has no partner.
  const fcsv = (...rows: [string, number[]][]) =>
    Buffer.from(["# Markups fiducial file version = 4.11", "# CoordinateSystem = LPS", "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID", ...rows.map(([label, at], i) => `${i},${at.join()},0,0,0,1,1,1,0,${label},,`), ""].join("\n"));
  const up = [a[0], a[1] + 0.1, a[2]];
  await drop(editor, { name: "dst.fcsv", bytes: fcsv(["two", b], ["one", up]) }, { name: "src.fcsv", bytes: fcsv(["one", a], ["two", b], ["three", [0, 0.5, 0]]) });
  await expect(editor.getByText("src.fcsv says where control points are at rest, dst.fcsv where they go")).toBeVisible();
  await expect(editor.getByText(/src\.fcsv and dst\.fcsv: .*three/)).toBeVisible();
  await editor.screenshot({ path: picture("landmarks.png") });
  await fitted(editor);
  const joined = (await session(editor)).points;
  expect(joined.find(({ name }) => name === "one")).toMatchObject({ position: a, target: up });
  expect(joined.find(({ name }) => name === "two")).toMatchObject({ position: b, target: b });
  // Weights that know the shape are fitted like others, and keys of others kept.
  await drop(editor, { name: "shape.json", bytes: text({ settings: { weights: { kind: "shape-aware" } }, mine: [1, 2] }) });
  await fitted(editor);
  await editor.screenshot({ path: picture("shape-aware.png") });
  const saved = JSON.parse((await save(editor, /^Control points/)).bytes.toString());
  expect(saved).toMatchObject({ version: 2, settings: { weights: { kind: "shape-aware" } }, mine: [1, 2] });
  await editor.locator("label", { hasText: /^Neural$/ }).click();
  await fitted(editor);
});

test("the keyboard alone opens, places, chooses, moves, takes back and saves", async ({ editor }) => {
  const press = (key: string) => editor.keyboard.press(key);
  const focused = () => editor.evaluate(() => document.activeElement?.getAttribute("aria-label") ?? document.activeElement?.textContent ?? "");
  const tabTo = async (words: RegExp) => {
    for (let i = 0; i < 80; i++) {
      if (words.test(await focused())) {
        const outlined = await editor.evaluate(() => {
          const { outlineStyle, boxShadow } = getComputedStyle(document.activeElement!);
          return outlineStyle !== "none" || boxShadow !== "none";
        });
        expect(outlined, `the focus is seen on ${words}`).toBe(true);
        return;
      }
      await press("Tab");
    }
    throw new Error(`Tab does not come to ${words}`);
  };
  await tabTo(/^Samples/);
  await press("Enter");
  await expect(editor.getByRole("menuitem", { name: "Chair" })).toBeFocused();
  await press("ArrowDown");
  await press("Enter");
  await opened(editor, "airplane.obj");
  await fitted(editor);
  // What is moved already stays beside those that are placed.
  const moved = (await session(editor)).points.filter(({ position, target }) => position.some((c, k) => c !== target[k]));
  await tabTo(/^Place 12/);
  await press("Enter");
  await expect.poll(async () => (await session(editor)).points.length).toBe(12 + moved.length);
  await fitted(editor);
  await editor.evaluate(() => (document.activeElement as HTMLElement).blur());
  await press("n");
  const before = await session(editor);
  expect(before.selection).toHaveLength(1);
  await press("ArrowUp");
  await press("ArrowUp");
  const chosen = (points: typeof before.points) => points.find((point) => point.id === before.selection[0])!;
  const after = await session(editor);
  expect(chosen(after.points).target).not.toEqual(chosen(before.points).target);
  await press("Control+z");
  await press("Control+z");
  expect((await session(editor)).points).toEqual(before.points);
  await press("Shift+?");
  await expect(editor.getByRole("dialog")).toBeVisible();
  await press("Escape");
  await expect(editor.getByRole("dialog")).toBeHidden();
  const [download] = await Promise.all([editor.waitForEvent("download"), press("Control+s")]);
  expect(download.suggestedFilename()).toMatch(/^airplane.*\.obj$/);
});

test("keys are off while one types", async ({ editor }) => {
  await openSample(editor, "Chair");
  await fitted(editor);
  const { points } = await session(editor);
  await choose(editor, points[0].name);
  await editor.getByRole("textbox", { name: "Name" }).fill("");
  await editor.keyboard.type("lqnaw0");
  await editor.keyboard.press("Backspace");
  await editor.keyboard.press("Enter");
  const after = await session(editor);
  expect(after.points[0].name).toBe("lqnaw");
  expect(after.points.length).toBe(points.length);
  expect(after.points[0].locked).toBe(false);
});

test("the page can send nothing anywhere, nor run text as a program", async ({ editor, notes }) => {
  const violated = await editor.evaluate(async () => {
    const violated: string[] = [];
    document.addEventListener("securitypolicyviolation", (event) => violated.push(event.effectiveDirective));
    await fetch("https://example.org/").catch(() => undefined);
    new Image().src = "https://example.org/x.png";
    const script = document.createElement("script");
    script.textContent = "document.title = 'run'";
    document.body.append(script);
    await new Promise((resolve) => setTimeout(resolve, 200));
    return [...new Set(violated), document.title].sort();
  });
  expect(violated).toEqual(["NeuralMLS editor", "connect-src", "img-src", "script-src-elem"]);
  const foreign = notes.requests.filter((url) => url.includes("example.org"));
  expect(foreign.map((url) => notes.refused.get(url))).toEqual(foreign.map(() => "csp"));
  // The browser tells of each of them.
  notes.errors.length = 0;
  notes.requests.length = 0;
});

test("neuralmls edit opens its shape with its control points", async ({ page }) => {
  const server = await serve(join(samples, "car.obj"), "--points", join(samples, "car.points.json"));
  await page.goto(server.url);
  await opened(page, "car.obj");
  await fitted(page);
  const { points } = await session(page);
  const given = JSON.parse(readFileSync(join(samples, "car.points.json"), "utf8")).control_points;
  expect(points.map(({ name }) => name)).toEqual(given.map(({ name }: { name: string }) => name));
  expect(await server.stop()).toBe(0);
});

/** The first of these, and then always the one farthest from those that were taken. */
function spread(places: number[][], count: number): { position: number[] }[] {
  const taken = [places[0]];
  const away = (a: number[], b: number[]) => Math.hypot(...a.map((c, k) => c - b[k]));
  while (taken.length < count) {
    const nearest = (place: number[]) => Math.min(...taken.map((other) => away(place, other)));
    taken.push(places.reduce((best, place) => (nearest(place) > nearest(best) ? place : best)));
  }
  return taken.map((position) => ({ position }));
}
