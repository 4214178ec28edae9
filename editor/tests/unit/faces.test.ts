/** One session, one result: what the core of the browser saves is what `neuralmls deform` writes. tests/test_faces.py reads the same sessions. */

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { afterAll, expect, test } from "vitest";
import { Points, Session, ShapeFile } from "../../src/wasm/neuralmls_wasm.js";
import { difference, neuralmls, root, samples, vertices } from "../e2e/tools.ts";
import "./core.ts";

interface Face {
  name: string;
  settings: { weights?: { kind?: string } };
  frame?: object;
  moved: Record<string, object>;
}

const faces = JSON.parse(readFileSync(join(root, "tests/faces.json"), "utf8")) as { control_points: { name: string }[]; sessions: Face[] };
const chair = join(samples, "chair.obj");
const folder = mkdtempSync(join(tmpdir(), "faces-"));
afterAll(() => rmSync(folder, { recursive: true }));

const kindOf = ({ settings }: Face): string => settings.weights?.kind ?? "neural";

/** Of the box. */
const AGREE = 1e-6;
const silent = (): void => undefined;

test.each(faces.sessions)("$name", { timeout: 60_000 }, ({ settings, frame, moved }) => {
  const control_points = faces.control_points.map((point) => ({ ...point, ...moved[point.name] }));
  const text = JSON.stringify({ format: "neuralmls-control-points", version: 2, control_points, settings, ...(frame && { frame }) });
  const [file, told] = [join(folder, "session.json"), join(folder, "told.obj")];
  writeFileSync(file, text);
  neuralmls("deform", chair, "--points", file, "-o", told, "-q", "--force");

  const shape = new ShapeFile(readFileSync(chair), "obj", () => null);
  const points = new Points(shape.positions() as Float64Array, shape.dim(), shape.triangles() ?? new Uint32Array());
  const bound = points.bind(points.train(Session.read(Buffer.from(text), "session.json"), silent), silent);
  const [y, maps] = bound.deform(shape.has_normals(), silent) as [Float64Array, Float64Array?];
  const [bytes] = shape.write(y, maps, "told") as [Uint8Array];

  const there = vertices(readFileSync(told, "utf8"));
  expect(difference(there, vertices(readFileSync(chair, "utf8")))).toBeGreaterThan(0.01);
  expect(difference(there, vertices(Buffer.from(bytes).toString()))).toBeLessThan(AGREE);
});

test("all weights are among them", () => {
  expect(new Set(faces.sessions.map(kindOf))).toEqual(new Set(["neural", "shape-aware", "inverse-distance"]));
  expect(faces.sessions).toHaveLength(23);
});
