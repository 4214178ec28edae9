/** Shapes with control points that are moved, and how far the shader's frame of them is from the core's. */

import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "@playwright/test";
import type { Orientation } from "../../src/model/orientation.ts";
import { data, pages, samples } from "./tools.ts";

export interface Compared {
  transform: string;
  temperature: number;
  handles: "soft" | "auto";
  /** The largest distance of the two, and the largest from the shape at rest, as fractions of the box. */
  worst: number;
  moved: number;
  /** The largest angle between the shader's normals and those that the core's maps give, in degrees. */
  leaning: number;
}

declare global {
  interface Window {
    compare(name: string, base64: string, p: number[], q: number[], oriented: (Orientation | undefined)[], weights: object, motions: object[]): Promise<Compared[]>;
  }
}

const motions = ["rigid", "similarity", "affine"].flatMap((transform) =>
  [0.3, 1, 3].flatMap((temperature) => ["soft", "auto"].map((handles) => ({ transform, temperature, handles }))),
);

export interface Case {
  name: string;
  file: Buffer;
  p: number[][];
  q: number[][];
}

export function sample(name: string): Case {
  const { control_points } = JSON.parse(readFileSync(join(samples, `${name}.points.json`), "utf8"));
  const p: number[][] = control_points.map((point: { position: number[] }) => point.position);
  const size = Math.max(...p.flat().map(Math.abs)); // samples have the sizes of the real things
  const q = p.map((x, i) => x.map((c, k) => c + 0.15 * size * Math.sin(1 + 2 * i + 3 * k)));
  return { name, file: readFileSync(join(samples, `${name}.obj`)), p, q };
}

/** A published case on a shape of ShapeNet: coordinates relative to its box. */
export function published(): Case | null {
  const folder = data && join(data, "shapenet");
  if (!folder || !existsSync(join(folder, "ShapeNetChair1/model.obj"))) return null;
  const file = readFileSync(join(folder, "ShapeNetChair1/model.obj"));
  const given = JSON.parse(readFileSync(join(folder, "control_points.json"), "utf8")).ShapeNetChair1;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const line of file.toString().split("\n")) {
    if (!line.startsWith("v ")) continue;
    line.split(/\s+/).slice(1, 4).forEach((text, k) => {
      low[k] = Math.min(low[k], Number(text));
      high[k] = Math.max(high[k], Number(text));
    });
  }
  const half = Math.max(...low.map((l, k) => high[k] - l)) / 2;
  const p: number[][] = given.control_points.map((x: number[]) => x.map((c, k) => c * half + (low[k] + high[k]) / 2));
  const q = p.map((x, i) => x.map((c, k) => c + half * given.offsets.user_study_1[i][k]));
  return { name: "ShapeNetChair1", file, p, q };
}

/** By every map at each of three temperatures, soft and exact, with the weights of one fit. */
export async function compare(page: Page, { file, p, q }: Case, weights: object, oriented: (Orientation | undefined)[] = []): Promise<Compared[]> {
  await page.goto(`${pages}/shader.html`);
  await page.waitForFunction(() => window.compare);
  return page.evaluate(
    ([base64, p, q, oriented, weights, motions]) => window.compare("shape.obj", base64, p, q, oriented, weights, motions),
    [file.toString("base64"), p.flat(), q.flat(), oriented, weights, motions] as const,
  );
}
