/** The view of the shape and its control points; every edit that it makes is a command or a gesture of the history. */

import { Box3, Matrix3, type Quaternion, type Ray, Sphere, Vector2, Vector3 } from "three";
import type { SerializedBVH } from "three-mesh-bvh";
import { addPoint, type Box, type History, moveSelected, select, turnSelected } from "../commands/index.ts";
import type { Handles } from "../model/handles.ts";
import { twinOf } from "../model/mirror.ts";
import { leader, type PointId, selected, type Session } from "../model/session.ts";
import type { Slot } from "../model/slot.ts";
import { turnsOf } from "../model/turn.ts";
import type { Vec3 } from "../model/vec3.ts";
import type { Tool, View } from "../model/view.ts";
import { type GlState, type GpuMotion, Kernel, type RestVertices } from "../shader/kernel.ts";
import { turnedPoints } from "../shader/turned.ts";
import { FrameTimes } from "./frameTimes.ts";
import { Gizmo } from "./gizmo.ts";
import { colourOf, type Marker, Markers } from "./markers.ts";
import { type Hit, Picking } from "./picking.ts";
import { Pointer } from "./pointer.ts";
import { type Drawn, ShapeView } from "./shapeView.ts";
import { Stage } from "./stage.ts";

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

/** Vertices as the core has computed them. */
type Frame = Pick<RestVertices, "positions" | "normals">;

/** Pixels of a control point's disc. */
const MARKER_PIXELS = 17;

export class Viewport {
  readonly stage: Stage;
  readonly #kernel: Kernel;
  readonly #history: History;
  readonly #markers = new Markers();
  readonly #gizmo: Gizmo;
  readonly #pointer: Pointer;
  readonly #times = new FrameTimes();
  readonly #sides: Partial<Record<Slot, { view: ShapeView; bound: Bound | undefined; frame?: Frame }>> = {};
  #picking: Picking | undefined;
  #box: Box = { centre: [0, 0, 0], half: 1 };
  #dim: 1 | 2 | 3 = 3;
  #view: View;
  #stale = true;

  constructor(host: HTMLElement, history: History, view: View) {
    this.#history = history;
    this.#view = view;
    this.stage = new Stage(host);
    const gl = this.stage.renderer.getContext() as WebGL2RenderingContext;
    this.#kernel = new Kernel(gl, this.stage.renderer.state as GlState);
    this.stage.scene.add(this.#markers.object);
    this.#gizmo = new Gizmo(this.stage, this.stage.scene, {
      begin: () => history.begin("Move"),
      move: (map, turn) => this.#drag((place) => this.#toFile(map(this.#toView(place))), turn),
      end: () => history.commit(),
    });
    this.#pointer = new Pointer(this.stage, this.#gizmo, {
      markers: () => history.session.points.map((point) => this.#toView(point[this.#view.moves])),
      boxes: () => this.#view.boxes,
      isSelected: (marker) => history.session.selection.includes(history.session.points[marker].id),
      meet: (ray, at, through) => this.#meet(ray, at, through),
      click: (hit) => this.#click(hit),
      select: (markers, mode) => {
        const ids = markers.map((marker) => history.session.points[marker].id);
        history.execute(select(ids, mode));
      },
      beginMove: () => history.begin("Move"),
      move: (by) => this.#drag((place) => this.#toFile(this.#toView(place).add(by))),
      beginAdd: () => history.begin("Add control point"),
      add: (hit) => history.preview((session) => addPoint(this.#placeOf(hit), this.#box).apply(session)),
      commit: () => history.commit(),
    });
    this.stage.startOrbit();
    this.stage.onFrame = () => this.#frame();
    this.stage.onDrawn = (start) => this.#times.tell(start, history.inGesture);
    history.subscribe(() => this.invalidate());
  }

  /** The shape's box in file units. */
  get box(): Box {
    return this.#box;
  }

  /** What is drawn of the shape, for exports. */
  get drawn(): Drawn | undefined {
    return this.#sides.main?.view.drawn;
  }

  /** The weights that are shown, for exports. */
  get bound(): Bound | undefined {
    return this.#sides.main?.bound;
  }

  /** Whether a drag is on its way. */
  get dragging(): boolean {
    return this.#gizmo.dragging || this.#pointer.busy;
  }

  /** Shows another shape. */
  setShape(drawn: Drawn, box: Box, dim: 1 | 2 | 3, mesh: { index: Uint32Array; bvh: SerializedBVH } | undefined): void {
    this.#remove("comparison");
    this.#remove("main");
    this.#box = box;
    this.#dim = dim;
    this.#gizmo.setDimension(dim);
    this.#pointer.step = niceStep(box.half / 20) / box.half;
    const view = this.#add("main", drawn);
    this.#picking = new Picking(drawn.rest.positions, () => view.bound.read(), mesh);
    this.#home();
    this.invalidate();
  }

  /** Takes weights to the GPU. False where they are more than it holds. */
  setWeights(side: Slot, bound: Bound | undefined): boolean {
    const main = this.#sides.main;
    if (!main) return true;
    if (!bound) {
      if (side === "comparison") this.#remove("comparison");
      else {
        main.bound = undefined;
        delete main.frame;
        main.view.bound.show(main.view.drawn.rest);
      }
      this.invalidate();
      return true;
    }
    if (!this.#sides[side]) this.#add(side, main.view.drawn);
    const shown = this.#sides[side];
    if (!shown) return true;
    const colours = new Float32Array(bound.ids.flatMap((_, i) => colourOf(i)));
    const fits = shown.view.bound.setLogits(bound.logits, bound.ids.length, colours);
    shown.bound = fits ? bound : undefined;
    delete shown.frame;
    this.invalidate();
    return fits;
  }

  /** Shows a frame that the core has computed, `y` (n x 3, file units) with its local maps (n x 9), where the GPU cannot. */
  showFrame(y: Float64Array, maps: Float64Array): void {
    const main = this.#sides.main;
    if (!main) return;
    const { points, normals } = main.view.drawn.rest;
    const places = new Float32Array(3 * points.length);
    const turned = new Float32Array(3 * points.length);
    points.forEach((point, i) => {
      const map = new Matrix3().fromArray(maps, 9 * point);
      const side = Math.sign(map.determinant()); // of the winding, even under a reflection
      map.invert(); // read by columns: the inverse transpose, row by row
      const normal = new Vector3().fromArray(normals, 3 * i).applyMatrix3(map).normalize().multiplyScalar(side);
      normal.toArray(turned, 3 * i);
      for (let c = 0; c < 3; c++) places[3 * i + c] = (y[3 * point + c] - this.#box.centre[c]) / this.#box.half;
    });
    main.frame = { positions: places, normals: turned };
    this.invalidate();
  }

  setView(view: View): void {
    const split = view.comparison;
    this.#view = view;
    this.stage.turns = !view.boxes;
    if (split !== this.stage.split) {
      this.stage.showRight = split ? (right) => this.#showSide(right) : undefined;
      if (!split) this.#showSide(false);
      this.stage.resize();
    }
    this.invalidate();
  }

  /** Shows all of the shape, or the selected control points. */
  focus(what: "all" | "selection"): void {
    const places = selected(this.#history.session).map((point) => this.#toView(point[this.#view.moves]));
    if (what === "all" || places.length === 0) return this.#home();
    const sphere = new Sphere().setFromPoints(places);
    sphere.radius = Math.max(sphere.radius * 1.6, 0.35);
    this.stage.focus(sphere);
  }

  /** Ends a drag as if it had not been. Returns whether there was one. */
  cancel(): boolean {
    if (!this.dragging) return false;
    this.#history.cancel();
    this.#gizmo.cancel();
    this.#pointer.cancel();
    this.invalidate();
    return true;
  }

  /** The deformed places as the GPU has them, in file units, one for each point of the shape. For tests. */
  readback(): Float64Array | undefined {
    const main = this.#sides.main;
    if (!main) return undefined;
    this.stage.draw();
    const places = main.view.bound.read();
    const { points } = main.view.drawn.rest;
    const count = points.reduce((most, point) => Math.max(most, point + 1), 0);
    const read = new Float64Array(3 * count).fill(Number.NaN);
    points.forEach((point, i) => {
      for (let c = 0; c < 3; c++) read[3 * point + c] = this.#box.centre[c] + this.#box.half * places[3 * i + c];
    });
    return read;
  }

  /** Where a control point is seen, in pixels of the page. */
  screenOf(place: Vec3): { x: number; y: number } {
    const { left, top, width, height } = this.stage.pane.getBoundingClientRect();
    const { x, y } = this.#toView(place).project(this.stage.camera);
    return { x: left + ((x + 1) / 2) * width, y: top + ((1 - y) / 2) * height };
  }

  /** A picture of the view, without its markers. */
  picture(): Promise<Blob> {
    this.#markers.object.visible = false;
    this.#gizmo.place(undefined, this.#view.tool);
    this.#frame(false);
    this.stage.draw();
    return new Promise((resolve, reject) => {
      this.stage.renderer.domElement.toBlob((blob) => {
        this.#markers.object.visible = true;
        this.invalidate();
        if (blob) resolve(blob);
        else reject(new Error("The browser could not make a picture of the view."));
      });
    });
  }

  /** Something that is shown has changed. */
  invalidate(): void {
    this.#stale = true;
    this.#picking?.invalidate();
    this.stage.request();
  }

  /** Whether the shape is shown as it was, because one asks for it or moves control points at rest. */
  get #atRest(): boolean {
    return this.#view.before || this.#view.moves === "position";
  }

  /** Looks at the shape, at rest and with the targets of its control points. */
  #home(): void {
    const positions = this.#sides.main?.view.drawn.rest.positions;
    if (!positions) return;
    const { min, max } = new Box3().setFromArray(positions);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
      (i) => new Vector3(i & 1 ? min.x : max.x, i & 2 ? min.y : max.y, i & 4 ? min.z : max.z),
    );
    const targets = this.#history.session.points.map((point) => this.#toView(point.target));
    this.stage.home([...corners, ...targets], this.#dim < 3);
  }

  #drag(to: (place: Vec3) => Vec3, turn?: Quaternion): void {
    this.#history.preview((session) => {
      // One that is turned stays in its place, to the last bit.
      const moved = turn && session.selection.length === 1 ? session : moveSelected(session, this.#view.moves, to);
      return turn && this.#view.moves === "target" ? turnSelected(moved, [turn.x, turn.y, turn.z, turn.w]) : moved;
    });
  }

  #frame(gizmo = true): void {
    if (!this.#stale) return;
    this.#stale = false;
    const { session } = this.#history;
    for (const side of Object.values(this.#sides)) {
      const motion = side.bound && this.#motion(side.bound, session);
      if (motion) side.view.deform(motion);
      else if (side.frame) side.view.bound.show(this.#atRest ? side.view.drawn.rest : side.frame);
      side.view.show(side.bound ? this.#view.colouring : "material", this.#view.wireframe);
    }
    this.#markers.setSize(MARKER_PIXELS, this.stage.renderer.getPixelRatio());
    this.#markers.update(this.#markersOf(session));
    if (gizmo) this.#gizmo.place(this.#pivot(session), this.#tool(session));
  }

  /** What the gizmo does: there are things that one control point, one at rest, or one on a line cannot. */
  #tool({ selection }: Session): Tool {
    const { tool, moves } = this.#view;
    const can = selection.length > 1 || (tool === "rotate" && moves === "target");
    return can && (tool !== "rotate" || this.#dim > 1) ? tool : "translate";
  }

  /** Weights that are still being fitted: what was bound last moves as far as its control points are still there. */
  #motion({ ids, p, handles }: Bound, session: Session): GpuMotion {
    const { transform, temperature } = session.settings;
    const { centre, half } = this.#box;
    const enter = (coordinate: number, at: number): number => (coordinate - centre[at % 3]) / half;
    const targets = p.slice();
    if (!this.#atRest) {
      const byId = new Map(session.points.map((point) => [point.id, point]));
      ids.forEach((id, i) => {
        const point = byId.get(id);
        if (!point) return;
        for (let c = 0; c < 3; c++) {
          // Bit for bit where it is not moved.
          const moved = point.target[c] !== point.position[c];
          if (moved) targets[3 * i + c] += point.target[c] - point.position[c];
        }
      });
    }
    const at = this.#view.colouring === "weight" ? ids.indexOf(leader(session)?.id ?? -1) : -1;
    const tint =
      this.#view.colouring === "points" || (this.#view.colouring === "weight" && at < 0)
        ? ({ by: "point" } as const)
        : at >= 0
          ? ({ by: "weight", of: at } as const)
          : ({ by: "nothing" } as const);
    const turns = new Map(session.points.map((point) => [point.id, this.#atRest ? undefined : point.turn]));
    const turn = ids.map((id) => turns.get(id));
    const aimed = handles.aim(targets, { ...session.settings, ...turnsOf(turn) });
    const places = p.map(enter);
    const turned = turnedPoints(places, turn);
    return { p: places, q: aimed.map(enter), turned, transform, temperature, tint };
  }

  #markersOf(session: Session): Marker[] {
    const chosen = new Set(session.selection);
    const twins = new Set(session.settings.mirror ? session.selection.map((id) => twinOf(session, id)) : []);
    const shown = this.#view.before ? "position" : this.#view.moves;
    return session.points.map((point, number) => ({
      rest: this.#toView(point.position).toArray(),
      place: this.#toView(point[shown]).toArray(),
      number,
      selected: chosen.has(point.id),
      twin: twins.has(point.id),
      locked: point.locked,
    }));
  }

  /** The middle of the selected control points that can be moved. */
  #pivot(session: Session): Vector3 | undefined {
    const free = selected(session).filter((point) => !point.locked);
    if (free.length === 0 || this.#view.before) return undefined;
    const sum = new Vector3();
    for (const point of free) sum.add(this.#toView(point[this.#view.moves]));
    return sum.divideScalar(free.length);
  }

  #meet(ray: Ray, at: Vector2, through: boolean): Hit | undefined {
    const { clientWidth, clientHeight } = this.stage.pane;
    return (
      this.#picking?.meet(ray, through) ??
      this.#picking?.nearest(at, new Vector2(clientWidth, clientHeight), this.stage.camera)
    );
  }

  #click(hit: Hit | undefined): void {
    if (hit && this.#view.adding) this.#history.execute(addPoint(this.#placeOf(hit), this.#box));
    else this.#history.execute(select([]));
  }

  #placeOf({ rest, shown }: Hit): { position: Vec3; target: Vec3 } {
    const position = this.#toFile(rest);
    return { position, target: rest.distanceTo(shown) < 1e-6 ? position : this.#toFile(shown) };
  }

  #add(side: Slot, drawn: Drawn): ShapeView {
    const view = new ShapeView(this.#kernel, drawn);
    this.#sides[side] = { view, bound: undefined };
    (drawn.index ? this.stage.scene : this.stage.clouds.scene).add(view.object);
    view.object.visible = side === "main";
    return view;
  }

  #remove(side: Slot): void {
    const shown = this.#sides[side];
    if (!shown) return;
    shown.view.object.removeFromParent();
    shown.view.dispose();
    delete this.#sides[side];
  }

  #showSide(right: boolean): void {
    const { main, comparison } = this.#sides;
    // What one drags by is on the side that takes the pointer.
    this.#gizmo.visible = !right;
    if (main) main.view.object.visible = !right || !comparison;
    if (comparison) comparison.view.object.visible = right;
  }

  #toView(place: Vec3): Vector3 {
    const { centre, half } = this.#box;
    return new Vector3(...place.map((c, at) => (c - centre[at]) / half));
  }

  #toFile(place: Vector3): Vec3 {
    const { centre, half } = this.#box;
    const y = this.#dim > 1 ? centre[1] + half * place.y : 0;
    const z = this.#dim > 2 ? centre[2] + half * place.z : 0;
    return [centre[0] + half * place.x, y, z];
  }
}

/** The next smaller of 1, 2 or 5 times a power of ten. */
function niceStep(size: number): number {
  const power = 10 ** Math.floor(Math.log10(size));
  return power * (size / power >= 5 ? 5 : size / power >= 2 ? 2 : 1);
}
