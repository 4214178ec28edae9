/** A worker: the core compiled to WebAssembly, and what it holds for the main thread. */

import initialise, { type Fit, Points, ShapeFile } from "../wasm/neuralmls_wasm.js";
import { measure, narrow, narrowMaps, relative, widen } from "./coordinates.ts";
import type { Answer, Ask, Give, Moved, Operation, Question } from "./messages.ts";
import { CoreError, type Fitted, type Motion, type Opened, type Saved, type Soft, type Stage } from "./protocol.ts";

/** A control point with less of the weight at its own place shares it; the training aims at 0.9. */
const OWNED = 0.85;
/** Milliseconds between two messages of progress. */
const PROGRESS_EVERY = 30;

let file: ShapeFile | undefined;
let points: { core: Points; dim: number } | undefined;
let fitted: Fit | undefined;

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

  load({ x, dim }) {
    points = { core: new Points(x, dim), dim };
    return null;
  },

  fit({ controlPoints, weights: spec }, tell) {
    const { core, dim } = present(points);
    fitted?.free();
    fitted = undefined;
    const p = narrow(controlPoints, dim);
    const began = performance.now();
    const weights =
      spec.kind === "neural"
        ? core.train(p, spec.width, BigInt(spec.seed), spec.steps ?? undefined, tell("train"))
        : core.classic(p, spec.alpha, spec.epsilon);
    const [loss, steps] = [weights.loss() ?? null, weights.steps()];
    const trained = performance.now();
    fitted = core.evaluate(weights, tell("evaluate")); // which takes them
    const evaluated = performance.now();
    const ownLogits = fitted.own_logits() as Float32Array<ArrayBuffer>;
    const untilSmall = spec.kind === "neural" && spec.steps === null;
    return {
      controlPoints: p.length / dim,
      logits: fitted.logits() as Float32Array<ArrayBuffer>,
      ownLogits,
      loss,
      steps,
      milliseconds: { train: spec.kind === "neural" ? trained - began : 0, evaluate: evaluated - trained },
      shared: untilSmall ? sharing(ownLogits, p.length / dim) : [],
    } satisfies Fitted;
  },

  deform({ motion, maps }, tell) {
    const { targets, turns, transform, temperature, adherence } = inDimension(motion);
    const aimed = present(fitted).aim(targets, turns, transform, temperature, adherence);
    const [positions, turned] = present(fitted).deform(aimed, turns, transform, temperature, maps, tell("deform"));
    return { positions, maps: turned ?? null } as Moved;
  },

  land({ motion }) {
    const { targets, turns, transform, temperature, adherence } = inDimension(motion);
    const [places, reason, index, amount, remedy] = present(fitted).land(targets, turns, transform, temperature, adherence);
    const soft: Soft | null = reason === undefined ? null : { reason, index, amount, remedy };
    return { places: widen(places, present(points).dim), soft };
  },

  sample({ count }) {
    return present(file).sample(count) as Float64Array<ArrayBuffer>;
  },

  advise({ motion, places }) {
    const { targets, turns, transform, temperature, adherence } = inDimension(motion);
    const found = present(fitted).advise(places, targets, turns, transform, temperature, adherence);
    return found.map(([kind, amount, , first, second, better, left]) => ({ kind, amount, near: [first, second], better, left }));
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

/** Control points whose own weight, the softmax of their row, is small. */
function sharing(ownLogits: Float32Array, m: number): number[] {
  return Array.from({ length: m }, (_, i) => i).filter((i) => {
    const row = ownLogits.subarray(m * i, m * (i + 1));
    return 1 / row.reduce((sum, logit) => sum + Math.exp(logit - row[i]!), 0) < OWNED;
  });
}

function inDimension(motion: Motion): Motion {
  const { dim } = present(points);
  const turns = motion.turns && { turns: narrowMaps(motion.turns, dim) };
  return { ...motion, ...turns, targets: narrow(motion.targets, dim) };
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
