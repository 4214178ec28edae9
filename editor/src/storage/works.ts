/**
 * Works are kept in the browser (IndexedDB), each under a number of its own, so that neither another shape nor another tab writes over one.
 * A work is open in one tab at a time, which holds a lock by its number (Web Locks) that ends with the tab, however it ends.
 */

import { type DBSchema, type IDBPDatabase, openDB } from "idb";
import type { View } from "../model/view.ts";

const DATABASE = "neuralmls-editor";
/** What a closing tab leaves here is newer than what the database had time for. */
const LAST_WORDS = "neuralmls-last-words-";
const THIS_TAB = "neuralmls-work";
/** So many are kept, and of files so much: then the oldest go, those first in which nothing was moved. */
const MOST = 30;
const MOST_BYTES = 1e9;

export type Files = ReadonlyMap<string, Uint8Array>;

/** What changes while one works. */
export interface Head {
  /** The text of a session file; "": without control points. */
  session: string;
  /** How many control points there are, and how many of them are moved. */
  points: number;
  moved: number;
  view: View;
  when: Date;
}

/** A work, without the files of its shape. */
export interface Work extends Head {
  id: string;
  /** The shape's. */
  name: string;
  bytes: number;
  /** A small one, as the address of an image; "": none yet. */
  picture: string;
}

interface Schema extends DBSchema {
  works: { key: string; value: Work };
  files: { key: string; value: Files };
}

/** What the first version kept: one shape and one session. */
interface First {
  get(key: "shape"): Promise<{ name: string; files: Files } | undefined>;
  get(key: "head"): Promise<{ session?: unknown; points: number; view: View; when: Date } | undefined>;
}

export class Works {
  readonly #open: Promise<IDBPDatabase<Schema>>;
  /** What ends the lock of each work that is or was open here; undefined where it has ended. */
  readonly #mine = new Map<string, (() => void) | undefined>();

  constructor() {
    this.#open = opened();
    // Told by whoever reads or writes.
    this.#open.catch(() => undefined);
  }

  /** The work that was open in this tab before the page was loaded again. */
  get ofThisTab(): string | null {
    return sessionStorage.getItem(THIS_TAB);
  }

  /** A new one, open in this tab from now on. */
  async begin(): Promise<string> {
    const id = newId();
    await this.claim(id);
    return id;
  }

  /** Opens a work in this tab; false where another tab has it. */
  async claim(id: string): Promise<boolean> {
    const release = this.#mine.get(id) ?? (await locked(id));
    if (!release) return false;
    this.#mine.set(id, release);
    sessionStorage.setItem(THIS_TAB, id);
    return true;
  }

  /** Closes a work, which may then be opened here or in another tab. */
  release(id: string): void {
    this.#mine.get(id)?.();
    this.#mine.set(id, undefined);
  }

  /** Those with control points that are open nowhere, the newest first. */
  async list(): Promise<Work[]> {
    const open = await this.#inUse();
    return (await this.#all()).filter(({ id, points }) => !open.has(id) && points > 0);
  }

  async load(id: string): Promise<{ work: Work; files: Files } | undefined> {
    const database = await this.#open;
    const [work, files] = await Promise.all([database.get("works", id), database.get("files", id)]);
    return work && files && { work: withLastWords(work), files };
  }

  /** Keeps a work; its files the first time, and again if others took their room. */
  async save(work: Work, files: Files): Promise<void> {
    const transaction = (await this.#open).transaction(["works", "files"], "readwrite");
    const [works, kept] = [transaction.objectStore("works"), transaction.objectStore("files")];
    const write = async (): Promise<void> => {
      if ((await kept.getKey(work.id)) === undefined) await kept.put(files, work.id);
      await works.put(work);
    };
    await Promise.all([write(), transaction.done]);
    localStorage.removeItem(LAST_WORDS + work.id);
    await this.#makeRoom(work.id);
  }

  /** Keeps what changed last, at once: a page that is being closed has no time for the database. */
  sayLast(id: string, head: Head): void {
    localStorage.setItem(LAST_WORDS + id, JSON.stringify(head));
  }

  async forget(id: string): Promise<void> {
    const transaction = (await this.#open).transaction(["works", "files"], "readwrite");
    await Promise.all([transaction.objectStore("works").delete(id), transaction.objectStore("files").delete(id), transaction.done]);
    localStorage.removeItem(LAST_WORDS + id);
  }

  async #all(): Promise<Work[]> {
    const works = (await (await this.#open).getAll("works")).map(withLastWords);
    return works.sort((a, b) => b.when.getTime() - a.when.getTime());
  }

  /** Those that are open, here or in another tab. */
  async #inUse(): Promise<Set<string>> {
    const { held = [] } = (await navigator.locks?.query()) ?? {};
    // A lock that has just ended here may still be listed.
    const elsewhere = held.flatMap(({ name }) => (name !== undefined && !this.#mine.has(name) ? [name] : []));
    const here = [...this.#mine].flatMap(([id, release]) => (release ? [id] : []));
    return new Set([...here, ...elsewhere]);
  }

  async #makeRoom(saved: string): Promise<void> {
    const [all, inUse] = [await this.#all(), (await this.#inUse()).add(saved)];
    const worth = ({ points, moved }: Work): number => Number(points > 0) + Number(moved > 0);
    all.sort((a, b) => worth(b) - worth(a) || b.when.getTime() - a.when.getTime());
    let bytes = 0;
    for (const [at, work] of all.entries()) {
      bytes += work.bytes;
      if (!inUse.has(work.id) && (at >= MOST || bytes > MOST_BYTES)) await this.forget(work.id);
    }
  }
}

/** The database; one of an earlier editor is taken over, unless another tab has it open still. */
function opened(): Promise<IDBPDatabase<Schema>> {
  return new Promise((resolve, reject) => {
    openDB<Schema>(DATABASE, 2, {
      blocked: () => reject(new Error("an earlier editor is open in another tab")),
      blocking: (_from, _to, event) => (event.target as IDBDatabase).close(),
      async upgrade(database, from, _to, transaction) {
        database.createObjectStore("works", { keyPath: "id" });
        database.createObjectStore("files");
        if (from !== 1) return;
        const first = transaction.objectStore("work" as never) as unknown as First;
        const [shape, head] = [await first.get("shape"), await first.get("head")];
        if (shape && typeof head?.session === "string") {
          const { session, points, view, when } = head;
          const id = newId();
          await transaction.objectStore("files").put(shape.files, id);
          const work = { id, name: shape.name, bytes: sizeOf(shape.files), picture: "", session, points, moved: points, view, when };
          await transaction.objectStore("works").put(work);
        }
        database.deleteObjectStore("work" as never);
      },
    }).then(resolve, reject);
  });
}

/** Not `crypto.randomUUID`, which pages of http from other machines have not. */
const newId = (): string => `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;

export const sizeOf = (files: Files): number => [...files.values()].reduce((sum, bytes) => sum + bytes.length, 0);

function withLastWords(work: Work): Work {
  const text = localStorage.getItem(LAST_WORDS + work.id);
  if (text === null) return work;
  const head = JSON.parse(text) as Head & { when: string };
  const when = new Date(head.when);
  return when > work.when ? { ...work, ...head, when } : work;
}

/**
 * Holds a lock until the tab ends, or until what is returned is called; undefined where another has it. Where there are no locks (pages of
 * http from other machines), all are free.
 */
function locked(id: string): Promise<(() => void) | undefined> {
  if (!navigator.locks) return Promise.resolve(() => undefined);
  return new Promise((resolve, reject) => {
    navigator.locks
      .request(id, { ifAvailable: true }, (lock) => {
        if (!lock) return resolve(undefined);
        return new Promise<void>((release) => resolve(release));
      })
      .catch(reject);
  });
}
