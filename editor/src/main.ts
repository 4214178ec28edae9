/** Joins the layers: core, application, view and panels. */

import { createElement, render } from "preact";
import { App, fetchSamples } from "./app/app.ts";
import type { Display } from "./app/display.ts";
import { initialState, type Theme } from "./app/state.ts";
import { Store } from "./app/store.ts";
import { History } from "./commands/index.ts";
import { morphTarget } from "./exports/morphTarget.ts";
import { page } from "./exports/page.ts";
import { emptySession } from "./model/session.ts";
import { listenToKeys } from "./panels/actions.ts";
import { listenToDrops } from "./panels/drops.ts";
import { Root } from "./panels/Root.tsx";
import { Works } from "./storage/works.ts";
import "./styles.css";
import { draw } from "./viewport/drawn.ts";
import { Viewport } from "./viewport/viewport.ts";
import { coreBytes, createCore } from "./worker/client.ts";

const THEME_KEY = "neuralmls-theme";

const root = document.getElementById("app") as HTMLElement;
const core = createCore();
const { defaults, constants } = await core.rules().catch((error: Error) => {
  root.textContent = `${error.message}.`;
  throw error;
});
const history = new History(emptySession(defaults));
const store = new Store(initialState(defaults, (localStorage.getItem(THEME_KEY) ?? "system") as Theme));
const host = document.createElement("div");
host.className = "canvas-host";
const viewport = startViewport();

function startViewport(): Viewport {
  try {
    return new Viewport(host, history, store.value.view, constants);
  } catch (error) {
    root.textContent = "The editor needs WebGL 2, which this browser does not offer here: another one, or another graphics driver, may.";
    throw error;
  }
}

const display: Display = {
  async showShape(opened, files) {
    const { drawn, mesh, hasAppearance } = await draw(opened, files);
    viewport.setShape(drawn, opened.frame, opened.dim, mesh);
    return { hasAppearance };
  },
  setWeights: (slot, weights) => viewport.setWeights(slot, weights),
  showFrame: (slot, positions, maps) => viewport.showFrame(slot, positions, maps),
  setView: (view) => viewport.setView(view),
  focus: (what) => viewport.focus(what),
  cancel: () => viewport.cancel(),
  thumbnail: () => viewport.thumbnail(),
  picture: () => viewport.picture(),
  async morphTarget({ positions }) {
    if (!viewport.drawn) throw new Error("There is no shape yet.");
    return morphTarget(viewport.drawn, viewport.box, positions);
  },
  async page(title) {
    const { drawn, bound } = viewport;
    if (!drawn || !bound) throw new Error("There are no control points yet.");
    return page(title, drawn, viewport.box, store.value.shape?.opened.dim ?? 3, bound, history.session, await coreBytes(), constants);
  },
};

const app = new App(core, defaults, new Works(), history, store, display);
store.subscribe(({ theme }, before) => {
  if (theme !== before.theme) localStorage.setItem(THEME_KEY, theme);
});
render(createElement(Root, { app, host }), root);
viewport.stage.renderer.domElement.addEventListener("webglcontextlost", () => {
  app.toast("error", "The browser has lost the graphics card: reload the page, your work is kept.");
});
listenToKeys(app);
listenToDrops(app);
void app.start(fetchSamples());

/** For tests and for the curious: what the GPU shows, in the order and the units of the file, and what is known of it. */
Object.assign(globalThis, {
  neuralmls: {
    readback: () => viewport.readback(),
    screenOf: (place: [number, number, number]) => viewport.screenOf(place),
    state: () => store.value,
  },
});
