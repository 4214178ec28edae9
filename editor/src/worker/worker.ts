/** A worker: the core compiled to WebAssembly, and what it holds for the main thread. */

import initialise, { type Bound, Points, ShapeFile } from "../wasm/neuralmls_wasm.js";
import { measure, relative, widen } from "./coordinates.ts";
import type { Answer, Ask, Give, Moved, Operation, Question } from "./messages.ts";
import { type Advice, CoreError, type Fitted, type Opened, type Report, type Saved, type SessionDocument, type Stage } from "./protocol.ts";
import { withSession } from "./sessions.ts";

/** Milliseconds between two messages of progress. */
const PROGRESS_EVERY = 30;

let file: ShapeFile | undefined;
let points: Points | undefined;
let fitted: Bound | undefined;

type Tell = (stage: Stage) => (fraction: number) => void;

const operations: { [O in Operation]: (ask: Ask<O>, tell: Tell) => Give<O> } = {
  open({ files, name }, tell) {
    tell("read")(0);
    const given = new Map(files);
    const found = (path: string) => given.get(path) ?? given.get(path.split("/").pop()!) ?? null;
    try {
      const ending = /\.([^./]*)$/.exec(name)?.[1] ?? "";
      file = new ShapeFile(given.get(name)!, ending, found);
      const x = file.positions() as Float64Array<ArrayBuffer>;
      return { opened: describe(file, name, x, found), x };
    } catch (error) {
      throw sentence(error, `${name}: `);
    }
  },

  load({ x, dim, triangles }) {
    points = new Points(x, dim, triangles ?? new Uint32Array(0));
    return null;
  },

  fit({ session }, tell) {
    fitted?.free();
    fitted = undefined;
    const core = present(points);
    const began = performance.now();
    const map = withSession(session, (session) => core.train(session, tell("train")));
    const [loss, steps] = [map.loss() ?? null, map.steps()];
    const trained = performance.now();
    fitted = core.bind(map, tell("evaluate")); // which takes it
    return {
      logits: fitted.logits() as Float32Array<ArrayBuffer>,
      ownLogits: fitted.own_logits() as Float32Array<ArrayBuffer>,
      loss,
      steps,
      milliseconds: { train: trained - began, evaluate: performance.now() - trained },
    } satisfies Fitted;
  },

  deform({ session, maps }, tell) {
    const [positions, local] = moved(session).deform(maps, tell("deform"));
    return { positions, maps: local ?? null } as Moved;
  },

  report({ session }) {
    return JSON.parse(moved(session).report()) as Report;
  },

  advise({ session }) {
    return JSON.parse(present(points).advise(moved(session))) as Advice[];
  },

  sessionText({ session }) {
    return moved(session).session();
  },

  write({ name, moved }, tell) {
    const shape = present(file);
    tell("write")(0);
    const endings = shape.extensions();
    const stem = name.replace(/\.[^.]*$/, "");
    if (!endings.includes(name.slice(stem.length + 1).toLowerCase())) {
      throw new CoreError(
        `${name}: expected the ending .${endings.join(", .")}: a file of the format ${shape.format()} stays one`,
      );
    }
    const [bytes, ...others] = shape.write(moved?.positions ?? shape.positions(), moved?.maps, stem);
    const files: Saved["files"] = [{ name, bytes }];
    for (let at = 0; at < others.length; at += 2) files.push({ name: others[at], bytes: others[at + 1] });
    return { files };
  },

  farthestPoints({ count, seed }) {
    const shape = present(file);
    return widen(shape.farthest_points(count, BigInt(seed)) as Float64Array<ArrayBuffer>, shape.dim());
  },
};

function describe(shape: ShapeFile, name: string, x: Float64Array<ArrayBuffer>, found: (path: string) => unknown): Opened {
  const dim = shape.dim() as 1 | 2 | 3;
  const wide = widen(x, dim);
  const { bounds, frame } = measure(wide);
  const facts = shape.facts();
  const namedFiles = [...new Set(shape.named_files())];
  const missing = namedFiles.filter((path) => !found(path));
  return {
    name,
    format: shape.format(),
    extensions: shape.extensions(),
    dim,
    count: x.length / dim,
    frame,
    positions: relative(wide, frame),
    triangles: (shape.triangles() as Uint32Array<ArrayBuffer> | undefined) ?? null,
    bounds,
    facts: facts.flatMap((fact, at) => (at % 2 ? [] : [[fact, facts[at + 1]!] as [string, string]])),
    hasNormals: shape.has_normals(),
    namedFiles,
    warnings: missing.length ? [`${name} names ${missing.join(", ")}, which you did not open along with it`] : [],
  };
}

/** What was fitted, with the targets and settings of a session. */
function moved(session: SessionDocument): Bound {
  const bound = present(fitted);
  withSession(session, (session) => bound.set_session(session));
  return bound;
}

function present<T>(value: T | undefined): T {
  if (value === undefined) throw new CoreError("there is nothing fitted yet: open a shape and add a control point");
  return value;
}

/** What was refused stays a sentence; anything else is a crash, and goes on as it is. */
function sentence(error: unknown, where = ""): unknown {
  const refused = error instanceof CoreError || (error instanceof Error && error.constructor === Error);
  return refused ? new CoreError(where + (error as Error).message) : error;
}

function answer({ id, operation, ask }: Question): void {
  const post = (message: Answer, transfer: Transferable[] = []) => self.postMessage(message, { transfer });
  let last = -Infinity;
  const tell: Tell = (stage) => (fraction) => {
    const now = performance.now();
    if (now - last < PROGRESS_EVERY) return;
    last = now;
    post({ id, kind: "progress", stage, fraction });
  };
  try {
    const give = (operations[operation] as (ask: unknown, tell: Tell) => Give<Operation>)(ask, tell);
    post({ id, kind: "done", give }, buffers(give));
  } catch (thrown) {
    const error = sentence(thrown);
    if (error instanceof CoreError) post({ id, kind: "refused", message: error.message });
    else post({ id, kind: "crashed", message: `the core stopped: there is probably not enough memory (${String(error)})` });
  }
}

/** The arrays in an answer, which are moved to the main thread and not copied. */
function buffers(value: unknown): Transferable[] {
  if (ArrayBuffer.isView(value)) return [value.buffer as ArrayBuffer];
  if (value === null || typeof value !== "object") return [];
  return [...new Set(Object.values(value).flatMap(buffers))];
}

self.addEventListener("message", ({ data: module }: MessageEvent<WebAssembly.Module>) => {
  const ready = initialise({ module_or_path: module });
  self.addEventListener("message", ({ data }: MessageEvent<Question>) => void ready.then(() => answer(data)));
}, { once: true });
