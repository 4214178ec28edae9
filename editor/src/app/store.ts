/** A value that is never changed in place, and those who want to know when it is replaced. */
export class Store<T extends object> {
  #value: T;
  readonly #listeners = new Set<(value: T, before: T) => void>();

  constructor(value: T) {
    this.#value = value;
  }

  get value(): T {
    return this.#value;
  }

  /** Replaces some of its keys. */
  set(change: Partial<T>): void {
    const before = this.#value;
    if (Object.entries(change).every(([key, value]) => before[key as keyof T] === value)) return;
    this.#value = { ...before, ...change };
    for (const listener of this.#listeners) listener(this.#value, before);
  }

  /** Calls `listener` after every change; returns what ends that. */
  subscribe(listener: (value: T, before: T) => void): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }
}
