/** What the GPU is told of a frame: how the control points that weights were computed for are moved. */

import type { Handles, Hold } from "../model/handles.ts";
import { type Orientation, orientationsOf } from "../model/orientation.ts";
import { find, leader, type PointId, type Session } from "../model/session.ts";
import type { Colouring } from "../model/view.ts";
import type { GpuMotion, Tint } from "../shader/kernel.ts";
import { orientedPoints } from "../shader/oriented.ts";
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

/** Frames of one set of weights; what they are made in is there once. */
export class Motions {
  readonly bound: Bound;
  readonly #space: Space;
  readonly #p: Float64Array;
  readonly #q: Float64Array;
  readonly #targets: Float64Array;
  readonly #orientations: (Orientation | undefined)[];
  readonly #holds: (Hold | undefined)[];

  constructor(bound: Bound, space: Space) {
    [this.bound, this.#space] = [bound, space];
    this.#p = space.allToView(bound.p, new Float64Array(bound.p.length));
    this.#q = new Float64Array(bound.p.length);
    this.#targets = new Float64Array(bound.p.length);
    this.#orientations = new Array<Orientation | undefined>(bound.ids.length);
    this.#holds = new Array<Hold | undefined>(bound.ids.length);
  }

  /** Weights that are still being fitted: what was bound last moves as far as its control points are still there. */
  of(session: Session, look: { atRest: boolean; colouring: Colouring }): GpuMotion {
    const { ids, p, handles } = this.bound;
    const { points, settings } = session;
    const [targets, orientations, holds] = [this.#targets, this.#orientations, this.#holds];
    targets.set(p);
    orientations.fill(undefined);
    holds.fill(undefined);
    for (let i = 0; i < ids.length && !look.atRest; i++) {
      const point = points[i]?.id === ids[i] ? points[i] : find(session, ids[i]);
      if (!point) continue;
      [orientations[i], holds[i]] = [point.orientation, point];
      for (let c = 0; c < 3; c++) {
        // Bit for bit where it is not moved.
        if (point.target[c] !== point.position[c]) targets[3 * i + c] += point.target[c] - point.position[c];
      }
    }
    const aim = handles.aim(targets, orientationsOf(orientations), settings, holds);
    return {
      p: this.#p,
      q: this.#space.allToView(aim.targets, this.#q),
      oriented: orientedPoints(aim.orientations, handles.squares, this.#space.box.half),
      anchor: aim,
      transform: settings.transform,
      temperature: settings.temperature,
      tint: tintOf(this.bound, session, look.colouring),
    };
  }
}

function tintOf({ ids }: Bound, session: Session, colouring: Colouring): Tint {
  if (colouring === "material") return { by: "nothing" };
  const of = colouring === "weight" ? ids.indexOf(leader(session)?.id ?? -1) : -1;
  return of < 0 ? { by: "point" } : { by: "weight", of };
}
