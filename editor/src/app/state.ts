/** All that the panels show. */

import { emptySession, type PointId, type Session } from "../model/session.ts";
import type { Settings } from "../model/settings.ts";
import { DEFAULT_VIEW, type View } from "../model/view.ts";
import type { Work } from "../storage/works.ts";
import type { Advice, Files, Opened, Report } from "../worker/protocol.ts";

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
  /** What can be done about it. */
  action?: { label: string; run: () => void };
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
  /** What happens to the control points besides, in words. */
  report: Pick<Report, "handles" | "soft" | "warnings"> | null;
  /** What is likely bad about the shape as it is, and the control points that it is about. */
  advice: readonly (Advice & { ids: PointId[] })[];
  /** The GPU cannot hold the weights: the core computes the frames. */
  slowFrames: boolean;
  busy: Busy | null;
  toasts: readonly Toast[];
  help: boolean;
  theme: Theme;
  samples: readonly Sample[];
  /** What can be taken up again, the newest first. */
  recent: readonly Work[];
  /** Of these, one of the shape that `neuralmls edit` opened. */
  offer: Work | null;
  /** When the browser last kept the work. */
  autosaved: Date | null;
  /** Whether it last refused to. */
  refused: boolean;
}

/** Before anything is opened. */
export const initialState = (settings: Settings, theme: Theme): State => ({
  shape: null,
  session: emptySession(settings),
  undoLabel: undefined,
  redoLabel: undefined,
  view: DEFAULT_VIEW,
  fit: { status: "none" },
  comparisonFit: { status: "none" },
  distances: new Map(),
  report: null,
  advice: [],
  slowFrames: false,
  busy: null,
  toasts: [],
  help: false,
  theme,
  samples: [],
  recent: [],
  offer: null,
  autosaved: null,
  refused: false,
});
