/** The command that takes control points and settings from a file. */

import type { Session } from "../model/session.ts";
import type { Command } from "./history.ts";

export function load(read: Session): Command {
  return { label: "Open control points", apply: () => read };
}
