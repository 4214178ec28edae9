/** The files of tests/sessions, read as tests/sessions/table.json says: the table that Rust and Python read too. */

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { fromDocument, type SessionDocument, toDocument } from "../../src/model/document.ts";
import { Session } from "../../src/wasm/neuralmls_wasm.js";
import { readSession, withSession } from "../../src/worker/sessions.ts";
import { defaults } from "./core.ts";

const folder = new URL("../../../tests/sessions/", import.meta.url);
const bytes = (name: string): Uint8Array => readFileSync(new URL(name, folder));

type Entry = Record<string, unknown>;

interface Line {
  files: string[];
  by_order?: boolean;
  read?: { points: Entry[]; keys: Entry; notes: string[] };
  error?: { kind: string; sentence: string };
}

const table = JSON.parse(readFileSync(new URL("table.json", folder), "utf8")) as Line[];

function read({ files, by_order }: Line): Session {
  const [source, target] = files.map((name) => Session.read(bytes(name), name));
  return target ? source.joined(target, by_order ?? false) : source;
}

/** What reading gave, in the table's form. */
function told(session: Session): Line["read"] {
  const { format: _, version: __, control_points, ...keys } = JSON.parse(session.to_json()) as SessionDocument;
  return { points: control_points.map((entry) => point({ ...entry })), keys, notes: session.notes() };
}

function point({ name, position, target, rotation, scale, weight, locked, mirror_of, group, ...others }: Entry): Entry {
  const { axis, degrees, ...besides } = (rotation ?? {}) as Entry;
  const oriented = rotation !== undefined || scale !== undefined;
  if (Object.keys(besides).length > 0) others.rotation = besides;
  return given({
    name,
    position,
    target,
    orientation: oriented ? { axis: axis ?? [0, 0, 1], degrees: degrees ?? 0, scale: scale ?? 1 } : undefined,
    weight,
    locked,
    mirror_of,
    group,
    others: Object.keys(others).length > 0 ? others : undefined,
  });
}

const box = (dim: number) => ({ min: new Float64Array(dim).fill(-1), max: new Float64Array(dim).fill(1) });
const given = (entry: Entry): Entry => Object.fromEntries(Object.entries(entry).filter(([, value]) => value !== undefined));

it("the table is there", () => expect(table.length).toBeGreaterThan(60));

describe("every file is read as the table says", () => {
  it.each(table.map((line) => [line.files.join(" and ") + (line.by_order ? " by order" : ""), line] as const))("%s", (_, line) => {
    if (line.error) expect(() => read(line)).toThrow(expect.objectContaining({ message: line.error.sentence }));
    else expect(told(read(line))).toEqual(line.read);
  });
});

describe("what the editor keeps of a session is all of it", () => {
  it.each(table.filter((line) => line.read).map((line) => [line.files.join(" and "), line] as const))("%s", (_, line) => {
    const session = read(line);
    const text = session.to_json();
    const document = JSON.parse(text) as SessionDocument;
    const { seed = 0 } = (document.settings?.weights ?? {}) as { seed?: number };
    if (!Number.isSafeInteger(seed)) {
      // JavaScript's numbers cannot hold it: said, and not changed.
      const opened = () => readSession(new Map([["a.json", new TextEncoder().encode(text)]]), ["a.json"], box(session.dim()));
      return expect(opened).toThrow(/^a\.json: settings: seed: /);
    }
    const kept = toDocument(fromDocument(document, defaults), session.dim() as 1 | 2 | 3);
    const again = JSON.parse(withSession(kept, (session) => session.to_json())) as SessionDocument;
    // But for what JavaScript cannot write: the sign of zero, and others' numbers that no double holds.
    const writable = JSON.parse(JSON.stringify(document)) as SessionDocument;
    expect(again).toEqual({ ...writable, settings: document.settings ?? again.settings });
  });
});
