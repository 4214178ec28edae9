/** Which of some files is the shape, and giving files to the person. */

import type { Files } from "../worker/protocol.ts";

const SHAPES = ["glb", "gltf", "obj", "ply", "off", "stl", "npy", "xyz", "txt", "csv"];
export const ACCEPTED = [...SHAPES, "json", "mtl", "bin", "png", "jpg", "jpeg", "webp"].map((e) => `.${e}`).join(",");

export const extensionOf = (name: string): string => (/\.([^./\\]+)$/.exec(name)?.[1] ?? "").toLowerCase();
export const stemOf = (name: string): string => name.replace(/\.[^./\\]+$/, "");

export async function readAll(files: readonly File[]): Promise<Map<string, Uint8Array>> {
  const read = await Promise.all(
    files.map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())] as const),
  );
  return new Map(read);
}

/** The name of the shape among the files, and that of the control points. */
export function sort(files: Files): { shape: string | undefined; points: string | undefined } {
  const names = [...files.keys()];
  const points = names.find((name) => isPoints(name, files.get(name)));
  const shape = SHAPES.map((extension) =>
    names.find((name) => name !== points && extensionOf(name) === extension),
  ).find((name) => name !== undefined);
  return { shape, points };
}

/** JSON that is not glTF, or CSV with names. */
function isPoints(name: string, bytes: Uint8Array | undefined): boolean {
  const extension = extensionOf(name);
  if (extension === "json") return true;
  if (extension !== "csv" || !bytes) return false;
  const head = new TextDecoder().decode(bytes.subarray(0, 1000)).split("\n")[0];
  return head.split(",").some((title) => title.trim().toLowerCase() === "name");
}

/** Puts a file among the person's downloads. */
export function download(name: string, data: Blob): void {
  const url = URL.createObjectURL(data);
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
