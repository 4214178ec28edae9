/** One page (HTML) that holds the bound shape and everything that it takes to drag it, offline. */

import type { Box } from "../commands/index.ts";
import type { Constants } from "../model/handles.ts";
import type { Session } from "../model/session.ts";
import type { Drawn } from "../viewport/shapeView.ts";
import { type Bundle, encode, pack, packMaterial } from "./bundle.ts";

/** The weights that are shown. */
interface Bound {
  logits: Float32Array;
  ownLogits: Float32Array;
}

/** `session`: with the control points that the weights are for; `core`: its bytes. */
export async function page(
  title: string,
  drawn: Drawn,
  box: Box,
  dim: 1 | 2 | 3,
  bound: Bound,
  session: Session,
  core: ArrayBuffer,
  constants: Constants,
): Promise<string> {
  const response = await fetch("./offline.js");
  if (!response.ok) throw new Error("This copy of the editor has no offline.js, which the page to drag is made of.");
  const bundle: Bundle = {
    title,
    box: { centre: box.centre, half: box.half },
    dim,
    session: { ...session, selection: [] },
    logits: encode(finite(bound.logits)),
    ownLogits: encode(finite(bound.ownLogits)),
    core: await pack(core),
    constants,
    positions: encode(drawn.rest.positions),
    normals: encode(drawn.rest.normals),
    points: encode(drawn.rest.points),
    index: drawn.index && encode(drawn.index),
    uv: drawn.uv ? encode(drawn.uv) : null,
    colours: drawn.colours ? encode(drawn.colours) : null,
    groups: drawn.groups,
    materials: drawn.index ? drawn.materials.map(packMaterial) : [],
  };
  return html(title, JSON.stringify(bundle), await response.text());
}

/** Infinite logits (a point on a control point) are as good as large ones. */
const finite = (logits: Float32Array): Float32Array => logits.map((logit) => Math.min(logit, 1e30));

const escaped = (text: string): string =>
  text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c] as string);

function html(title: string, data: string, program: string): string {
  // Nothing in either text may end its element.
  const inScript = (text: string): string => text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
  return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escaped(title)}</title>
<style>${STYLE}</style>
</head>
<body>
<main id="view"></main>
<header><h1>${escaped(title)}</h1><p>Drag a point. Drag beside the shape to turn it.</p></header>
<footer>
<label>Temperature <input id="temperature" type="range" min="0" max="400"></label>
<button id="undo" type="button">Undo</button>
<button id="reset" type="button">Reset</button>
</footer>
<script type="application/json" id="bundle">${data.replaceAll("<", "\\u003c")}</script>
<script>${inScript(program)}</script>
</body>
</html>
`;
}

const STYLE = `
:root { color-scheme: light dark; font: 14px/1.4 system-ui, sans-serif; color: light-dark(#1a1d23, #e8eaee); }
html, body { height: 100%; margin: 0; overflow: hidden; background: light-dark(#e6e9ed, #14161a); }
#view, #view canvas, .pane { position: absolute; inset: 0; width: 100%; height: 100%; }
.pane { touch-action: none; }
.pane.over-marker { cursor: grab; }
.selection-box { position: absolute; border: 1px solid #d8670f; background: rgb(255 140 26 / 14%); pointer-events: none; }
header { position: absolute; top: 14px; left: 18px; pointer-events: none; }
h1 { margin: 0; font-size: 18px; }
p { margin: 2px 0; opacity: 0.7; }
footer { position: absolute; left: 18px; right: 18px; bottom: 16px; display: flex; flex-wrap: wrap; gap: 12px; align-items: center; pointer-events: none; }
label { display: flex; gap: 8px; align-items: center; }
footer > * { pointer-events: auto; }
button { font: inherit; padding: 6px 14px; border: 1px solid color-mix(in srgb, currentColor 25%, transparent); border-radius: 8px; background: light-dark(#fff, #262a31); color: inherit; cursor: pointer; }
input { accent-color: #c2530a; }
`;
