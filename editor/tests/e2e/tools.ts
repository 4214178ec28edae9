/** What several tests need: the command line, OBJ files, and the folder that pictures go to. */

import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

export const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
export const samples = join(root, "editor/public/samples");
export const program = process.env.NEURALMLS ?? join(root, ".venv/bin/neuralmls");

/** Where the pages of single parts are served. */
export const pages = `http://localhost:${process.env.NEURALMLS_PAGES_PORT}/tests/e2e/pages`;

/** Real files for tests, where they are. */
const real = process.env.NEURALMLS_DATA ?? resolve(root, "../shared/data");
export const data = existsSync(real) ? real : null;

/** Runs the command line. */
export function neuralmls(...options: string[]): string {
  return execFileSync(program, options, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

/** The coordinates of the vertices of an OBJ file. */
export function vertices(text: string): number[] {
  return text
    .split("\n")
    .filter((line) => line.startsWith("v "))
    .flatMap((line) => line.split(/\s+/).slice(1, 4).map(Number));
}

/** The largest difference of two lists of coordinates, as a fraction of the longest side of the first one's box. */
export function difference(a: ArrayLike<number>, b: ArrayLike<number>): number {
  if (a.length !== b.length || a.length === 0) throw new Error(`${a.length} and ${b.length} coordinates`);
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  let largest = 0;
  for (let i = 0; i < a.length; i++) {
    low[i % 3] = Math.min(low[i % 3]!, a[i]!);
    high[i % 3] = Math.max(high[i % 3]!, a[i]!);
    const distance = Math.abs(a[i]! - b[i]!);
    if (!(distance <= largest)) largest = distance; // NaN too
  }
  return largest / Math.max(...low.map((value, k) => high[k]! - value));
}

/** A file in out/editor, the folder of pictures. */
export function picture(name: string): string {
  const folder = join(root, "out/editor");
  mkdirSync(folder, { recursive: true });
  return join(folder, name);
}
