/** Commands on settings and on mirrored pairs. */

import { findPairs } from "../model/mirror.ts";
import type { Pair, PointId, Session } from "../model/session.ts";
import type { Settings, Weights } from "../model/settings.ts";
import type { Axis } from "../model/vec3.ts";
import type { Command } from "./history.ts";
import type { Box } from "./points.ts";

/** Sets one of the settings. Successive ones of the same name, as a slider gives them, are one step. */
export function set<K extends "kind" | "transform" | "temperature" | "handles" | "relax">(key: K, value: Settings[K]): Command {
  return {
    label: LABELS[key],
    mergeKey: `set ${key}`,
    apply: (session) => withSettings(session, { [key]: value }),
  };
}

const LABELS = { kind: "Weights", transform: "Map", temperature: "Temperature", handles: "Handles", relax: "Relax" } as const;

/** Sets parameters of a kind of weights. */
export function setWeights<K extends "neural" | "inverse-distance">(kind: K, change: Partial<Weights[K]>): Command {
  return {
    label: kind === "neural" ? "Network" : "Inverse distance",
    mergeKey: `${kind} ${Object.keys(change).join()}`,
    apply(session) {
      const { weights } = session.settings;
      return withSettings(session, { weights: { ...weights, [kind]: { ...weights[kind], ...change } } });
    },
  };
}

function withSettings(session: Session, change: Partial<Settings>): Session {
  const settings = { ...session.settings, ...change };
  return JSON.stringify(settings) === JSON.stringify(session.settings) ? session : { ...session, settings };
}

/** Mirrors across an axis: pairs are found anew. Null ends it. */
export function setMirror(axis: Axis | null, box: Box): Command {
  return {
    label: "Mirror",
    apply(session) {
      const pairs = axis === null ? [] : findPairs(session.points, axis, box.centre, box.half);
      return { ...withSettings(session, { mirror: axis }), pairs };
    },
  };
}

/** Makes two control points twins; each leaves the one that it had. */
export function pair(a: PointId, b: PointId): Command {
  return {
    label: "Pair",
    apply: (session) => (a === b ? session : { ...session, pairs: [...without(session, [a, b]), [a, b]] }),
  };
}

export function unpair(id: PointId): Command {
  return {
    label: "Unpair",
    apply(session) {
      const pairs = without(session, [id]);
      return pairs.length === session.pairs.length ? session : { ...session, pairs };
    },
  };
}

const without = (session: Session, ids: readonly PointId[]): Pair[] =>
  session.pairs.filter((pair) => !pair.some((id) => ids.includes(id)));
