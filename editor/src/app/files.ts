/** Which of some files is the shape, and giving files to the person. */

import type { Files } from "../worker/protocol.ts";

const SHAPES = ["glb", "gltf", "obj", "ply", "off", "stl", "npy", "xyz", "asc", "pts", "txt", "csv"];
/** Endings of files of control points, ours and those of other tools. */
const POINTS = ["json", "fcsv", "pp", "tps", "tag", "land"];
/** Endings of tables, which may be either. */
const TABLES = ["csv", "tsv", "txt", "pts"];
export const ACCEPTED = [...new Set([...SHAPES, ...POINTS, ...TABLES]), "mtl", "bin", "png", "jpg", "jpeg", "webp"].map((e) => `.${e}`).join(",");

export const extensionOf = (name: string): string => (/\.([^./\\]+)$/.exec(name)?.[1] ?? "").toLowerCase();
export const stemOf = (name: string): string => name.replace(/\.[^./\\]+$/, "");

export async function readAll(files: readonly File[]): Promise<Map<string, Uint8Array>> {
  const read = await Promise.all(
    files.map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())] as const),
  );
  return new Map(read);
}

/** The name of the shape among the files, and those of the control points: where they are at rest, then where they go, if there are two. */
export function sort(files: Files): { shape: string | undefined; points: string[] } {
  const names = [...files.keys()];
  const has = (name: string, endings: readonly string[]): boolean => endings.includes(extensionOf(name));
  const named = names.filter((name) => has(name, POINTS) || (has(name, TABLES) && holdsNames(files.get(name) as Uint8Array)));
  const shape = SHAPES.map((extension) =>
    names.find((name) => !named.includes(name) && extensionOf(name) === extension),
  ).find((name) => name !== undefined);
  // Beside a shape, a table without names belongs to it.
  const points = names.filter((name) => named.includes(name) || (name !== shape && has(name, TABLES)));
  return { shape, points: points.sort((a, b) => Number(isTarget(a)) - Number(isTarget(b))) };
}

/** Whether there are words below the first line, or a title for them in it, as in no table of a shape. */
function holdsNames(bytes: Uint8Array): boolean {
  const text = new TextDecoder().decode(bytes.subarray(0, 4000));
  const [titles, ...rows] = text.split(/[\r\n]+/).filter((line) => line.trim() !== "" && !/^\s*(#|\/\/)/.test(line));
  return /\b(name|label|landmark)\b/i.test(titles ?? "") || rows.some((row) => /[a-z]/i.test(row.replace(/\b(nan|inf)\b|\de/gi, "")));
}

/** Whether a file is called after where its control points go. */
const isTarget = (name: string): boolean => /(^|[^a-z])(dst|dest|destination|targets?|to|moved|fixed|after)([^a-z]|$)/i.test(stemOf(name));

/** Puts a file among the person's downloads. */
export function download(name: string, data: Blob): void {
  const url = URL.createObjectURL(data);
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
