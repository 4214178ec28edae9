/** The program of a page that is dragged offline (exports/page.ts): the view and the history of the editor, without its panels. */

import { History, resetTargets, set } from "../commands/index.ts";
import { type Bundle, decodeFloats, decodeIndices, unpack, unpackMaterial } from "../exports/bundle.ts";
import { toDocument } from "../model/document.ts";
import { flatten } from "../model/vec3.ts";
import { DEFAULT_VIEW } from "../model/view.ts";
import { Viewport } from "../viewport/viewport.ts";
import { initSync } from "../wasm/neuralmls_wasm.js";
import { createHandles } from "../worker/handles.ts";

const COLDEST = 0.05;
const HOTTEST = 10;
const STEPS = 400;

const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const bundle = JSON.parse(element("bundle").textContent ?? "") as Bundle;

const history = new History(bundle.session);
const viewport = new Viewport(element("view"), history, { ...DEFAULT_VIEW, adding: false }, bundle.constants);
viewport.setShape(
  {
    rest: {
      positions: decodeFloats(bundle.positions),
      normals: decodeFloats(bundle.normals),
      points: decodeIndices(bundle.points),
    },
    index: bundle.index === null ? null : decodeIndices(bundle.index),
    ...(bundle.uv !== null && { uv: decodeFloats(bundle.uv) }),
    ...(bundle.colours !== null && { colours: decodeFloats(bundle.colours) }),
    groups: bundle.groups,
    materials: bundle.materials.map((material) => unpackMaterial(material, () => viewport.invalidate())),
  },
  bundle.box,
  bundle.dim,
  undefined,
);

void bind();

async function bind(): Promise<void> {
  const { session, dim } = bundle;
  const [logits, ownLogits] = [decodeFloats(bundle.logits), decodeFloats(bundle.ownLogits)];
  initSync({ module: await WebAssembly.compile(await unpack(bundle.core)) });
  const handles = createHandles(toDocument(session, dim), dim, ownLogits);
  const ids = session.points.map(({ id }) => id);
  viewport.setWeights("main", { ids, p: flatten(session.points.map(({ position }) => position)), logits, ownLogits, handles });
}

const temperature = element<HTMLInputElement>("temperature");
const show = (): void => {
  temperature.value = String((STEPS * Math.log(history.session.settings.temperature / COLDEST)) / Math.log(HOTTEST / COLDEST));
};
temperature.addEventListener("input", () => {
  history.execute(set("temperature", COLDEST * (HOTTEST / COLDEST) ** (Number(temperature.value) / STEPS)));
});
temperature.addEventListener("change", () => history.seal());
element("undo").addEventListener("click", () => history.undo());
element("reset").addEventListener("click", () => history.execute(resetTargets("all")));
history.subscribe(show);
show();
window.addEventListener("keydown", (event) => {
  const key = event.key.toLowerCase();
  if (key === "escape") viewport.cancel();
  else if ((event.ctrlKey || event.metaKey) && key === "z") event.shiftKey ? history.redo() : history.undo();
  else return;
  event.preventDefault();
});
