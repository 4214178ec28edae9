import type { FitState } from "../app/state.ts";
import { isMoved } from "../model/session.ts";
import { arrived, distance } from "./controls.tsx";
import { useAppState } from "./useStore.ts";

// Made once: that takes a hundred times as long as to use it.
const CLOCK = new Intl.DateTimeFormat([], { hour: "2-digit", minute: "2-digit" });

/** How things stand, quietly. */
export function StatusBar() {
  const { fit, comparisonFit, session, shape, distances, report, advice, view, autosaved, refused, slowFrames } = useAppState();
  if (!shape) return null;
  const moved = session.points.filter(isMoved);
  const away = moved.map((point) => distances.get(point.id)).filter((d) => d !== undefined);
  const size = 2 * shape.opened.frame.half;
  const farthest = Math.max(0, ...away);
  return (
    <footer class="status-bar">
      <span class={`fit ${fit.status}`} role="status">
        {textOf(fit)}
        {view.comparison && comparisonFit.status === "fitting" ? " · comparing" : ""}
      </span>
      {away.length > 0 && (
        <span title="The largest distance of a control point from its target">
          {arrived(farthest, size) ? "on target" : `off target by at most ${distance(farthest, size)} (${percent(farthest / size)})`}
          {report?.soft ? `, ${report.handles}` : ""}
        </span>
      )}
      {advice.length > 0 && <span>worth a look: {advice.map(({ kind }) => WORDS[kind]).join(", ")}</span>}
      {slowFrames && <span>too many weights for the graphics card: frames are computed by the core</span>}
      <span class="spacer" />
      {view.moves === "position" && <span class="mode">moving places at rest</span>}
      {view.before && <span class="mode">before</span>}
      {refused && <span class="refused">not kept: save it</span>}
      {autosaved && !refused && <span title="In this browser; nothing is uploaded">kept {CLOCK.format(autosaved)}</span>}
    </footer>
  );
}

const WORDS = { misses: "missed targets", stiff: "a stiff transform", folds: "folds", torn: "tears", ungoverned: "a part without a control point" } as const;

function textOf(fit: FitState): string {
  switch (fit.status) {
    case "none":
      return "No control points yet";
    case "fitting":
      return fit.fraction > 0 ? `Fitting ${percent(fit.fraction)}` : "Fitting";
    case "failed":
      return fit.reason;
    case "ready":
      return fit.loss === null
        ? "Ready"
        : `Ready · loss ${fit.loss.toPrecision(2)} ${training(fit.steps)} · ${(fit.milliseconds / 1000).toFixed(2)} s`;
  }
}

const training = (steps: number): string => (steps === 0 ? "in closed form" : `after ${steps} steps`);
const percent = (share: number): string => `${(100 * share).toFixed(share < 0.01 ? 1 : 0)} %`;
