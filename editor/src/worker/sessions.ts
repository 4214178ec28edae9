/** Sessions of the core, made of documents and of files. */

import { type SessionDocument, settingsFrom, type SettingsEntry, type WeightsEntry } from "../model/document.ts";
import type { Weights, WeightsKind } from "../model/settings.ts";
import { constants, defaultSettings, defaultWeights, Session } from "../wasm/neuralmls_wasm.js";
import { CoreError, type Files, type ReadSession, type Rules } from "./protocol.ts";

const KINDS: readonly WeightsKind[] = ["neural", "inverse-distance", "shape-aware"];

/** Does something with a session of the core, which is there for as long. */
export function withSession<T>(document: SessionDocument, what: (session: Session) => T): T {
  const session = Session.read(new TextEncoder().encode(JSON.stringify(document)), "");
  try {
    return what(session);
  } finally {
    session.free();
  }
}

/** Reads control points; those of two files are joined. `box`: that of the shape. Throws sentences that name the file. */
export function readSession(files: Files, names: readonly string[], box: { min: Float64Array; max: Float64Array }): ReadSession {
  const named = <T>(which: readonly string[], what: () => T): T => {
    try {
      return what();
    } catch (error) {
      throw new CoreError(`${which.join(" and ")}: ${error instanceof Error ? error.message : error}`);
    }
  };
  const made: Session[] = [];
  try {
    for (const name of names) made.push(named([name], () => Session.read(files.get(name)!, name)));
    if (names.length === 2) made.push(named(names, () => made[0].joined(made[1], false)));
    const session = made.at(-1)!;
    const notes = [...session.notes(), ...named(names, () => session.check(box.min, box.max))];
    const document = JSON.parse(session.to_json()) as SessionDocument;
    named(names, () => refuseLargeSeed(document));
    return { document, notes };
  } finally {
    for (const session of made) session.free();
  }
}

/** JavaScript's numbers would change it, and with it the weights. */
function refuseLargeSeed({ settings }: SessionDocument): void {
  const { seed = 0 } = (settings?.weights ?? {}) as { seed?: number };
  if (Number.isSafeInteger(seed)) return;
  throw new Error(`settings: seed: in a browser expected a whole number up to ${Number.MAX_SAFE_INTEGER}`);
}

export function rules(): Rules {
  const weights = Object.fromEntries(
    KINDS.map((kind) => {
      const { kind: _, ...parameters } = JSON.parse(defaultWeights(kind)) as WeightsEntry;
      return [kind, parameters];
    }),
  ) as unknown as Weights;
  const { anchor_weight, ridge } = JSON.parse(constants()) as { anchor_weight: number; ridge: number };
  return {
    defaults: settingsFrom(JSON.parse(defaultSettings()) as SettingsEntry, weights),
    constants: { anchorWeight: anchor_weight, ridge },
  };
}
