/**
 * Exact handles on the main thread, from an instance of the core of its own. A worker's answer would come a frame late, and the surface
 * would trail behind its markers; the control points alone are so few that the thread does not feel it.
 */

import type { Handles } from "../model/handles.ts";
import { Handles as CoreHandles, initSync } from "../wasm/neuralmls_wasm.js";
import { narrow, narrowMaps, widen } from "./coordinates.ts";

/** Of the control points (m x 3) of a shape with points of `dim` coordinates, with the logits at their own places (m x m). */
export function createHandles(core: WebAssembly.Module, p: Float64Array, dim: number, ownLogits: Float32Array): Handles {
  initSync({ module: core }); // the first time
  const handles = new CoreHandles(narrow(p, dim), dim, ownLogits);
  return {
    aim(targets, { turns, transform, temperature, adherence }) {
      const aimed = handles.aim(narrow(targets, dim), turns && narrowMaps(turns, dim), transform, temperature, adherence);
      return widen(aimed as Float64Array<ArrayBuffer>, dim);
    },
    free: () => handles.free(),
  };
}
