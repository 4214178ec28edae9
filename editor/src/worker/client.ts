/**
 * The main thread's end of the workers: one holds the shape's file; another, for each slot, fits and deforms. A fit that is no longer
 * wanted is stopped by ending its worker, since a worker cannot hear anything while the core computes.
 */

import coreUrl from "../wasm/neuralmls_wasm_bg.wasm?url";
import { initSync } from "../wasm/neuralmls_wasm.js";
import { widen, widenMaps } from "./coordinates.ts";
import { createHandles } from "./handles.ts";
import type { Moved } from "./messages.ts";
import { type CallOptions, type Core, CoreError, type Files, type Fitted, type Opened, type SessionDocument, type Slot } from "./protocol.ts";
import { Remote } from "./remote.ts";
import { readSession, rules, withSession } from "./sessions.ts";

/** Starts loading the core; the first call waits for it. */
export function createCore(): Core {
  return new Client(compiled());
}

/** The core as it came, for pages that are dragged offline. */
export async function coreBytes(): Promise<ArrayBuffer> {
  return (await fetched()).arrayBuffer();
}

async function fetched(): Promise<Response> {
  const response = await fetch(coreUrl);
  if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
  return response;
}

async function compiled(): Promise<WebAssembly.Module> {
  try {
    const response = await fetched();
    // Not every static host sends the type that compiling while loading demands.
    const streams = response.headers.get("content-type") === "application/wasm";
    return await (streams ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer()));
  } catch (error) {
    throw new CoreError(`the editor's core could not be loaded: ${error instanceof Error ? error.message : error}`);
  }
}

/** The open shape. */
interface Open {
  remote: Remote;
  files: Files;
  name: string;
  /** n x dim */
  x: Float64Array;
  opened: Opened;
}

/** A worker that has the points, and its newest fit. */
interface Fitter {
  remote: Remote;
  loaded: Promise<null>;
  fitting: Promise<Fitted> | null;
  busy: boolean;
}

class Client implements Core {
  #core: Promise<WebAssembly.Module>;
  #shape: Open | null = null;
  #opening: Remote | null = null;
  #fitters = new Map<Slot, Fitter>();

  constructor(core: Promise<WebAssembly.Module>) {
    this.#core = core;
    this.#core.catch(() => undefined); // each call that waits for it is told
  }

  async rules() {
    await this.#here();
    return rules();
  }

  async open(files: Files, name: string, options?: CallOptions) {
    this.#opening?.end(); // a newer one takes its place
    const { remote, give } = await this.#read(files, name, options);
    const { opened, x } = give;
    this.close();
    this.#shape = { remote, files, name, x, opened };
    this.#start("main");
    return opened;
  }

  async readSession(files: Files, names: readonly string[]) {
    const { dim, bounds } = this.#present().opened;
    await this.#here();
    return readSession(files, names, { min: Float64Array.from(bounds.min.slice(0, dim)), max: Float64Array.from(bounds.max.slice(0, dim)) });
  }

  async sessionText(session: SessionDocument, fitted: boolean) {
    if (fitted) return (await this.#fitted()).call("sessionText", { session });
    await this.#here();
    return withSession(session, (session) => session.to_json());
  }

  async fit(session: SessionDocument, options: CallOptions & { slot?: Slot } = {}) {
    const slot = options.slot ?? "main";
    let fitter = this.#fitters.get(slot);
    if (fitter?.busy) fitter.remote.end();
    if (!fitter || fitter.remote.ended) fitter = this.#start(slot);
    const { remote, loaded } = fitter;
    const fitting = loaded.then(() => remote.call("fit", { session }, options));
    fitter.fitting = fitting;
    fitter.busy = true;
    try {
      return await fitting;
    } finally {
      if (fitter.fitting === fitting) fitter.busy = false;
    }
  }

  async deform(session: SessionDocument, options: CallOptions & { slot?: Slot } = {}) {
    const { positions, maps } = await this.#moved(session, true, options);
    const { dim } = this.#present().opened;
    return { positions: widen(positions, dim), maps: widenMaps(maps!, dim) };
  }

  async report(session: SessionDocument, options: CallOptions = {}) {
    return (await this.#fitted()).call("report", { session }, options);
  }

  async advise(session: SessionDocument, options: CallOptions = {}) {
    return (await this.#fitted()).call("advise", { session }, options);
  }

  async handles(session: SessionDocument, ownLogits: Float32Array) {
    const { dim } = this.#present().opened;
    await this.#here();
    return createHandles(session, dim, ownLogits);
  }

  async save(name: string, session: SessionDocument | null, options: CallOptions = {}) {
    const moved = session && (await this.#moved(session, this.#present().opened.hasNormals, options));
    return (await this.#reader()).call("write", { name, moved }, options);
  }

  async farthestPoints(count: number, seed = 0, options: CallOptions = {}) {
    return (await this.#reader()).call("farthestPoints", { count, seed }, options);
  }

  close() {
    this.#shape?.remote.end();
    for (const fitter of this.#fitters.values()) fitter.remote.end();
    this.#shape = null;
    this.#fitters.clear();
  }

  async #read(files: Files, name: string, options?: CallOptions) {
    if (!files.has(name)) throw new CoreError(`${name}: there is no such file among those that were opened`);
    const remote = new Remote(this.#core);
    this.#opening = remote;
    try {
      return { remote, give: await remote.call("open", { files: [...files], name }, options) };
    } catch (error) {
      remote.end();
      throw error;
    } finally {
      if (this.#opening === remote) this.#opening = null;
    }
  }

  #start(slot: Slot): Fitter {
    const { x, opened } = this.#present();
    const remote = new Remote(this.#core);
    const loaded = remote.call("load", { x, dim: opened.dim, triangles: opened.triangles });
    loaded.catch(() => undefined); // the fit that waits for it is told
    const fitter = { remote, loaded, fitting: null, busy: false };
    this.#fitters.set(slot, fitter);
    return fitter;
  }

  /** The worker of a slot whose newest fit is done. */
  async #fitted(slot: Slot = "main"): Promise<Remote> {
    for (;;) {
      const fitting = this.#fitters.get(slot)?.fitting;
      if (!fitting) throw new CoreError("there are no weights yet: add a control point");
      const failed = await fitting.then(() => null, (error: unknown) => ({ error }));
      const fitter = this.#fitters.get(slot);
      if (fitter?.fitting !== fitting) continue; // a newer one has taken its place
      if (failed) throw failed.error;
      return fitter.remote;
    }
  }

  async #moved(session: SessionDocument, maps: boolean, options: CallOptions & { slot?: Slot }): Promise<Moved> {
    return (await this.#fitted(options.slot)).call("deform", { session, maps }, options);
  }

  /** The core on this thread, for what is too small for a worker. */
  async #here(): Promise<void> {
    initSync({ module: await this.#core }); // the first time
  }

  /** The worker that has the shape's file; read anew if it was lost. */
  async #reader(): Promise<Remote> {
    const shape = this.#present();
    if (shape.remote.ended) shape.remote = (await this.#read(shape.files, shape.name)).remote;
    return shape.remote;
  }

  #present(): Open {
    if (!this.#shape) throw new CoreError("no shape is open");
    return this.#shape;
  }
}
