import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, relative, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { describe, expect, it } from "vitest";

const source = resolve(dirname(fileURLToPath(import.meta.url)), "../../src");

/** What each folder may import, of the others and of packages. */
const LAYERS: Record<string, { folders: string[]; packages: string[] }> = {
  model: { folders: [], packages: [] },
  commands: { folders: ["model"], packages: [] },
  worker: { folders: ["model", "wasm"], packages: [] },
  storage: { folders: ["model"], packages: ["idb"] },
  shader: { folders: ["model"], packages: [] },
  viewport: { folders: ["model", "commands", "shader"], packages: ["three", "three-mesh-bvh"] },
  exports: { folders: ["model", "commands", "viewport"], packages: ["three"] },
  app: { folders: ["model", "commands", "worker", "storage"], packages: [] },
  panels: { folders: ["model", "commands", "app"], packages: ["preact"] },
};
/** What joins the layers may import all of them. */
const ROOTS = ["main.ts", "offline/main.ts"];

const files = readdirSync(source, { recursive: true, encoding: "utf8" })
  .map((name) => name.replaceAll("\\", "/"))
  .filter((name) => /\.tsx?$/.test(name) && !name.endsWith(".d.ts") && !name.startsWith("wasm/"));

/** What a file imports. */
function importsOf(name: string): string[] {
  const text = readFileSync(join(source, name), "utf8");
  return [...text.matchAll(/(?:from|import)\s*\(?\s*"([^"]+)"/g)].map((match) => match[1]);
}

/** The file that a relative import means. */
const target = (name: string, path: string): string =>
  relative(source, resolve(dirname(join(source, name)), path)).replaceAll("\\", "/");

describe("imports run downward only", () => {
  it("every file belongs to a layer", () => {
    const strangers = files.filter((name) => !ROOTS.includes(name) && !(name.split("/")[0] in LAYERS));
    expect(strangers).toEqual([]);
    expect(files.length).toBeGreaterThan(30);
  });

  it("no file imports itself by way of others, not even a type", () => {
    const imports = new Map(files.map((name) => [name, importsOf(name).filter((path) => path.startsWith(".")).map((path) => target(name, path))]));
    const circles: string[] = [];
    const done = new Set<string>();
    const visit = (name: string, path: string[]): void => {
      if (path.includes(name)) return void circles.push([...path.slice(path.indexOf(name)), name].join(" -> "));
      if (done.has(name)) return;
      for (const next of imports.get(name) ?? []) visit(next, [...path, name]);
      done.add(name);
    };
    for (const name of files) visit(name, []);
    expect(circles).toEqual([]);
    expect([...imports.values()].flat().length).toBeGreaterThan(100);
  });

  it.each(files.filter((name) => !ROOTS.includes(name)))("%s", (name) => {
    const folder = name.split("/")[0];
    const { folders, packages } = LAYERS[folder];
    for (const path of importsOf(name)) {
      if (path.startsWith(".")) {
        const to = target(name, path).split("/")[0];
        expect([folder, ...folders], `${name} imports ${path}`).toContain(to);
      } else {
        expect(packages, `${name} imports ${path}`).toContain(path.split("/")[0]);
      }
    }
  });

  it("the model and the commands know no page", () => {
    for (const name of files.filter((name) => /^(model|commands)\//.test(name))) {
      const text = readFileSync(join(source, name), "utf8");
      expect(text, name).not.toMatch(/\b(document\.(body|create|get|query)|window\.|localStorage|indexedDB|navigator\.)/);
    }
  });
});
