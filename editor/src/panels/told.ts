import type { State } from "../app/state.ts";

const WHEN = new Intl.DateTimeFormat([], { dateStyle: "medium", timeStyle: "short" });

/** A work in a few words. */
export const toldOf = ({ points, when }: State["recent"][number]): string => `${points} control point${points === 1 ? "" : "s"}, ${WHEN.format(when)}`;
