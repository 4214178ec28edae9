/**
 * Where to aim, on the main thread, from an instance of the core of its own. A worker's answer would come a frame late, and the surface
 * would trail behind its markers; the control points alone are so few that the thread does not feel it.
 */

import { type SessionDocument, settingsEntry } from "../model/document.ts";
import type { Aim, Handles, Hold } from "../model/handles.ts";
import type { Settings } from "../model/settings.ts";
import { Handles as CoreHandles } from "../wasm/neuralmls_wasm.js";
import { narrow, narrowMaps, widenInto, widenMaps } from "./coordinates.ts";
import { withSession } from "./sessions.ts";

/** Of a session with control points of `dim` coordinates, with the logits at their own places (m x m). */
export function createHandles(document: SessionDocument, dim: number, ownLogits: Float32Array): Handles {
  const handles = withSession(document, (session) => new CoreHandles(session, ownLogits));
  const m = document.control_points.length;
  const aim = {
    targets: new Float64Array(3 * m),
    rotation: new Float32Array(9),
    scale: 1,
    linear: new Float32Array(9),
    orientations: new Float64Array(9 * m),
  } satisfies Aim;
  let set: Settings | undefined;
  let held: readonly (Hold | undefined)[] = [];
  return {
    squares: handles.squares() as Float64Array,
    aim(targets, orientations, settings, holds) {
      if (settings !== set || !sameHolds(holds, held)) {
        [set, held] = [settings, holds.map((hold) => hold && holdOf(hold))];
        const control_points = document.control_points.map(({ group: _, locked: __, ...point }, i) => ({ ...point, ...held[i] }));
        withSession({ ...document, control_points, settings: settingsEntry(settings) }, (session) => handles.set_session(session));
      }
      const found = handles.aim(narrow(targets, dim), orientations && narrowMaps(orientations, dim));
      widenInto(aim.targets, found, dim);
      const [anchor, size] = [found.subarray(m * dim) as Float64Array<ArrayBuffer>, dim * dim];
      aim.rotation.set(widenMaps(anchor.subarray(0, size), dim));
      aim.scale = anchor[size];
      aim.linear.set(widenMaps(anchor.subarray(size + 1, 2 * size + 1) as Float64Array<ArrayBuffer>, dim));
      aim.orientations.set(widenMaps(anchor.subarray(2 * size + 1) as Float64Array<ArrayBuffer>, dim));
      return aim;
    },
    free: () => handles.free(),
  };
}

const holdOf = ({ group, locked }: Hold): Hold => ({ locked, ...(group !== undefined && { group }) });

const sameHolds = (a: readonly (Hold | undefined)[], b: readonly (Hold | undefined)[]): boolean =>
  a.length === b.length && a.every((hold, i) => hold?.locked === b[i]?.locked && hold?.group === b[i]?.group);
