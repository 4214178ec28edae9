/**
 * Undo and redo. A command says how it changes a session; the history keeps the sessions before and after it.
 *
 * A drag is a gesture: the session changes with every frame, and the whole of it becomes one step when it ends.
 */

import type { Session } from "../model/session.ts";

/** A change with a name for a person. The same session back means that there is nothing to do. */
export interface Command {
  readonly label: string;
  /** Successive commands with the same key, such as those of a slider, are one step. */
  readonly mergeKey?: string;
  apply(session: Session): Session;
}

interface Step {
  label: string;
  mergeKey: string | undefined;
  before: Session;
  after: Session;
}

/** More steps than anyone goes back; each shares what did not change with its neighbours. */
const MOST_STEPS = 1000;

export class History {
  #session: Session;
  #done: Step[] = [];
  #undone: Step[] = [];
  #gesture: { label: string; before: Session } | undefined;
  readonly #listeners = new Set<(session: Session, before: Session) => void>();

  constructor(session: Session) {
    this.#session = session;
  }

  get session(): Session {
    return this.#session;
  }

  /** What Undo would take back, and Redo bring again. */
  get undoLabel(): string | undefined {
    return this.#done.at(-1)?.label;
  }

  get redoLabel(): string | undefined {
    return this.#undone.at(-1)?.label;
  }

  get inGesture(): boolean {
    return this.#gesture !== undefined;
  }

  /** Calls `listener` after every change; returns what ends that. */
  subscribe(listener: (session: Session, before: Session) => void): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  execute(command: Command): void {
    this.cancel();
    const before = this.#session;
    const after = command.apply(before);
    if (after === before) return;
    this.#record({ label: command.label, mergeKey: command.mergeKey, before, after });
    this.#show(after);
  }

  /** Begins a drag. */
  begin(label: string): void {
    this.cancel();
    this.#gesture = { label, before: this.#session };
  }

  /** Shows a frame of the drag: `change` applied to the session with which it began. */
  preview(change: (session: Session) => Session): void {
    if (this.#gesture) this.#show(change(this.#gesture.before));
  }

  /** Ends the drag as one step. */
  commit(): void {
    const gesture = this.#gesture;
    this.#gesture = undefined;
    if (!gesture) return;
    const after = this.#session;
    if (after !== gesture.before) this.#record({ ...gesture, mergeKey: undefined, after });
    this.#show(after);
  }

  /** Ends the drag as if it had not been. */
  cancel(): void {
    const gesture = this.#gesture;
    this.#gesture = undefined;
    if (gesture) this.#show(gesture.before);
  }

  undo(): void {
    if (this.inGesture) return this.cancel();
    const step = this.#done.pop();
    if (!step) return;
    this.#undone.push(step);
    this.#show(step.before);
  }

  redo(): void {
    if (this.inGesture) return;
    const step = this.#undone.pop();
    if (!step) return;
    this.#done.push({ ...step, mergeKey: undefined });
    this.#show(step.after);
  }

  /** The next command starts a step of its own, whatever its key: the slider was let go. */
  seal(): void {
    const last = this.#done.at(-1);
    if (last) last.mergeKey = undefined;
  }

  /** Another shape: nothing before it can be undone. */
  reset(session: Session): void {
    this.#gesture = undefined;
    this.#done = [];
    this.#undone = [];
    this.#show(session);
  }

  #record(step: Step): void {
    this.#undone = [];
    const last = this.#done.at(-1);
    if (last && step.mergeKey !== undefined && last.mergeKey === step.mergeKey) {
      last.after = step.after;
      return;
    }
    this.#done.push(step);
    if (this.#done.length > MOST_STEPS) this.#done.shift();
  }

  #show(session: Session): void {
    const before = this.#session;
    this.#session = session;
    for (const listener of this.#listeners) listener(session, before);
  }
}
