import { useEffect, useState } from "preact/hooks";
import { group, pair, put, rename, resetTargets, toggleLock, ungroup, unpair } from "../commands/index.ts";
import { twinOf } from "../model/mirror.ts";
import type { Orientation } from "../model/orientation.ts";
import { type ControlPoint, isMoved, leader, selected, stays } from "../model/session.ts";
import { AXES, type Vec3 } from "../model/vec3.ts";
import { Button, NumberField } from "./controls.tsx";
import { useApp, useAppState } from "./useStore.ts";

/** The selected control point in words and numbers. */
export function PointFields() {
  const app = useApp();
  const { session, view, shape } = useAppState();
  const point = leader(session);
  if (!point || !shape) return null;
  const all = selected(session);
  // Ten-thousandths of the shape.
  const digits = Math.min(12, Math.max(0, 3 - Math.floor(Math.log10(shape.opened.frame.half))));
  const row = (which: "target" | "position", title: string) => (
    <div class={`coordinates ${view.moves === which ? "" : "faint"}`}>
      <span class="row-label">{title}</span>
      {AXES.slice(0, shape.opened.dim).map((axis, at) => (
        <NumberField
          key={axis}
          prefix={axis}
          label={`${title} ${axis}`}
          value={point[which][at]}
          shown={point[which][at].toFixed(digits)}
          disabled={stays(session, point)}
          onChange={(value) => app.do(put(point.id, which, point[which].map((c, k) => (k === at ? value : c)) as unknown as Vec3))}
        />
      ))}
    </div>
  );
  return (
    <div class="point-fields">
      <div class="row">
        <NameField point={point} />
        <Button quiet icon={point.locked ? "lock" : "unlock"} label={point.locked ? "Free" : "Lock: it stays at rest, and holds what is around it"} hint="L" pressed={point.locked} onClick={() => app.do(toggleLock(session.selection))} />
        <Button quiet icon="reset" label="Reset the target" hint="0" disabled={!all.some(isMoved)} onClick={() => app.do(resetTargets("selected"))} />
      </div>
      {row("target", "Target")}
      {row("position", "At rest")}
      {point.orientation && <p class="hint">{orientationText(point.orientation)}</p>}
      {session.settings.mirror && <Twin point={point} />}
      {all.length > 1 && <Groups all={all} />}
    </div>
  );
}

/** Several that are selected: one group, or to be made one. */
function Groups({ all }: { all: readonly ControlPoint[] }) {
  const app = useApp();
  const ids = all.map(({ id }) => id);
  const grouped = all[0].group !== undefined && all.every((point) => point.group === all[0].group);
  return (
    <>
      <p class="hint">{all.length} are selected and move together{grouped ? `, as one piece: ${all[0].group}` : ""}.</p>
      <div class="row">
        <Button icon="group" label="Group" hint="G" disabled={grouped} onClick={() => app.do(group(ids))} />
        <Button label="Ungroup" hint="Shift G" disabled={!all.some((point) => point.group !== undefined)} onClick={() => app.do(ungroup(ids))} />
      </div>
    </>
  );
}

function orientationText({ axis, degrees, scale }: Orientation): string {
  const length = Math.hypot(...axis);
  const about = axis.map((c) => (c / length).toFixed(2)).join(", ");
  return `Rotated by ${degrees.toFixed(1)}° about (${about})${scale === 1 ? "" : `, scaled by ${scale}`}.`;
}

function NameField({ point }: { point: ControlPoint }) {
  const app = useApp();
  const [name, setName] = useState(point.name);
  useEffect(() => setName(point.name), [point.id, point.name]);
  const take = (): void => {
    app.do(rename(point.id, name));
    setName(app.history.session.points.find(({ id }) => id === point.id)?.name ?? name);
  };
  return (
    <input
      class="name-field"
      type="text"
      aria-label="Name"
      value={name}
      onInput={(event) => setName(event.currentTarget.value)}
      onBlur={take}
      onKeyDown={(event) => {
        if (event.key === "Enter") take();
        if (event.key === "Escape") {
          event.stopPropagation();
          setName(point.name);
        }
      }}
    />
  );
}

/** Which control point is the twin; to be chosen among the others. */
function Twin({ point }: { point: ControlPoint }) {
  const app = useApp();
  const { session } = useAppState();
  const twin = twinOf(session, point.id);
  return (
    <label class="field">
      <span>Twin</span>
      <select
        value={twin === undefined ? "" : String(twin)}
        onChange={(event) => {
          const chosen = event.currentTarget.value;
          app.do(chosen === "" ? unpair(point.id) : pair(point.id, Number(chosen)));
        }}
      >
        <option value="">none</option>
        {session.points
          .filter((other) => other.id !== point.id)
          .map((other) => (
            <option key={other.id} value={String(other.id)}>
              {other.name}
            </option>
          ))}
      </select>
    </label>
  );
}
