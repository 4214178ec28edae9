/** The shape as it is shown: once, or with other weights beside it. */

import type { Session } from "../model/session.ts";
import type { Slot } from "../model/slot.ts";
import type { View } from "../model/view.ts";
import type { Kernel, RestVertices } from "../shader/kernel.ts";
import { colourOf } from "./markers.ts";
import { type Bound, Motions } from "./motion.ts";
import { type Drawn, ShapeView } from "./shapeView.ts";
import type { Space } from "./space.ts";
import type { Stage } from "./stage.ts";
import { turnedBy } from "./turned.ts";

interface Side {
  view: ShapeView;
  motions: Motions | undefined;
  /** Vertices as the core has computed them. */
  frame?: Pick<RestVertices, "positions" | "normals">;
}

export class Sides {
  readonly #kernel: Kernel;
  readonly #stage: Stage;
  #sides: Partial<Record<Slot, Side>> = {};
  #space: Space;

  constructor(kernel: Kernel, stage: Stage, space: Space) {
    [this.#kernel, this.#stage, this.#space] = [kernel, stage, space];
  }

  /** What is drawn of the shape. */
  get drawn(): Drawn | undefined {
    return this.#sides.main?.view.drawn;
  }

  /** The weights that are shown. */
  get bound(): Bound | undefined {
    return this.#sides.main?.motions?.bound;
  }

  setShape(drawn: Drawn, space: Space): void {
    this.#remove("comparison");
    this.#remove("main");
    this.#space = space;
    this.#add("main", drawn);
  }

  /** Takes weights to the GPU. False where they are more than it holds. */
  setWeights(slot: Slot, bound: Bound | undefined): boolean {
    const { main } = this.#sides;
    if (!main) return true;
    if (!bound) {
      if (slot === "comparison") this.#remove("comparison");
      else {
        main.motions = undefined;
        delete main.frame;
        main.view.bound.show(main.view.drawn.rest);
      }
      return true;
    }
    const side = this.#sides[slot] ?? this.#add(slot, main.view.drawn);
    const colours = new Float32Array(bound.ids.flatMap((_, i) => colourOf(i)));
    const fits = side.view.bound.setLogits(bound.logits, bound.ids.length, colours);
    side.motions = fits ? new Motions(bound, this.#space) : undefined;
    return fits;
  }

  /** Shows a frame that the core has computed, `y` (n x 3, file units) with its local maps (n x 9), where the GPU cannot. */
  showFrame(slot: Slot, y: Float64Array, maps: Float64Array): void {
    const side = this.#sides[slot];
    if (!side) return;
    const { centre, half } = this.#space.box;
    const { points, normals } = side.view.drawn.rest;
    const places = new Float32Array(3 * points.length);
    for (let i = 0; i < points.length; i++) {
      for (let c = 0; c < 3; c++) places[3 * i + c] = (y[3 * points[i] + c] - centre[c]) / half;
    }
    side.frame = { positions: places, normals: turnedBy(maps, points, normals) };
  }

  /** Computes what is shown of a session. `atRest`: as it was. */
  update(session: Session, view: View, atRest: boolean): void {
    for (const slot of ["main", "comparison"] as const) {
      const side = this.#sides[slot];
      if (!side) continue;
      if (side.motions && session.settings.relax === 0) delete side.frame;
      const frame = atRest ? undefined : side.frame;
      // The GPU has the colours of what the core computes, too.
      if (side.motions && !(frame && view.colouring === "material")) {
        side.view.deform(side.motions.of(session, { atRest, colouring: view.colouring }));
      }
      if (frame) side.view.bound.show(frame);
      else if (!side.motions && side.frame) side.view.bound.show(side.view.drawn.rest);
      side.view.show(side.motions ? view.colouring : "material", view.wireframe);
    }
  }

  /** Which of the two is drawn next. */
  show(slot: Slot): void {
    const { main, comparison } = this.#sides;
    if (main) main.view.object.visible = slot === "main" || !comparison;
    if (comparison) comparison.view.object.visible = slot === "comparison";
  }

  /** The vertices as the GPU has them, relative to the shape's box. */
  read(slot: Slot): Float32Array<ArrayBuffer> {
    const side = this.#sides[slot] ?? this.#sides.main;
    return side ? side.view.bound.read() : new Float32Array(0);
  }

  /** The deformed places as the GPU has them, in file units, one for each point of the shape. */
  readback(): Float64Array | undefined {
    const { drawn } = this;
    if (!drawn) return undefined;
    const { centre, half } = this.#space.box;
    const places = this.read("main");
    const { points } = drawn.rest;
    const count = points.reduce((most, point) => Math.max(most, point + 1), 0);
    const read = new Float64Array(3 * count).fill(Number.NaN);
    points.forEach((point, i) => {
      for (let c = 0; c < 3; c++) read[3 * point + c] = centre[c] + half * places[3 * i + c];
    });
    return read;
  }

  #add(slot: Slot, drawn: Drawn): Side {
    const view = new ShapeView(this.#kernel, drawn);
    const side: Side = { view, motions: undefined };
    this.#sides[slot] = side;
    (drawn.index ? this.#stage.scene : this.#stage.clouds.scene).add(view.object);
    view.object.visible = slot === "main";
    return side;
  }

  #remove(slot: Slot): void {
    const shown = this.#sides[slot];
    if (!shown) return;
    shown.view.object.removeFromParent();
    shown.view.dispose();
    delete this.#sides[slot];
  }
}
