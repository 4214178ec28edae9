import { useEffect, useRef, useState } from "preact/hooks";
import { removeSelected, resetTargets, select, setMirror } from "../commands/index.ts";
import { twinOf } from "../model/mirror.ts";
import { type ControlPoint, isMoved } from "../model/session.ts";
import { AXES } from "../model/vec3.ts";
import { cssColour } from "../model/view.ts";
import { Button, distance, NumberField, Section, Segmented } from "./controls.tsx";
import { Icon } from "./icons.tsx";
import { PointFields } from "./PointFields.tsx";
import { useApp, useAppState } from "./useStore.ts";

const MOST_PLACED = 200;
/** More of them go in two columns, if their names are no longer than this: with the mark of a twin beside them, without. */
const COLUMN = 8;
const SHORT = { paired: 10, alone: 14 };

export function PointsPanel() {
  const app = useApp();
  const { session, shape, busy } = useAppState();
  const [count, setCount] = useState(12);
  if (!shape) return null;
  const { points, selection, settings } = session;
  const box = { centre: shape.opened.frame.centre, half: shape.opened.frame.half };
  const mirrors = [
    { value: "none", label: "Off" },
    ...AXES.slice(0, shape.opened.dim).map((axis) => ({ value: axis, label: axis.toUpperCase(), title: `A move of one moves its twin across ${axis.toUpperCase()}` })),
  ];
  return (
    <Section
      title={`Control points${points.length > 0 ? ` · ${points.length}` : ""}`}
      action={
        <span class="row">
          <Button quiet icon="reset" label="Reset all targets" disabled={!points.some(isMoved)} onClick={() => app.do(resetTargets("all"))} />
          <Button quiet icon="trash" label="Delete the selected" hint="Delete" disabled={selection.length === 0} onClick={() => app.do(removeSelected())} />
        </span>
      }
    >
      <div class="row place">
        <Button label={`Place ${count}`} disabled={busy !== null} onClick={() => void app.place(count)} />
        <input
          type="range"
          min="4"
          max="40"
          value={Math.min(count, 40)}
          aria-label="How many control points to place"
          onInput={(event) => setCount(Number(event.currentTarget.value))}
        />
        <NumberField label="How many control points to place" value={count} min={1} max={MOST_PLACED} whole onChange={setCount} />
      </div>
      <div class="row mirror">
        <span class="row-label"><Icon name="mirror" />Mirror</span>
        <Segmented
          label="Mirror across an axis"
          value={settings.mirror ?? "none"}
          options={mirrors}
          onChange={(axis) => app.do(setMirror(AXES.find((known) => known === axis) ?? null, box))}
        />
      </div>
      {points.length === 0 ? (
        <p class="hint">Click on the shape to add a control point, or let {count} be placed. Then drag one.</p>
      ) : (
        <PointList points={points} />
      )}
      <PointFields />
    </Section>
  );
}

/** Of the shape's size. */
const share = (part: number): string => (part < 0.0005 ? "0 %" : `${(100 * part).toFixed(part < 0.1 ? 1 : 0)} %`);

function PointList({ points }: { points: readonly ControlPoint[] }) {
  const app = useApp();
  const { session, distances, shape } = useAppState();
  const names = new Map(points.map((point) => [point.id, point.name]));
  const size = shape ? 2 * shape.opened.frame.half : 1;
  const chosen = new Set(session.selection);
  const last = session.selection.at(-1);
  const list = useRef<HTMLUListElement>(null);
  // What is chosen on the shape is seen in the list.
  useEffect(() => list.current?.querySelector(".leads")?.scrollIntoView({ block: "nearest" }), [last]);
  const longest = Math.max(...points.map(({ name }) => name.length));
  const twoColumns = points.length > COLUMN && longest <= (session.settings.mirror ? SHORT.paired : SHORT.alone);
  return (
    <ul ref={list} class={`points ${twoColumns ? "two-columns" : ""}`} aria-label="Control points">
      {points.map((point, i) => {
        const away = distances.get(point.id);
        const twin = session.settings.mirror && twinOf(session, point.id);
        // A handle that stops short by a fiftieth of the shape is one to look at.
        const short_ = away !== undefined && away > size / 50;
        return (
          <li key={point.id}>
            <button
              type="button"
              class={`point ${chosen.has(point.id) ? "chosen" : ""} ${point.id === last ? "leads" : ""}`}
              aria-pressed={chosen.has(point.id)}
              onClick={(event) => app.do(select([point.id], event.shiftKey || event.ctrlKey || event.metaKey ? "toggle" : "replace"))}
            >
              <i class="swatch" style={{ background: cssColour(i) }} />
              <span class="name" title={point.name}>{point.name}</span>
              {twin !== null && twin !== undefined && <small title={`Its twin: ${names.get(twin)}`}>↔ <span>{names.get(twin)}</span></small>}
              {point.group !== undefined && <span class="piece" title={`Moves as one piece with all of ${point.group}`}><Icon name="group" /></span>}
              {point.locked && <Icon name="lock" />}
              <span class={`distance ${short_ ? "short" : ""}`} title={away === undefined ? "" : `It ends ${distance(away, size)} from its target`}>
                {isMoved(point) && away !== undefined ? share(away / size) : ""}
              </span>
            </button>
          </li>
        );
      })}
    </ul>
  );
}
