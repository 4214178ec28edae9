import type { Theme } from "../app/state.ts";
import { Button, Menu, MenuItem } from "./controls.tsx";
import { Icon } from "./icons.tsx";
import { toldOf } from "./told.ts";
import { useApp, useAppState } from "./useStore.ts";

const NEXT_THEME: Record<Theme, Theme> = { system: "dark", dark: "light", light: "system" };

const WHOLE = new Intl.NumberFormat("en");

export function TopBar() {
  const app = useApp();
  const { shape, samples, recent, undoLabel, redoLabel, theme, view, busy } = useAppState();
  const nothing = !shape || busy !== null;
  const choose = (close: () => void, what: () => Promise<void>) => () => {
    close();
    void what();
  };
  const format = shape?.opened.format ?? "shape";
  return (
    <header class="top-bar">
      <h1 class="brand">
        <svg viewBox="0 0 24 24" aria-hidden="true">
          <path d="M4 18C7 6 11 6 12 12s5 6 8-6" />
          <circle cx="4" cy="18" r="2.4" />
          <circle cx="20" cy="6" r="2.4" />
        </svg>
        <span>NeuralMLS</span>
      </h1>
      <div class="group">
        <Button icon="open" label="Open" hint="Ctrl O" onClick={() => document.getElementById("open-files")?.click()} />
        {samples.length > 0 && (
          <Menu label="Samples">
            {(close) =>
              samples.map((sample) => (
                <MenuItem key={sample.name} label={sample.title} onClick={choose(close, () => app.openSample(sample))} />
              ))
            }
          </Menu>
        )}
        {recent.length > 0 && (
          <Menu label="Recent">
            {(close) =>
              recent.map((work) => (
                <MenuItem key={work.id} label={work.name} detail={toldOf(work)} onClick={choose(close, () => app.takeUp(work.id))} />
              ))
            }
          </Menu>
        )}
        <Menu label="Save" icon="save" primary={shape !== null} disabled={nothing}>
          {(close) => (
            <>
              <MenuItem label={`Bent ${format}`} detail="The file that came in, with nothing lost · Ctrl S" onClick={choose(close, () => app.saveShape())} />
              <MenuItem label="Control points" detail="JSON, for neuralmls deform · Ctrl Shift S" onClick={choose(close, () => app.savePoints())} />
              <MenuItem label="GLB with morph target" detail="Rest and bent shape in one" onClick={choose(close, () => app.saveMorphTarget())} />
              <MenuItem label="Page to drag" detail="One HTML file, works offline" onClick={choose(close, () => app.savePage())} />
              <MenuItem label="Picture" detail="PNG of the view" onClick={choose(close, () => app.savePicture())} />
            </>
          )}
        </Menu>
      </div>
      <div class="group">
        <Button quiet icon="undo" label={undoLabel ? `Undo: ${undoLabel}` : "Undo"} hint="Ctrl Z" disabled={!undoLabel} onClick={() => app.history.undo()} />
        <Button quiet icon="redo" label={redoLabel ? `Redo: ${redoLabel}` : "Redo"} hint="Ctrl Shift Z" disabled={!redoLabel} onClick={() => app.history.redo()} />
      </div>
      <div class="file-name" title={shape?.opened.facts.map(([what, how]) => `${what}: ${how}`).join("\n")}>
        {shape && (
          <>
            <strong>{shape.opened.name}</strong>
            <span>
              {WHOLE.format(shape.opened.count)} points
              {shape.opened.triangles ? ` · ${WHOLE.format(shape.opened.triangles.length / 3)} triangles` : ""}
            </span>
          </>
        )}
      </div>
      <div class="group">
        <Button icon="compare" label="Compare" hint="C" pressed={view.comparison} disabled={!shape} onClick={() => app.setView({ comparison: !view.comparison })} />
        <Button quiet icon="theme" label={`Theme: ${theme}`} onClick={() => app.store.set({ theme: NEXT_THEME[theme] })} />
        <Button quiet icon="help" label="Keys and help" hint="?" onClick={() => app.store.set({ help: true })} />
      </div>
      <label class="visually-hidden" for="open-files">
        <Icon name="open" /> Open a shape or control points
      </label>
    </header>
  );
}
