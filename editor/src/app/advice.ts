/** Honest advice: when a drag has ended and the weights are there, the core looks at the shape, and says what is likely bad. */

import type { History } from "../commands/index.ts";
import { isMoved } from "../model/session.ts";
import type { Core } from "../worker/protocol.ts";
import type { State } from "./state.ts";
import type { Store } from "./store.ts";
import type { Weights } from "./weights.ts";

/** Whoever drags again at once does not wait for it. */
const REST_MILLISECONDS = 500;

export class Advice {
  readonly #core: Core;
  readonly #history: History;
  readonly #store: Store<State>;
  readonly #weights: Weights;
  #waiting: ReturnType<typeof setTimeout> | undefined;

  constructor(core: Core, history: History, store: Store<State>, weights: Weights) {
    [this.#core, this.#history, this.#store, this.#weights] = [core, history, store, weights];
    history.subscribe(() => this.#soon());
    store.subscribe((now, before) => {
      if (now.fit !== before.fit) this.#soon();
    });
  }

  #soon(): void {
    if (this.#history.inGesture) return; // asked when it ends
    clearTimeout(this.#waiting);
    this.#waiting = setTimeout(() => void this.#ask(), REST_MILLISECONDS);
  }

  async #ask(): Promise<void> {
    const { session } = this.#history;
    const { fit, advice } = this.#store.value;
    if (this.#history.inGesture || fit.status === "fitting") return; // asked again afterwards
    const bound = fit.status === "ready" && session.points.some(isMoved) ? this.#weights.document(session) : null;
    if (!bound) {
      if (advice.length > 0) this.#store.set({ advice: [] });
      return;
    }
    try {
      const found = await this.#core.advise(bound);
      if (session !== this.#history.session || fit !== this.#store.value.fit) return; // asked anew already
      const ids = session.points.map(({ id }) => id);
      // Of control points that do not arrive the report tells already, beside the handles.
      const { report } = this.#store.value;
      const told = report !== null && (report.soft !== null || report.warnings.length > 0);
      const shown = found.filter(({ kind }) => kind !== "misses" || !told);
      this.#store.set({ advice: shown.map((one) => ({ ...one, ids: one.control_points.map((i) => ids[i]) })) });
    } catch {
      // A newer fit has ended the worker; it is asked again when that is done. Advice is not worth an error.
    }
  }
}
