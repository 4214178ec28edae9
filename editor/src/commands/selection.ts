/** Commands that select. */

import { find, piece, type PointId, type Session } from "../model/session.ts";
import type { Command } from "./history.ts";

/** How a new selection goes together with the one that is there. */
export type Mode = "replace" | "add" | "toggle";

export function select(ids: readonly PointId[], mode: Mode = "replace"): Command {
  return { label: "Select", apply: (session) => withSelection(session, combined(session.selection, withGroups(session, ids), mode)) };
}

export function selectAll(): Command {
  return {
    label: "Select all",
    apply: (session) => withSelection(session, session.points.map((point) => point.id)),
  };
}

/** Selects the control point that is `by` places further in the list, from the leader on. */
export function selectNext(by: 1 | -1): Command {
  return {
    label: "Select",
    apply(session) {
      const count = session.points.length;
      if (count === 0) return session;
      const last = session.selection.at(-1);
      const at = session.points.findIndex((point) => point.id === last);
      const next = at < 0 ? (by === 1 ? 0 : count - 1) : (at + by + count) % count;
      return withSelection(session, withGroups(session, [session.points[next].id]));
    },
  };
}

/** A group is selected whole; what was asked for leads. */
function withGroups(session: Session, ids: readonly PointId[]): PointId[] {
  const others = ids.flatMap((id) => {
    const point = find(session, id);
    return point ? piece(session, point).map((one) => one.id) : [];
  });
  return [...new Set(others.filter((id) => !ids.includes(id))), ...ids];
}

function combined(now: readonly PointId[], ids: readonly PointId[], mode: Mode): PointId[] {
  if (mode === "replace") return [...ids];
  const others = now.filter((id) => !ids.includes(id));
  return mode === "add" ? [...others, ...ids] : [...others, ...ids.filter((id) => !now.includes(id))];
}

function withSelection(session: Session, selection: PointId[]): Session {
  const same = selection.length === session.selection.length && selection.every((id, i) => id === session.selection[i]);
  return same ? session : { ...session, selection };
}
