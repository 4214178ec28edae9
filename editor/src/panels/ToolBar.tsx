import type { Tool } from "../model/view.ts";
import { Button } from "./controls.tsx";
import type { IconName } from "./icons.tsx";
import { useApp, useAppState } from "./useStore.ts";

const TOOLS: readonly { tool: Tool; label: string; hint: string; icon: IconName }[] = [
  { tool: "translate", label: "Move", hint: "W", icon: "translate" },
  { tool: "rotate", label: "Rotate", hint: "E", icon: "rotate" },
  { tool: "scale", label: "Scale several", hint: "R", icon: "scale" },
];

/** The tools beside the shape. */
export function ToolBar() {
  const app = useApp();
  const { view, shape } = useAppState();
  if (!shape) return null;
  return (
    <div class="tool-bar" role="toolbar" aria-label="Tools" aria-orientation="vertical">
      <Button quiet icon="add" label="Click adds control points" hint="A" pressed={view.adding} onClick={() => app.setView({ adding: !view.adding })} />
      <Button quiet icon="box" label="A drag selects in a box" hint="M" pressed={view.boxes} onClick={() => app.setView({ boxes: !view.boxes })} />
      <hr />
      {TOOLS.map(({ tool, label, hint, icon }) => (
        <Button key={tool} quiet icon={icon} label={label} hint={hint} pressed={view.tool === tool} onClick={() => app.setView({ tool })} />
      ))}
      <hr />
      <Button quiet icon="pin" label="Move places at rest" hint="Q" pressed={view.moves === "position"} onClick={() => app.setView({ moves: view.moves === "target" ? "position" : "target" })} />
      <Button quiet icon="before" label="The shape before" hint="hold B" pressed={view.before} onClick={() => app.setView({ before: !view.before })} />
      <Button quiet icon="frame" label="Look at the whole shape" hint="Home" onClick={() => app.display.focus("all")} />
    </div>
  );
}
