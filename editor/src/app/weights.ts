/** Weights follow the control points: whenever one is added or moved at rest, or a parameter changes, they are fitted anew. */

import type { History } from "../commands/index.ts";
import { type SessionDocument, toDocument } from "../model/document.ts";
import type { Handles } from "../model/handles.ts";
import type { ControlPoint, PointId, Session } from "../model/session.ts";
import { otherKind } from "../model/settings.ts";
import { flatten } from "../model/vec3.ts";
import type { Core, Slot } from "../worker/protocol.ts";
import { Latest } from "./latest.ts";
import type { FitState, State } from "./state.ts";
import type { Store } from "./store.ts";

/** Weights, and which control points they were computed for. */
export interface BoundWeights {
  ids: PointId[];
  /** m x 3 */
  p: Float64Array<ArrayBuffer>;
  logits: Float32Array<ArrayBuffer>;
  /** m x m: the logits at the control points' own places. */
  ownLogits: Float32Array<ArrayBuffer>;
  /** Where to aim so that they arrive. */
  handles: Handles;
}

/** What is told of new weights; undefined: there are none any more. False: the GPU cannot take them. */
export type TakeWeights = (slot: Slot, weights: BoundWeights | undefined) => boolean;

/** The progress of a quicker fit would only flicker. */
const QUIET_MILLISECONDS = 150;

const SLOTS: readonly Slot[] = ["main", "comparison"];

/** How often it is asked during a drag what happens to the control points. */
const DRAG_MILLISECONDS = 80;

export class Weights {
  /** Shows a frame of the core, where the GPU cannot compute it. */
  showFrame: (slot: Slot, positions: Float64Array, maps: Float64Array) => void = () => {};
  readonly #core: Core;
  readonly #history: History;
  readonly #store: Store<State>;
  readonly #take: TakeWeights;
  readonly #keys: Record<Slot, string> = { main: "", comparison: "" };
  /** The GPU cannot hold the weights. */
  readonly #slow: Record<Slot, boolean> = { main: false, comparison: false };
  readonly #bound: Partial<Record<Slot, BoundWeights & { points: readonly ControlPoint[] }>> = {};
  readonly #telling = new Latest(() => this.#tell());
  readonly #drawing: Record<Slot, Latest> = { main: new Latest(() => this.#draw("main")), comparison: new Latest(() => this.#draw("comparison")) };

  constructor(core: Core, history: History, store: Store<State>, take: TakeWeights) {
    [this.#core, this.#history, this.#store, this.#take] = [core, history, store, take];
    history.subscribe(() => this.refresh());
    store.subscribe((now, before) => {
      if (now.view.comparison !== before.view.comparison) this.refresh();
    });
  }

  /** Another shape: what was fitted does not count. */
  forget(): void {
    for (const slot of SLOTS) {
      this.#keys[slot] = "";
      this.#unbind(slot);
    }
    this.#store.set({ fit: { status: "none" }, comparisonFit: { status: "none" }, distances: new Map(), report: null, advice: [], slowFrames: false });
  }

  /** Fits where something has changed, and tells what happens to the control points. */
  refresh(): void {
    if (!this.#store.value.shape) return;
    if (!this.#history.inGesture) {
      this.#fitIfNeeded("main");
      if (this.#store.value.view.comparison) this.#fitIfNeeded("comparison");
      else if (this.#bound.comparison) this.#drop("comparison");
    }
    for (const slot of SLOTS) this.#drawing[slot].ask();
    // Not within a frame of a drag.
    this.#asking ??= setTimeout(() => {
      this.#asking = undefined;
      this.#telling.ask();
    }, this.#history.inGesture ? DRAG_MILLISECONDS : 0);
  }

  #asking: ReturnType<typeof setTimeout> | undefined;

  /** The control points that the weights of a slot were fitted to, moved as they are now; null without any. */
  document(session: Session, slot: Slot = "main"): SessionDocument | null {
    const { shape } = this.#store.value;
    const bound = this.#bound[slot];
    if (!bound || !shape) return null;
    const byId = new Map(session.points.map((point) => [point.id, point]));
    const points = bound.points.map((point) => ({ ...(byId.get(point.id) ?? point), position: point.position }));
    return toDocument({ ...session, points, pairs: [] }, shape.opened.dim);
  }

  /** Resolves when the weights belong to the session as it is, and so does what is shown. */
  async settled(): Promise<void> {
    await new Promise<void>((resolve) => {
      const done = (): boolean => this.#store.value.fit.status !== "fitting";
      if (done()) return resolve();
      const end = this.#store.subscribe(() => {
        if (!done()) return;
        end();
        resolve();
      });
    });
    await this.#drawing.main.done();
  }

  /** The session of a slot as it is now. */
  #sessionOf(slot: Slot): Session {
    const { session } = this.#history;
    if (slot === "main") return session;
    return { ...session, settings: { ...session.settings, kind: otherKind(session.settings.kind) } };
  }

  #fitOf(slot: Slot): FitState {
    const { fit, comparisonFit } = this.#store.value;
    return slot === "main" ? fit : comparisonFit;
  }

  #fitIfNeeded(slot: Slot): void {
    const session = this.#sessionOf(slot);
    const { points, frame, settings } = session;
    const { kind, weights } = settings;
    const on = points.map(({ id, position, weight }) => [id, position, weight]);
    const [plain, elastic] = [false, true].map((elastic) => JSON.stringify([kind, weights[kind], frame, on, elastic]));
    // What was fitted with relax serves without it too.
    const serves = this.#keys[slot] === elastic && this.#fitOf(slot).status !== "failed";
    const key = points.length === 0 ? "" : settings.relax > 0 || serves ? elastic : plain;
    if (key === this.#keys[slot]) return;
    this.#keys[slot] = key;
    if (points.length === 0) return this.#drop(slot);
    void this.#fit(slot, session, key);
  }

  #drop(slot: Slot): void {
    this.#keys[slot] = "";
    this.#unbind(slot);
    this.#report(slot, { status: "none" });
    if (slot === "main") this.#store.set({ distances: new Map(), report: null, slowFrames: false });
  }

  #unbind(slot: Slot): void {
    const bound = this.#bound[slot];
    delete this.#bound[slot];
    this.#take(slot, undefined);
    bound?.handles.free();
  }

  async #fit(slot: Slot, session: Session, key: string): Promise<void> {
    const { points } = session;
    const document = toDocument(session, this.#store.value.shape!.opened.dim);
    const current = (): boolean => this.#keys[slot] === key;
    const start = performance.now();
    this.#report(slot, { status: "fitting", stage: "train", fraction: 0 });
    try {
      const { logits, ownLogits, loss, steps } = await this.#core.fit(document, {
        slot,
        progress: (stage, fraction) => {
          if (current() && performance.now() - start > QUIET_MILLISECONDS) {
            this.#report(slot, { status: "fitting", stage, fraction });
          }
        },
      });
      if (!current()) return;
      const handles = await this.#core.handles(document, ownLogits);
      if (!current()) return handles.free();
      const [ids, p] = [points.map(({ id }) => id), flatten(points.map(({ position }) => position))];
      const bound = { points, ids, p, logits, ownLogits, handles };
      const before = this.#bound[slot];
      this.#bound[slot] = bound;
      const fits = this.#take(slot, bound);
      before?.handles.free();
      this.#slow[slot] = !fits;
      if (slot === "main") this.#store.set({ slowFrames: !fits });
      this.#report(slot, { status: "ready", loss, steps, milliseconds: performance.now() - start });
      this.#drawing[slot].ask();
      this.#telling.ask();
    } catch (error) {
      if (!current() || isAbort(error)) return;
      // What was fitted before belongs to other control points, or to other weights than those that are asked for.
      this.#unbind(slot);
      if (slot === "main") this.#store.set({ distances: new Map(), report: null });
      this.#report(slot, { status: "failed", reason: error instanceof Error ? error.message : String(error) });
    }
  }

  /** Told of sentences for a toast. */
  onWarning: (text: string) => void = () => {};

  #report(slot: Slot, fit: FitState): void {
    this.#store.set(slot === "main" ? { fit } : { comparisonFit: fit });
  }

  /** Asks what happens to the control points. */
  async #tell(): Promise<void> {
    await this.#ask("main", async (bound, document) => {
      const report = await this.#core.report(document);
      if (bound !== this.#bound.main) return;
      this.#store.set({ distances: new Map(bound.ids.map((id, i) => [id, report.distances[i]])), report });
    });
  }

  /** Has the core compute what is shown, where the GPU cannot: it knows nothing of `relax`, and does not hold all weights. */
  async #draw(slot: Slot): Promise<void> {
    if (!this.#slow[slot] && this.#history.session.settings.relax === 0) return;
    await this.#ask(slot, async (bound, document) => {
      const { positions, maps } = await this.#core.deform(document, { slot });
      if (bound === this.#bound[slot]) this.showFrame(slot, positions, maps);
    });
  }

  /** Asks the core about a slot's session as it is, unless others are fitted: it is asked again when they are there. */
  async #ask(slot: Slot, question: (bound: BoundWeights, document: SessionDocument) => Promise<void>): Promise<void> {
    const bound = this.#bound[slot];
    const document = this.document(this.#sessionOf(slot), slot);
    if (!bound || !document || this.#fitOf(slot).status !== "ready") return;
    try {
      await question(bound, document);
    } catch (error) {
      // A newer fit has ended the old one; it asks again when it is done.
      if (!isAbort(error)) this.onWarning(error instanceof Error ? error.message : String(error));
    }
  }
}

export const isAbort = (error: unknown): boolean => error instanceof DOMException && error.name === "AbortError";
