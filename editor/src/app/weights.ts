/** Weights follow the control points: whenever one is added or moved at rest, or a parameter changes, they are fitted anew. */

import type { History } from "../commands/index.ts";
import { pointAt, type Vec3, distance, flatten } from "../model/vec3.ts";
import { turnsOf } from "../model/turn.ts";
import type { PointId, Session } from "../model/session.ts";
import { type Settings, weightsKey } from "../model/settings.ts";
import type { Handles } from "../model/handles.ts";
import type { Core, Fitted, Landed, Motion, Slot, WeightsSpec } from "../worker/protocol.ts";
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

/** How often it is asked during a drag where the control points land. */
const DRAG_MILLISECONDS = 80;

export class Weights {
  /** Shows a frame of the core where the GPU cannot hold the weights. */
  showFrame: (positions: Float64Array, maps: Float64Array) => void = () => {};
  readonly #core: Core;
  readonly #history: History;
  readonly #store: Store<State>;
  readonly #take: TakeWeights;
  readonly #keys: Record<Slot, string> = { main: "", comparison: "" };
  readonly #bound: Partial<Record<Slot, BoundWeights>> = {};
  #landing = false;
  #landAgain = false;

  constructor(core: Core, history: History, store: Store<State>, take: TakeWeights) {
    [this.#core, this.#history, this.#store, this.#take] = [core, history, store, take];
    history.subscribe(() => this.refresh());
    store.subscribe((now, before) => {
      if (now.view.comparison !== before.view.comparison) this.refresh();
    });
  }

  /** Another shape: what was fitted does not count. */
  forget(): void {
    for (const slot of ["main", "comparison"] as const) {
      this.#keys[slot] = "";
      this.#unbind(slot);
    }
    this.#store.set({ fit: { status: "none" }, comparisonFit: { status: "none" }, distances: new Map(), soft: null, advice: [], slowFrames: false });
  }

  /** Fits where something has changed, and tells where the control points land. */
  refresh(): void {
    if (!this.#store.value.shape) return;
    if (!this.#history.inGesture) {
      const { session } = this.#history;
      this.#fitIfNeeded("main", session, session.settings.kind);
      const other = session.settings.kind === "neural" ? "classic" : "neural";
      if (this.#store.value.view.comparison) this.#fitIfNeeded("comparison", session, other);
      else if (this.#bound.comparison) this.#drop("comparison");
    }
    // Not within a frame of a drag.
    this.#asking ??= setTimeout(() => {
      this.#asking = undefined;
      void this.#land();
    }, this.#history.inGesture ? DRAG_MILLISECONDS : 0);
  }

  #asking: ReturnType<typeof setTimeout> | undefined;

  /** The motion of the control points that the weights of the slot "main" were fitted to; null without any. */
  motion(session: Session): Motion | null {
    const bound = this.#bound.main;
    if (!bound) return null;
    const byId = new Map(session.points.map((point) => [point.id, point]));
    const targets = bound.ids.map((id, i): Vec3 => byId.get(id)?.target ?? pointAt(bound.p, i));
    const turned = bound.ids.map((id) => byId.get(id)?.turn);
    const { transform, temperature, adherence } = session.settings;
    return { targets: flatten(targets), ...turnsOf(turned), transform, temperature, adherence };
  }

  /** Resolves when the weights belong to the session as it is. */
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
  }

  #fitIfNeeded(slot: Slot, session: Session, kind: Settings["kind"]): void {
    const { points, settings } = session;
    const ofKind = { ...settings, kind };
    const key = points.length === 0 ? "" : JSON.stringify([kind, weightsKey(ofKind), points.map((p) => [p.id, p.position])]);
    if (key === this.#keys[slot]) return;
    this.#keys[slot] = key;
    if (points.length === 0) return this.#drop(slot);
    void this.#fit(slot, session, spec(ofKind), key);
  }

  #drop(slot: Slot): void {
    this.#keys[slot] = "";
    this.#unbind(slot);
    this.#report(slot, { status: "none" });
    if (slot === "main") this.#store.set({ distances: new Map(), soft: null, slowFrames: false });
  }

  #unbind(slot: Slot): void {
    const bound = this.#bound[slot];
    delete this.#bound[slot];
    this.#take(slot, undefined);
    bound?.handles.free();
  }

  async #fit(slot: Slot, session: Session, weights: WeightsSpec, key: string): Promise<void> {
    const p = flatten(session.points.map((point) => point.position));
    const ids = session.points.map((point) => point.id);
    const current = (): boolean => this.#keys[slot] === key;
    const start = performance.now();
    this.#report(slot, { status: "fitting", stage: "train", fraction: 0 });
    try {
      const fitted: Fitted = await this.#core.fit(p, weights, {
        slot,
        progress: (stage, fraction) => {
          if (current() && performance.now() - start > QUIET_MILLISECONDS) {
            this.#report(slot, { status: "fitting", stage, fraction });
          }
        },
      });
      if (!current()) return;
      const handles = await this.#core.handles(p, fitted.ownLogits);
      if (!current()) return handles.free();
      const { logits, ownLogits } = fitted;
      const bound = { ids, p, logits, ownLogits, handles };
      const before = this.#bound[slot];
      this.#bound[slot] = bound;
      const fits = this.#take(slot, bound);
      before?.handles.free();
      if (slot === "main") this.#store.set({ slowFrames: !fits });
      const milliseconds = performance.now() - start;
      this.#report(slot, { status: "ready", loss: fitted.loss, steps: fitted.steps, milliseconds });
      if (slot === "main" && fitted.shared.length > 0) {
        const names = fitted.shared.map((i) => session.points[i].name).join(", ");
        this.onWarning(`${names}: so close to others that they share their places, and stop short of their targets`);
      }
      void this.#land();
    } catch (error) {
      if (!current() || isAbort(error)) return;
      this.#report(slot, { status: "failed", reason: error instanceof Error ? error.message : String(error) });
    }
  }

  /** Told of sentences for a toast. */
  onWarning: (text: string) => void = () => {};

  #report(slot: Slot, fit: FitState): void {
    this.#store.set(slot === "main" ? { fit } : { comparisonFit: fit });
  }

  /** Asks where the control points land, one question at a time; the last one always gets its answer. */
  async #land(): Promise<void> {
    if (this.#landing) {
      this.#landAgain = true;
      return;
    }
    this.#landing = true;
    try {
      do {
        this.#landAgain = false;
        const { session } = this.#history;
        const bound = this.#bound.main;
        const motion = this.motion(session);
        // While others are fitted the core answers for them; it is asked again when they are there.
        if (!bound || !motion || this.#store.value.fit.status !== "ready") return;
        let landed: Landed;
        if (this.#store.value.slowFrames) {
          const frame = await this.#core.deform(motion);
          this.showFrame(frame.positions, frame.maps);
          landed = frame.landed;
        } else {
          landed = await this.#core.land(motion);
        }
        if (bound !== this.#bound.main) continue;
        const away = bound.ids.map((id, i) => [id, distance(pointAt(landed.places, i), pointAt(motion.targets, i))] as const);
        const soft = landed.soft && { ...landed.soft, id: bound.ids[landed.soft.index] };
        this.#store.set({ distances: new Map(away), soft });
      } while (this.#landAgain);
    } catch (error) {
      // A newer fit has ended the old one; it asks again when it is done.
      if (!isAbort(error)) this.onWarning(error instanceof Error ? error.message : String(error));
    } finally {
      this.#landing = false;
    }
  }
}

export const isAbort = (error: unknown): boolean => error instanceof DOMException && error.name === "AbortError";

function spec(settings: Settings): WeightsSpec {
  return settings.kind === "neural" ? { kind: "neural", ...settings.neural } : { kind: "classic", ...settings.classic };
}
