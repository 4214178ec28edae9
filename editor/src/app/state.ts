/** All that the panels show. */

import type { Soft } from "../model/handles.ts";
import type { PointId, Session } from "../model/session.ts";
import { EMPTY_SESSION } from "../model/session.ts";
import { DEFAULT_VIEW, type View } from "../model/view.ts";
import type { Advice, Files, Opened } from "../worker/protocol.ts";

export interface OpenShape {
  opened: Opened;
  files: Files;
  /** Whether there are materials or colours of the file's own to show. */
  hasAppearance: boolean;
}

/** How the weights are. */
export type FitState =
  | { status: "none" }
  | { status: "fitting"; stage: string; fraction: number }
  | { status: "ready"; loss: number | null; steps: number; milliseconds: number }
  | { status: "failed"; reason: string };

export interface Toast {
  id: number;
  kind: "error" | "warning" | "done";
  text: string;
}

/** Work that one waits for. */
export interface Busy {
  label: string;
  fraction: number | null;
  cancel: (() => void) | null;
}

export type Theme = "system" | "light" | "dark";

export interface Sample {
  name: string;
  title: string;
  file: string;
  points: string | null;
  materials: string[];
}

/** Work of an earlier visit that can be taken up again. */
export interface Recovery {
  name: string;
  when: Date;
  points: number;
}

export interface State {
  shape: OpenShape | null;
  session: Session;
  undoLabel: string | undefined;
  redoLabel: string | undefined;
  view: View;
  fit: FitState;
  comparisonFit: FitState;
  /** How far each control point ends from its target, in file units. */
  distances: ReadonlyMap<PointId, number>;
  /** Why control points do not arrive as the adherence says, and which one is to blame. */
  soft: (Soft & { id: PointId }) | null;
  /** What is likely bad about the shape as it is, and the control points that it is about. */
  advice: readonly (Advice & { ids: PointId[] })[];
  /** The GPU cannot hold the weights: the core computes the frames. */
  slowFrames: boolean;
  busy: Busy | null;
  toasts: readonly Toast[];
  help: boolean;
  theme: Theme;
  samples: readonly Sample[];
  recovery: Recovery | null;
  /** Whether the browser keeps the work. */
  autosaved: Date | null;
}

export const INITIAL_STATE: State = {
  shape: null,
  session: EMPTY_SESSION,
  undoLabel: undefined,
  redoLabel: undefined,
  view: DEFAULT_VIEW,
  fit: { status: "none" },
  comparisonFit: { status: "none" },
  distances: new Map(),
  soft: null,
  advice: [],
  slowFrames: false,
  busy: null,
  toasts: [],
  help: false,
  theme: "system",
  samples: [],
  recovery: null,
  autosaved: null,
};
