import type { Colouring } from "../model/view.ts";
import { Button, Segmented } from "./controls.tsx";
import { useApp, useAppState } from "./useStore.ts";

const COLOURS: readonly { value: Colouring; label: string; title: string }[] = [
  { value: "material", label: "Material", title: "As the file has it (1)" },
  { value: "weight", label: "Weight", title: "The weight of the selected control point (2)" },
  { value: "points", label: "All points", title: "Each control point in its colour (3)" },
];

/** What the colours on the shape show; beside it. */
export function LookBar() {
  const app = useApp();
  const { view, session, shape } = useAppState();
  if (!shape) return null;
  // What has none is shown plain.
  const colours = shape.hasAppearance ? COLOURS : [{ ...COLOURS[0], label: "Plain", title: "One colour (1)" }, ...COLOURS.slice(1)];
  const chosen = session.points.find((point) => point.id === session.selection.at(-1));
  return (
    <div class="look-bar">
      <div class="row">
        <Segmented label="Colours" value={view.colouring} options={colours} onChange={(colouring) => app.setView({ colouring })} />
        {shape.opened.triangles && (
          <Button quiet icon="wire" label="Wireframe" hint="X" pressed={view.wireframe} onClick={() => app.setView({ wireframe: !view.wireframe })} />
        )}
      </div>
      {view.colouring === "weight" && (
        <div class="heat-legend">
          <span>0</span>
          <span class="heat-scale" role="img" aria-label="Blue: weight 0, red: weight 1" />
          <span>1</span>
          <em>{chosen ? `weight of ${chosen.name}` : "select a control point"}</em>
        </div>
      )}
    </div>
  );
}
