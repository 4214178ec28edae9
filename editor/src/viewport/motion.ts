/** What the GPU is told of a frame: how the control points that weights were computed for are moved. */

import type { Handles } from "../model/handles.ts";
import { find, leader, type PointId, type Session } from "../model/session.ts";
import { type Turn, turnsOf } from "../model/turn.ts";
import type { Colouring } from "../model/view.ts";
import type { GpuMotion, Tint } from "../shader/kernel.ts";
import { turnedPoints } from "../shader/turned.ts";
import type { Space } from "./space.ts";

/** Which control points weights were computed for, and where they were. */
export interface Bound {
  ids: readonly PointId[];
  /** m x 3, in file units. */
  p: Float64Array;
  /** n x m */
  logits: Float32Array;
  /** m x m */
  ownLogits: Float32Array;
  handles: Handles;
}

/** Weights that are still being fitted: what was bound last moves as far as its control points are still there. */
export function motionOf(bound: Bound, session: Session, space: Space, look: { atRest: boolean; colouring: Colouring }): GpuMotion {
  const { ids, p, handles } = bound;
  const { points } = session;
  const { transform, temperature, adherence } = session.settings;
  const targets = p.slice();
  const turns = new Array<Turn | undefined>(ids.length).fill(undefined);
  if (!look.atRest) {
    for (let i = 0; i < ids.length; i++) {
      const point = points[i]?.id === ids[i] ? points[i] : find(session, ids[i]);
      if (!point) continue;
      turns[i] = point.turn;
      for (let c = 0; c < 3; c++) {
        // Bit for bit where it is not moved.
        if (point.target[c] !== point.position[c]) targets[3 * i + c] += point.target[c] - point.position[c];
      }
    }
  }
  const aimed = handles.aim(targets, { transform, temperature, adherence, ...turnsOf(turns) });
  const places = space.allToView(p);
  return {
    p: places,
    q: space.allToView(aimed),
    turned: turnedPoints(places, turns),
    transform,
    temperature,
    tint: tintOf(bound, session, look.colouring),
  };
}

function tintOf({ ids }: Bound, session: Session, colouring: Colouring): Tint {
  if (colouring === "material") return { by: "nothing" };
  const of = colouring === "weight" ? ids.indexOf(leader(session)?.id ?? -1) : -1;
  return of < 0 ? { by: "point" } : { by: "weight", of };
}
