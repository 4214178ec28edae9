/** The work is kept in the browser (IndexedDB), so that a closed tab or a crash loses nothing. */

import type { Session } from "../model/session.ts";
import { settingsFrom } from "../model/settings.ts";
import type { View } from "../model/view.ts";

const DATABASE = "neuralmls-editor";
const STORE = "work";

/** What is kept: the files once a shape, the session with every change. */
export interface Work {
  name: string;
  files: ReadonlyMap<string, Uint8Array>;
  session: Session;
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

  async saveSession(session: Session, view: View): Promise<void> {
    const head: Head = { session, view, when: new Date() };
    await this.#write((store) => store.put(head, "head"));
  }

  /** The work that is kept; undefined where there is none. */
  async load(): Promise<Work | undefined> {
    const store = (await this.#open).transaction(STORE).objectStore(STORE);
    const [shape, head] = await Promise.all([result(store.get("shape")), result(store.get("head"))]);
    if (!shape || !head) return undefined;
    const { session, view, when } = head as Head;
    // An older editor may not have known all settings.
    const settings = settingsFrom(session.settings);
    return { ...(shape as Pick<Work, "name" | "files">), session: { ...session, settings }, view, when };
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
