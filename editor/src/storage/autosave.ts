/** The work is kept in the browser (IndexedDB), so that a closed tab or a crash loses nothing. */

import type { View } from "../model/view.ts";

const DATABASE = "neuralmls-editor";
const STORE = "work";

/** What is kept: the files once a shape, the session with every change. */
export interface Work {
  name: string;
  files: ReadonlyMap<string, Uint8Array>;
  /** The text of a session file; "": without control points. */
  session: string;
  /** How many control points there are. */
  points: number;
  view: View;
  when: Date;
}

type Head = Omit<Work, "files" | "name">;

export class Autosave {
  readonly #open: Promise<IDBDatabase>;

  constructor() {
    this.#open = new Promise((resolve, reject) => {
      const request = indexedDB.open(DATABASE, 1);
      request.onupgradeneeded = () => request.result.createObjectStore(STORE);
      request.onsuccess = () => resolve(request.result);
      request.onerror = () => reject(request.error ?? new Error("IndexedDB"));
    });
    // Told by whoever reads or writes.
    this.#open.catch(() => {});
  }

  /** Keeps another shape. */
  async saveShape(name: string, files: ReadonlyMap<string, Uint8Array>): Promise<void> {
    await this.#write((store) => {
      store.put({ name, files: new Map(files) }, "shape");
      store.delete("head");
    });
  }

  async saveSession(session: string, points: number, view: View): Promise<void> {
    const head: Head = { session, points, view, when: new Date() };
    await this.#write((store) => store.put(head, "head"));
  }

  /** The work that is kept; undefined where there is none. */
  async load(): Promise<Work | undefined> {
    const store = (await this.#open).transaction(STORE).objectStore(STORE);
    const [shape, head] = await Promise.all([result(store.get("shape")), result(store.get("head"))]);
    // An editor before this one kept something else.
    if (!shape || typeof (head as Head | undefined)?.session !== "string") return undefined;
    return { ...(shape as Pick<Work, "name" | "files">), ...(head as Head) };
  }

  async clear(): Promise<void> {
    await this.#write((store) => store.clear());
  }

  async #write(what: (store: IDBObjectStore) => void): Promise<void> {
    const transaction = (await this.#open).transaction(STORE, "readwrite");
    what(transaction.objectStore(STORE));
    await new Promise<void>((resolve, reject) => {
      transaction.oncomplete = () => resolve();
      transaction.onerror = transaction.onabort = () => reject(transaction.error ?? new Error("IndexedDB"));
    });
  }
}

function result(request: IDBRequest): Promise<unknown> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result as unknown);
    request.onerror = () => reject(request.error ?? new Error("IndexedDB"));
  });
}
