/** What the keys and buttons that need more than a command do; one list, which the help shows too. */

import type { App } from "../app/app.ts";
import { group, nudge, removeSelected, resetTargets, select, selectAll, selectNext, toggleLock, ungroup, unpair, pair } from "../commands/index.ts";
import { scale, type Vec3 } from "../model/vec3.ts";

export interface Shortcut {
  /** As the help shows it. */
  keys: string;
  label: string;
  group: "Edit" | "Move" | "View" | "File";
  matches: (event: KeyboardEvent) => boolean;
  run: (app: App, event: KeyboardEvent) => void;
}

const control = (event: KeyboardEvent): boolean => event.ctrlKey || event.metaKey;
const plain = (key: string) => (event: KeyboardEvent): boolean =>
  event.key.toLowerCase() === key && !control(event) && !event.altKey;
const withControl = (key: string, shift = false) => (event: KeyboardEvent): boolean =>
  event.key.toLowerCase() === key && control(event) && event.shiftKey === shift;

/** The part of the shape's size that an arrow key moves by; ten times with Shift. */
const NUDGE = 0.01;

const ARROWS: Record<string, Vec3> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, -1],
  PageDown: [0, 0, 1],
};

function nudgeBy(app: App, event: KeyboardEvent): void {
  const { session, shape, view } = app.store.value;
  if (!shape || session.selection.length === 0) return;
  const size = 2 * shape.opened.frame.half * NUDGE * (event.shiftKey ? 10 : 1);
  const arrow = ARROWS[event.key];
  // Not out of the plane of a shape that is in one.
  if (arrow.findIndex((c) => c !== 0) < shape.opened.dim) app.do(nudge(view.moves, scale(arrow, size)));
}

export const SHORTCUTS: readonly Shortcut[] = [
  { keys: "Ctrl O", label: "Open a shape or control points", group: "File", matches: withControl("o"), run: () => document.getElementById("open-files")?.click() },
  { keys: "Ctrl S", label: "Save the bent shape", group: "File", matches: withControl("s"), run: (app) => void app.saveShape() },
  { keys: "Ctrl Shift S", label: "Save the control points", group: "File", matches: withControl("s", true), run: (app) => void app.savePoints() },
  { keys: "Ctrl Z", label: "Undo", group: "Edit", matches: withControl("z"), run: (app) => app.history.undo() },
  { keys: "Ctrl Shift Z", label: "Redo", group: "Edit", matches: (e) => withControl("z", true)(e) || withControl("y")(e), run: (app) => app.history.redo() },
  { keys: "Ctrl A", label: "Select all control points", group: "Edit", matches: withControl("a"), run: (app) => app.do(selectAll()) },
  { keys: "N", label: "Next control point (Shift: previous)", group: "Edit", matches: plain("n"), run: (app, e) => app.do(selectNext(e.shiftKey ? -1 : 1)) },
  { keys: "Delete", label: "Delete the selected control points", group: "Edit", matches: (e) => e.key === "Delete" || e.key === "Backspace", run: (app) => app.do(removeSelected()) },
  { keys: "L", label: "Lock or free", group: "Edit", matches: plain("l"), run: (app) => app.do(toggleLock(app.history.session.selection)) },
  { keys: "G", label: "Group the selected control points (Shift: ungroup)", group: "Edit", matches: (e) => e.key.toLowerCase() === "g" && !control(e) && !e.altKey, run: (app, e) => app.do((e.shiftKey ? ungroup : group)(app.history.session.selection)) },
  { keys: "0", label: "Reset the selected targets", group: "Edit", matches: plain("0"), run: (app) => app.do(resetTargets("selected")) },
  { keys: "P", label: "Make the two selected twins, or part them", group: "Edit", matches: plain("p"), run: (app) => togglePair(app) },
  { keys: "A", label: "Clicks on the surface add control points, or not", group: "Edit", matches: plain("a"), run: (app) => app.setView({ adding: !app.store.value.view.adding }) },
  { keys: "M", label: "Drags select in a box, or turn the view", group: "Edit", matches: plain("m"), run: (app) => app.setView({ boxes: !app.store.value.view.boxes }) },
  { keys: "W  E  R", label: "Gizmo: move, rotate, scale", group: "Move", matches: (e) => ["w", "e", "r"].some((key) => plain(key)(e)), run: (app, e) => app.setView({ tool: TOOLS[e.key.toLowerCase()] }) },
  { keys: "← → ↑ ↓  Page", label: "Move by a hundredth of the shape (Shift: a tenth)", group: "Move", matches: (e) => e.key in ARROWS && !control(e) && !e.altKey, run: nudgeBy },
  { keys: "Q", label: "Move targets, or the places at rest", group: "Move", matches: plain("q"), run: (app) => app.setView({ moves: app.store.value.view.moves === "target" ? "position" : "target" }) },
  { keys: "F", label: "Look at the selected control points", group: "View", matches: plain("f"), run: (app) => app.display.focus("selection") },
  { keys: "Home", label: "Look at the whole shape", group: "View", matches: (e) => e.key === "Home", run: (app) => app.display.focus("all") },
  { keys: "B", label: "Hold: the shape before", group: "View", matches: plain("b"), run: (app) => app.setView({ before: true }) },
  { keys: "C", label: "Neural and inverse-distance weights side by side", group: "View", matches: plain("c"), run: (app) => app.setView({ comparison: !app.store.value.view.comparison }) },
  { keys: "1  2  3", label: "Colours: material, weight of the selected, all", group: "View", matches: (e) => ["1", "2", "3"].some((key) => plain(key)(e)), run: (app, e) => app.setView({ colouring: (["material", "weight", "points"] as const)[Number(e.key) - 1] }) },
  { keys: "X", label: "Wireframe", group: "View", matches: plain("x"), run: (app) => app.setView({ wireframe: !app.store.value.view.wireframe }) },
  { keys: "?", label: "This list", group: "View", matches: (e) => e.key === "?", run: (app) => app.store.set({ help: !app.store.value.help }) },
];

const TOOLS: Record<string, "translate" | "rotate" | "scale"> = { w: "translate", e: "rotate", r: "scale" };

function togglePair(app: App): void {
  const { selection, pairs } = app.history.session;
  if (selection.length !== 2) return;
  const [a, b] = selection;
  app.do(pairs.some((both) => both.includes(a) && both.includes(b)) ? unpair(a) : pair(a, b));
}

/** What the mouse does, for the help. */
export const GESTURES: readonly (readonly [string, string])[] = [
  ["Click", "Add a control point on the surface, or select one"],
  ["Shift click", "Add to the selection, or take away"],
  ["Shift drag", "Select all in a box; with fingers: the tool of that name"],
  ["Drag a point", "Move it freely; Ctrl: in steps; Esc: as if it had not been"],
  ["Alt press, drag", "Add inside of the shape or in empty space; up: deeper"],
  ["Drag", "Turn the view; right button: shift it; wheel: zoom; two fingers: both"],
];

const TYPING = "input:not([type=radio]):not([type=range]):not([type=checkbox]):not([type=file]), textarea, select, [contenteditable]";

/** Listens to the keys of the page. Off while one types, and in open menus. */
export function listenToKeys(app: App): void {
  window.addEventListener("keydown", (event) => {
    const target = event.target instanceof Element ? event.target : null;
    if (event.key === "Escape") return escape(app);
    if (target?.closest(TYPING) && !withControl("s")(event)) return;
    // Arrows belong to what has the focus, where it knows them.
    if (event.key in ARROWS && target?.closest("input, [role=menu], [role=listbox]")) return;
    if (app.store.value.help && event.key !== "?") return;
    const shortcut = SHORTCUTS.find(({ matches }) => matches(event));
    if (!shortcut) return;
    event.preventDefault();
    if (event.repeat && event.key.toLowerCase() === "b") return;
    shortcut.run(app, event);
  });
  window.addEventListener("keyup", (event) => {
    if (event.key.toLowerCase() === "b") app.setView({ before: false });
  });
  window.addEventListener("blur", () => app.setView({ before: false }));
}

function escape(app: App): void {
  if (app.store.value.help) app.store.set({ help: false });
  else if (app.display.cancel()) return;
  else if (app.history.inGesture) app.history.cancel();
  else app.do(select([]));
}
