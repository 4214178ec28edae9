import "fake-indexeddb/auto";
import { IDBFactory } from "fake-indexeddb";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { DEFAULT_VIEW } from "../../src/model/view.ts";
import { type Work, Works } from "../../src/storage/works.ts";

/** Web Locks of one browser with several tabs, which this environment lacks. */
const held = new Set<string>();
const locks = {
  request: (name: string, _: unknown, then: (lock: object | null) => unknown) => {
    const free = !held.has(name);
    held.add(name);
    const ended = then(free ? {} : null);
    return free ? Promise.resolve(ended).then(() => held.delete(name)) : Promise.resolve();
  },
  query: async () => ({ held: [...held].map((name) => ({ name })) }),
};
const storage = (): Storage => {
  const kept = new Map<string, string>();
  const named = { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => void kept.set(key, value), removeItem: (key: string) => void kept.delete(key) };
  return named as unknown as Storage;
};

beforeEach(() => {
  held.clear();
  vi.stubGlobal("indexedDB", new IDBFactory());
  vi.stubGlobal("navigator", { locks });
  vi.stubGlobal("localStorage", storage());
  vi.stubGlobal("sessionStorage", storage());
});

const files = (text: string) => new Map([["shape.obj", new TextEncoder().encode(text)]]);
const work = (id: string, minute: number, more: Partial<Work> = {}): Work => ({
  id, name: "shape.obj", bytes: 3, picture: "", session: `{"of": "${id}"}`, points: 2, moved: 1, view: DEFAULT_VIEW, when: new Date(2026, 0, 1, 0, minute), ...more,
});

describe("works", () => {
  it("are kept each for itself, and listed the newest first where no tab has them", async () => {
    const works = new Works();
    await works.save(work("a", 1), files("a"));
    await works.save(work("b", 2), files("b"));
    await works.save(work("c", 3, { points: 0, moved: 0 }), files("c"));
    expect((await works.list()).map(({ id }) => id)).toEqual(["b", "a"]);
    expect(await works.claim("b")).toBe(true);
    expect((await works.list()).map(({ id }) => id)).toEqual(["a"]);
    const { work: loaded, files: its } = (await works.load("a"))!;
    expect(loaded).toEqual(work("a", 1));
    expect(new TextDecoder().decode(its.get("shape.obj"))).toBe("a");
    await works.forget("a");
    expect(await works.load("a")).toBeUndefined();
  });

  it("are open in one tab only", async () => {
    const [one, other] = [new Works(), new Works()];
    const id = await one.begin();
    expect(one.ofThisTab).toBe(id);
    expect(await one.claim(id)).toBe(true);
    expect(await other.claim(id)).toBe(false);
    expect(await other.begin()).not.toBe(id);
    await one.save(work(id, 1), files("a"));
    expect(await one.list()).toEqual([]);
    one.release(id);
    expect((await one.list()).map((its) => its.id)).toEqual([id]);
    expect(await other.claim(id)).toBe(true);
  });

  it("go on from the last words of a page that had no time for the database", async () => {
    const works = new Works();
    await works.save(work("a", 1), files("a"));
    const { id: _, name, bytes, picture, ...head } = work("a", 5, { session: "later", points: 3 });
    works.sayLast("a", head);
    expect((await works.load("a"))!.work).toEqual({ ...work("a", 5, { session: "later", points: 3 }), name, bytes, picture });
    works.sayLast("a", { ...head, session: "earlier", when: new Date(2025, 0, 1) });
    expect((await works.load("a"))!.work.session).toBe(work("a", 1).session);
    await works.save(work("a", 6), files("a"));
    expect(localStorage.getItem("neuralmls-last-words-a")).toBeNull();
  });

  it("make room: first those in which nothing was moved, then the oldest, never those that are open", async () => {
    const works = new Works();
    await works.claim("open");
    await works.save(work("open", 0, { moved: 0 }), files("o"));
    await works.save(work("unmoved", 50, { moved: 0 }), files("u"));
    for (let i = 1; i <= 30; i++) await works.save(work(`w${i}`, i), files("w"));
    expect((await works.list()).map(({ id }) => id)).toEqual(Array.from({ length: 30 }, (_, i) => `w${30 - i}`));
    await works.save(work("large", 60, { bytes: 2e9 }), files("l"));
    expect(await works.load("open")).toBeDefined();
    expect((await works.list()).map(({ id }) => id)).toEqual(["large"]);
  });

  it("that an earlier editor kept are taken over", async () => {
    await new Promise<void>((resolve, reject) => {
      const request = indexedDB.open("neuralmls-editor", 1);
      request.onupgradeneeded = () => {
        const store = request.result.createObjectStore("work");
        store.put({ name: "old.obj", files: files("old") }, "shape");
        store.put({ session: "kept", points: 4, view: DEFAULT_VIEW, when: new Date(2026, 0, 1) }, "head");
      };
      request.onsuccess = () => (request.result.close(), resolve());
      request.onerror = () => reject(request.error!);
    });
    const works = new Works();
    const [{ id, ...old }] = await works.list();
    expect(old).toMatchObject({ name: "old.obj", session: "kept", points: 4, moved: 4 });
    expect([...(await works.load(id))!.files.keys()]).toEqual(["shape.obj"]);
  });
});
