/** Nothing that a person did is lost: every work is kept as it changes, and can be taken up again. */

import type { History } from "../commands/index.ts";
import { toDocument } from "../model/document.ts";
import { isMoved } from "../model/session.ts";
import { type Files, type Head, sizeOf, type Work, type Works } from "../storage/works.ts";
import type { State } from "./state.ts";
import type { Store } from "./store.ts";

const AUTOSAVE_MILLISECONDS = 400;
/** A picture is taken when nothing has changed for so long, as it takes a frame. */
const PICTURE_MILLISECONDS = 3000;

export class Keeping {
  readonly #works: Works;
  readonly #history: History;
  readonly #store: Store<State>;
  readonly #picture: () => string;
  /** The work that is open. */
  #open: { id: string; picture: string } | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #picturing: ReturnType<typeof setTimeout> | undefined;
  #writing = Promise.resolve();
  /** Whether the browser has all of it. */
  #kept = true;
  /** Told once: what the browser does not let us keep (private windows, a full disk) hinders nothing else. */
  onRefused: () => void = () => undefined;

  constructor(works: Works, history: History, store: Store<State>, picture: () => string) {
    [this.#works, this.#history, this.#store, this.#picture] = [works, history, store, picture];
    window.addEventListener("beforeunload", (event) => {
      if (this.#store.value.refused && !this.#isEmpty) event.preventDefault();
    });
  }

  /** Begins to keep what is open, as a new work, or as `work` gone on with; if another tab has that one, as a copy of it. */
  async begin(work?: Work): Promise<void> {
    await this.#guarded(async () => {
      const id = work && (await this.#works.claim(work.id)) ? work.id : await this.#works.begin();
      this.#open = { id, picture: work?.picture ?? "" };
    });
    await this.refresh();
  }

  /** Keeps all of what is open now; false where the browser refuses, and it would be lost with another shape in its place. */
  async flush(): Promise<boolean> {
    clearTimeout(this.#timer);
    clearTimeout(this.#picturing);
    if (this.#isEmpty) return true;
    this.#takePicture();
    await this.#write();
    return this.#kept;
  }

  /** Another shape takes its place; tells the work's number if there is something to go back to. */
  leave(): string | null {
    const id = this.#open?.id ?? null;
    clearTimeout(this.#timer);
    clearTimeout(this.#picturing);
    const empty = this.#isEmpty;
    this.#open = null;
    if (id !== null) this.#works.release(id);
    if (id !== null && empty) void this.#guarded(() => this.#works.forget(id));
    return empty || !this.#kept ? null : id;
  }

  get #isEmpty(): boolean {
    return !this.#store.value.shape || this.#history.session.points.length === 0;
  }

  /** Something has changed. */
  changed(): void {
    this.#kept = false;
    this.#sayLast();
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#write(), AUTOSAVE_MILLISECONDS);
    clearTimeout(this.#picturing);
    this.#picturing = setTimeout(() => {
      this.#takePicture();
      void this.#write();
    }, PICTURE_MILLISECONDS);
  }

  async load(id: string): Promise<{ work: Work; files: Files } | undefined> {
    return this.#works.load(id);
  }

  /** The work of this tab before the page was loaded again; in a duplicate of a tab that of the other one. */
  async ofThisTab(): Promise<{ work: Work; files: Files } | undefined> {
    try {
      const id = this.#works.ofThisTab;
      return id === null ? undefined : await this.#works.load(id);
    } catch {
      return undefined;
    }
  }

  /** The newest that is not open, of these very files. */
  async ofFiles(name: string, files: Files): Promise<Work | undefined> {
    const bytes = sizeOf(files);
    for (const work of this.#store.value.recent) {
      if (work.name !== name || work.bytes !== bytes) continue;
      const loaded = await this.#works.load(work.id);
      if (loaded && sameFiles(loaded.files, files)) return work;
    }
    return undefined;
  }

  async forget(id: string): Promise<void> {
    await this.#guarded(() => this.#works.forget(id));
    await this.refresh();
  }

  /** Lists what can be taken up again. */
  async refresh(): Promise<void> {
    await this.#guarded(async () => this.#store.set({ recent: await this.#works.list() }));
  }

  #head(): Head | null {
    const { shape, view } = this.#store.value;
    const { points } = this.#history.session;
    if (!shape) return null;
    const session = points.length > 0 ? JSON.stringify(toDocument(this.#history.session, shape.opened.dim)) : "";
    return { session, points: points.length, moved: points.filter(isMoved).length, view, when: new Date() };
  }

  /** One after the other. */
  #write(): Promise<void> {
    const [open, head, { shape }] = [this.#open, this.#head(), this.#store.value];
    if (!open || !head || !shape) return Promise.resolve();
    const { files, opened } = shape;
    this.#kept = true; // but for what changes from here on
    this.#writing = this.#writing.then(() =>
      this.#guarded(async () => {
        const work = { ...head, ...open, name: opened.name, bytes: sizeOf(files) };
        await this.#works.save(work, files);
        this.#store.set({ autosaved: head.when, refused: false });
      }),
    );
    return this.#writing;
  }

  #takePicture(): void {
    if (this.#open) this.#open.picture = this.#picture();
  }

  #sayLast(): void {
    const head = this.#head();
    if (!this.#open || !head) return;
    try {
      this.#works.sayLast(this.#open.id, head);
    } catch {
      // There is little room for it; the database has more.
    }
  }

  async #guarded(what: () => Promise<void>): Promise<void> {
    try {
      await what();
    } catch {
      this.#kept = false;
      if (!this.#store.value.refused) this.onRefused();
      this.#store.set({ refused: true });
    }
  }
}

export function sameFiles(a: Files, b: Files): boolean {
  if (a.size !== b.size) return false;
  return [...a].every(([name, bytes]) => {
    const other = b.get(name);
    return other?.length === bytes.length && bytes.every((byte, at) => byte === other[at]);
  });
}
