/** One worker as promises. It does one thing after the other; what it is doing is stopped by ending it. */

import type { Answer, Ask, Give, Operation, Question } from "./messages.ts";
import { type CallOptions, CoreError, type OnProgress } from "./protocol.ts";

/** What takes long enough to be stopped, and leaves nothing that would be lost with the worker. */
const STOPPED_BY_ENDING: readonly Operation[] = ["open", "fit"];

export function aborted(): DOMException {
  return new DOMException("stopped", "AbortError");
}

interface Call {
  resolve: (give: Give<Operation>) => void;
  reject: (error: unknown) => void;
  progress: OnProgress | undefined;
}

export class Remote {
  #worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
  #calls = new Map<number, Call>();
  #next = 0;
  #ready: Promise<void>;
  #ended = false;

  /** Starts a worker on the compiled core. */
  constructor(core: Promise<WebAssembly.Module>) {
    this.#worker.addEventListener("message", ({ data }: MessageEvent<Answer>) => this.#hear(data));
    this.#worker.addEventListener("error", (event) => {
      event.preventDefault();
      this.end(new CoreError(`the core could not be started: ${event.message || "its worker was not loaded"}`));
    });
    this.#ready = core.then((module) => this.#worker.postMessage(module));
    this.#ready.catch(() => undefined); // each call that waits for it is told
  }

  /** Whether it was ended, and can do nothing any more. */
  get ended(): boolean {
    return this.#ended;
  }

  async call<O extends Operation>(operation: O, ask: Ask<O>, { progress, signal }: CallOptions = {}): Promise<Give<O>> {
    if (signal?.aborted || this.#ended) throw aborted();
    const id = this.#next++;
    const stop = () => (STOPPED_BY_ENDING.includes(operation) ? this.end() : this.#calls.get(id)?.reject(aborted()));
    signal?.addEventListener("abort", stop);
    try {
      const answer = new Promise<Give<Operation>>((resolve, reject) => this.#calls.set(id, { resolve, reject, progress }));
      answer.catch(() => undefined); // it may be rejected before the core is ready
      await this.#ready;
      if (!this.#ended) this.#worker.postMessage({ id, operation, ask } satisfies Question<O>);
      return (await answer) as Give<O>;
    } finally {
      this.#calls.delete(id);
      signal?.removeEventListener("abort", stop);
    }
  }

  /** Stops whatever it does; every call that is not answered is rejected. */
  end(reason: unknown = aborted()): void {
    this.#ended = true;
    this.#worker.terminate();
    for (const call of this.#calls.values()) call.reject(reason);
    this.#calls.clear();
  }

  #hear(answer: Answer): void {
    const call = this.#calls.get(answer.id);
    if (!call) return;
    if (answer.kind === "progress") call.progress?.(answer.stage, answer.fraction);
    else if (answer.kind === "done") call.resolve(answer.give);
    else if (answer.kind === "refused") call.reject(new CoreError(answer.message));
    else this.end(new CoreError(answer.message));
  }
}
