/** What a person can do besides editing: open, save, place control points, take up earlier work. */

import { addPoints, type Command, type History, load, placeAnew } from "../commands/index.ts";
import { fromDocument, toDocument } from "../model/document.ts";
import { emptySession, isMoved, type Session } from "../model/session.ts";
import { pointAt } from "../model/vec3.ts";
import { DEFAULT_VIEW, type View } from "../model/view.ts";
import type { Work, Works } from "../storage/works.ts";
import type { Core, Files, OnProgress, Opened, Settings } from "../worker/protocol.ts";
import { servedSession } from "../worker/served.ts";
import { Advice } from "./advice.ts";
import type { Display } from "./display.ts";
import { download, extensionOf, readAll, sort, stemOf } from "./files.ts";
import { Keeping, sameFiles } from "./keeping.ts";
import { asSentence } from "./sentence.ts";
import type { Sample, State, Toast } from "./state.ts";
import type { Store } from "./store.ts";
import { isAbort, Weights } from "./weights.ts";

const STAGES = {
  read: "Reading",
  train: "Fitting the weights",
  evaluate: "Evaluating the weights",
  deform: "Bending",
  write: "Writing",
} as const;

/** The panels follow a drag at this distance: more often would cost more than it tells. */
const PANEL_MILLISECONDS = 100;
const TOAST_MILLISECONDS = 7000;

export class App {
  readonly history: History;
  readonly store: Store<State>;
  readonly display: Display;
  readonly #core: Core;
  /** The settings that hold where nothing is said. */
  readonly #defaults: Settings;
  readonly #keeping: Keeping;
  readonly #weights: Weights;
  #toasts = 0;
  #telling: ReturnType<typeof setTimeout> | undefined;
  #opening: AbortController | undefined;

  constructor(core: Core, defaults: Settings, works: Works, history: History, store: Store<State>, display: Display) {
    [this.#core, this.#defaults, this.history, this.store, this.display] = [core, defaults, history, store, display];
    this.#keeping = new Keeping(works, history, store, () => display.thumbnail());
    this.#keeping.onRefused = () => this.toast("error", "The browser does not keep this work: save it before you close the tab.");
    this.#weights = new Weights(core, history, store, (slot, weights) => display.setWeights(slot, weights));
    this.#weights.showFrame = (slot, positions, maps) => display.showFrame(slot, positions, maps);
    new Advice(core, history, store, this.#weights);
    this.#weights.onWarning = (text) => this.toast("warning", text);
    history.subscribe(() => this.#publish());
  }

  /** Does a command. */
  do(command: Command): void {
    this.history.execute(command);
  }

  setView(change: Partial<View>): void {
    const view = { ...this.store.value.view, ...change };
    this.store.set({ view });
    this.display.setView(view);
  }

  /** Looks for what is to be opened at once, for samples, and for earlier work. */
  async start(samples: Promise<Sample[]>): Promise<void> {
    try {
      this.store.set({ samples: await samples });
    } catch {
      // A copy of the editor without samples works as well.
    }
    await this.#guarded(async () => {
      await this.#keeping.refresh();
      const [served, earlier] = [await servedSession(), await this.#keeping.ofThisTab()];
      if (earlier && earlier.work.points > 0 && (!served || sameFiles(served.files, earlier.files))) return this.#resume(earlier);
      if (!served) return;
      await this.#openShape(served.files, served.name);
      if (served.points) await this.#openPoints(new Map([served.points]), [served.points[0]]);
      this.display.focus("all");
      this.store.set({ offer: (await this.#keeping.ofFiles(served.name, served.files)) ?? null });
    });
  }

  // Opening

  async openFiles(list: readonly File[]): Promise<void> {
    if (list.length === 0) return;
    await this.#guarded(async () => this.openBytes(await readAll(list)));
  }

  async openBytes(files: Files): Promise<void> {
    const { shape, points } = sort(files);
    if (shape !== undefined) await this.#openShape(files, shape);
    else if (points.length === 0) {
      throw new Error(`${[...files.keys()].join(", ")}: expected a shape (OBJ, PLY, OFF, STL, glTF, GLB, XYZ, CSV, NPY) or control points (JSON, CSV, landmarks)`);
    }
    if (points.length > 0) await this.#openPoints(files, points);
    if (shape !== undefined) this.display.focus("all");
  }

  async openSample(sample: Sample): Promise<void> {
    await this.#guarded(async () => {
      const names = [sample.file, ...sample.materials, ...(sample.points ? [sample.points] : [])];
      const fetched = names.map(async (name) => [name, await fetchBytes(`./samples/${name}`)] as const);
      await this.openBytes(new Map(await Promise.all(fetched)));
    });
  }

  /** Opens a shape; the work on another one is kept, and can be gone back to. `work` is what is gone on with, if it is one that was kept. */
  async #openShape(files: Files, name: string, work?: Work): Promise<void> {
    await this.#busy(`Reading ${name}`, async (progress, signal) => {
      const before = this.store.value.shape?.opened.name;
      if (!(await this.#keeping.flush()) && !confirm(`The browser did not keep the work on ${before}. Open ${name}, and lose it?`)) return;
      const opened = await this.#core.open(files, name, { progress, signal });
      const session = work?.session ? await this.#sessionOf(work) : emptySession(this.#defaults);
      this.#weights.forget();
      const { hasAppearance } = await this.display.showShape(opened, files);
      const left = this.#keeping.leave();
      this.store.set({ shape: { opened, files, hasAppearance }, offer: null, toasts: [], autosaved: null });
      this.setView({ ...DEFAULT_VIEW, adding: this.store.value.view.adding });
      this.history.reset(session);
      for (const warning of opened.warnings) this.toast("warning", warning);
      await this.#keeping.begin(work);
      if (left !== null) this.toast("done", `Your work on ${before} is kept`, { label: "Go back to it", run: () => void this.takeUp(left) });
    });
  }

  async #openPoints(files: Files, names: readonly string[]): Promise<void> {
    const called = names.join(" and ");
    if (!this.store.value.shape) throw new Error(`${called}: these are control points; open the shape that they belong to first`);
    if (names.length > 2) throw new Error(`${called}: expected one file of control points, or two: where they are at rest, and where they go`);
    const { document, notes } = await this.#core.readSession(files, names);
    this.do(load(fromDocument(document, this.#defaults)));
    if (names.length === 2) this.toast("done", `${names[0]} says where control points are at rest, ${names[1]} where they go`);
    if (notes.length > 0) this.toast("warning", `${called}: ${notes.join("; ")}`);
  }

  // Control points

  /** Spreads control points over the shape; those that are neither moved nor locked give way to them. */
  async place(count: number): Promise<void> {
    await this.#guarded(async () => {
      const most = this.store.value.shape?.opened.count ?? 0;
      const flat = await this.#core.farthestPoints(Math.min(count, most));
      const places = Array.from({ length: flat.length / 3 }, (_, i) => {
        const position = pointAt(flat, i);
        return { position, target: position };
      });
      this.do(this.history.session.points.length > 0 ? placeAnew(places) : addPoints(places));
    });
  }

  // Saving

  /** The shape's file, bent, by the core's result. */
  async saveShape(): Promise<void> {
    await this.#withShape("Saving", async (opened, progress, signal) => {
      await this.#weights.settled();
      const { session } = this.history;
      if (session.points.length > 0) this.#failIfUnfitted();
      const moved = session.points.some(isMoved) ? this.#weights.document(session) : null;
      const name = `${stemOf(opened.name)}-bent.${extensionOf(opened.name) || opened.extensions[0]}`;
      const { files } = await this.#core.save(name, moved, { progress, signal });
      for (const file of files) download(file.name, new Blob([file.bytes]));
      this.toast("done", moved ? `Saved ${files.map((file) => file.name).join(" and ")}` : `Saved ${name}, which is the file as it was: nothing is moved`);
    });
  }

  /** The control points and all settings, as `neuralmls deform --points` reads them. */
  async savePoints(): Promise<void> {
    await this.#withShape("Saving", async (opened) => {
      await this.#weights.settled();
      const { session } = this.history;
      if (session.points.length === 0) throw new Error("There are no control points to save yet: click on the shape to add one.");
      const name = `${stemOf(opened.name)}.json`;
      const text = await this.#core.sessionText(toDocument(session, opened.dim), this.store.value.fit.status === "ready");
      download(name, new Blob([text], { type: "application/json" }));
      this.toast("done", `Saved ${name}`);
    });
  }

  async savePicture(): Promise<void> {
    await this.#withShape("Saving", async (opened) => {
      await this.#weights.settled();
      download(`${stemOf(opened.name)}.png`, await this.display.picture());
    });
  }

  /** A GLB of the shape at rest, with the deformed one as a morph target. */
  async saveMorphTarget(): Promise<void> {
    await this.#withShape("Saving", async (opened, progress, signal) => {
      await this.#weights.settled();
      this.#failIfUnfitted();
      const document = this.#weights.document(this.history.session);
      if (!document) throw new Error("There are no control points yet: a morph target needs a deformation.");
      const deformed = await this.#core.deform(document, { progress, signal });
      const bytes = await this.display.morphTarget(deformed);
      download(`${stemOf(opened.name)}-morph.glb`, new Blob([bytes], { type: "model/gltf-binary" }));
      this.toast("done", `Saved ${stemOf(opened.name)}-morph.glb`);
    });
  }

  /** A page that anyone can open offline and drag. */
  async savePage(): Promise<void> {
    await this.#withShape("Saving", async (opened) => {
      await this.#weights.settled();
      this.#failIfUnfitted();
      if (this.history.session.settings.relax > 0) {
        throw new Error("A page is dragged without relax: set it to 0 to save one, or save the bent shape.");
      }
      const html = await this.display.page(stemOf(opened.name));
      download(`${stemOf(opened.name)}.html`, new Blob([html], { type: "text/html" }));
      this.toast("done", `Saved ${stemOf(opened.name)}.html (${(html.length / 1e6).toFixed(1)} MB)`);
    });
  }

  // Earlier work

  /** Goes on with a work that was kept. */
  async takeUp(id: string): Promise<void> {
    await this.#guarded(async () => {
      const kept = await this.#keeping.load(id);
      if (!kept) throw new Error("This work is no longer here: it was forgotten in another tab.");
      await this.#resume(kept);
    });
  }

  async #resume({ work, files }: { work: Work; files: Files }): Promise<void> {
    await this.#openShape(files, work.name, work);
    if (this.store.value.shape?.files !== files) return; // one would rather keep what is open
    this.display.focus("all");
    this.setView({ ...work.view, before: false });
  }

  async #sessionOf({ name, session }: Work): Promise<Session> {
    const { document } = await this.#core.readSession(new Map([[name, new TextEncoder().encode(session)]]), [name]);
    return fromDocument(document, this.#defaults);
  }

  async forget(id: string): Promise<void> {
    this.store.set({ offer: null });
    await this.#keeping.forget(id);
  }

  // Telling

  toast(kind: Toast["kind"], text: string, action?: NonNullable<Toast["action"]>): void {
    const id = ++this.#toasts;
    const toast: Toast = { id, kind, text: asSentence(text), ...(action && { action }) };
    const others = this.store.value.toasts.filter((other) => other.text !== toast.text);
    this.store.set({ toasts: [...others, toast].slice(-4) });
    if (kind !== "error") setTimeout(() => this.dismiss(id), TOAST_MILLISECONDS);
  }

  dismiss(id: number): void {
    this.store.set({ toasts: this.store.value.toasts.filter((toast) => toast.id !== id) });
  }

  /** Tells the panels; not within a frame of a drag. */
  #publish(): void {
    if (!this.history.inGesture) this.#tell();
    else this.#telling ??= setTimeout(() => this.#tell(), PANEL_MILLISECONDS);
  }

  #tell(): void {
    clearTimeout(this.#telling);
    this.#telling = undefined;
    const { session, undoLabel, redoLabel } = this.history;
    this.store.set({ session, undoLabel, redoLabel });
    if (!this.history.inGesture && this.store.value.shape) this.#keeping.changed();
  }

  #failIfUnfitted(): void {
    const { fit } = this.store.value;
    if (fit.status === "failed") throw new Error(fit.reason);
    if (fit.status === "none") throw new Error("There are no control points yet: click on the shape to add one.");
  }

  async #withShape(
    label: string,
    what: (opened: Opened, progress: OnProgress, signal: AbortSignal) => Promise<void> | void,
  ): Promise<void> {
    const { shape } = this.store.value;
    if (!shape) return this.toast("error", "There is no shape yet: open one first.");
    await this.#guarded(() => this.#busy(label, async (progress, signal) => what(shape.opened, progress, signal)));
  }

  async #busy(label: string, what: (progress: OnProgress, signal: AbortSignal) => Promise<void>): Promise<void> {
    this.#opening?.abort();
    const controller = new AbortController();
    this.#opening = controller;
    const cancel = (): void => controller.abort();
    this.store.set({ busy: { label, fraction: null, cancel } });
    try {
      await what((stage, fraction) => {
        if (this.#opening === controller) this.store.set({ busy: { label: STAGES[stage], fraction, cancel } });
      }, controller.signal);
    } finally {
      if (this.#opening === controller) {
        this.#opening = undefined;
        this.store.set({ busy: null });
      }
    }
  }

  async #guarded(what: () => Promise<void>): Promise<void> {
    try {
      await what();
    } catch (error) {
      if (!isAbort(error)) this.toast("error", messageOf(error));
    }
  }
}

const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

async function fetchBytes(url: string): Promise<Uint8Array> {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} could not be loaded (${response.status}).`);
  return new Uint8Array(await response.arrayBuffer());
}

/** The samples that were built with the editor. */
export async function fetchSamples(): Promise<Sample[]> {
  return JSON.parse(new TextDecoder().decode(await fetchBytes("./samples/index.json"))) as Sample[];
}
