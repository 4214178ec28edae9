/** The view of the shape and its control points; every edit that it makes is a command or a gesture of the history. */

import { Box3, type Quaternion, type Ray, Sphere, Vector2, Vector3 } from "three";
import type { SerializedBVH } from "three-mesh-bvh";
import { addPoint, type Box, type History, moveSelected, rotateSelected, select } from "../commands/index.ts";
import type { Constants } from "../model/handles.ts";
import { twinOf } from "../model/mirror.ts";
import { type ControlPoint, type Moves, selected, type Session, stays } from "../model/session.ts";
import type { Slot } from "../model/slot.ts";
import type { Vec3 } from "../model/vec3.ts";
import type { Tool, View } from "../model/view.ts";
import { type GlState, Kernel } from "../shader/kernel.ts";
import { FrameTimes } from "./frameTimes.ts";
import { Gizmo } from "./gizmo.ts";
import { type Marker, Markers } from "./markers.ts";
import type { Bound } from "./motion.ts";
import { type Hit, Picking } from "./picking.ts";
import { Pointer } from "./pointer.ts";
import type { Drawn } from "./shapeView.ts";
import { Sides } from "./sides.ts";
import { Space } from "./space.ts";
import { Stage } from "./stage.ts";

/** Pixels of a control point's disc. */
const MARKER_PIXELS = 17;
const THUMBNAIL = [208, 130] as const;

export class Viewport {
  readonly stage: Stage;
  readonly #history: History;
  readonly #markers = new Markers();
  readonly #gizmo: Gizmo;
  readonly #pointer: Pointer;
  readonly #times = new FrameTimes();
  readonly #sides: Sides;
  /** What rays meet, made when it is first asked for. */
  #picking: Partial<Record<Slot, Picking>> = {};
  #mesh: { index: Uint32Array; bvh: SerializedBVH } | undefined;
  #space = new Space({ centre: [0, 0, 0], half: 1 }, 3);
  #view: View;
  #stale = true;

  constructor(host: HTMLElement, history: History, view: View, constants: Constants) {
    this.#history = history;
    this.#view = view;
    this.stage = new Stage(host);
    const gl = this.stage.renderer.getContext() as WebGL2RenderingContext;
    this.#sides = new Sides(new Kernel(gl, constants, this.stage.renderer.state as GlState), this.stage, this.#space);
    this.stage.scene.add(this.#markers.object);
    this.#gizmo = new Gizmo(this.stage, this.stage.scene, {
      begin: () => history.begin("Move"),
      move: (map, rotation) => this.#drag((place) => this.#space.toFile(map(this.#space.toView(place))), rotation),
      end: () => history.commit(),
    });
    this.#pointer = new Pointer(this.stage, this.#gizmo, {
      markers: () => history.session.points.map((point) => this.#space.toView(placeOf(history.session, point, this.#view.moves))),
      boxes: () => this.#view.boxes,
      isSelected: (marker) => history.session.selection.includes(history.session.points[marker].id),
      meet: (ray, at, through) => this.#meet(ray, at, through),
      click: (hit) => this.#click(hit),
      select: (markers, mode) => {
        const ids = markers.map((marker) => history.session.points[marker].id);
        history.execute(select(ids, mode));
      },
      beginMove: () => history.begin("Move"),
      move: (by) => this.#drag((place) => this.#space.toFile(this.#space.toView(place).add(by))),
      beginAdd: () => history.begin("Add control point"),
      add: (hit) => history.preview((session) => addPoint(this.#placeOf(hit), this.#space.box).apply(session)),
      commit: () => history.commit(),
    });
    this.stage.startOrbit();
    this.stage.onFrame = () => this.#frame();
    this.stage.onDrawn = (start) => this.#times.tell(start, history.inGesture);
    history.subscribe(() => this.invalidate());
  }

  /** The shape's box in file units. */
  get box(): Box {
    return this.#space.box;
  }

  /** What is drawn of the shape, for exports. */
  get drawn(): Drawn | undefined {
    return this.#sides.drawn;
  }

  /** The weights that are shown, for exports. */
  get bound(): Bound | undefined {
    return this.#sides.bound;
  }

  /** Whether a drag is on its way. */
  get dragging(): boolean {
    return this.#gizmo.dragging || this.#pointer.busy;
  }

  /** Shows another shape. */
  setShape(drawn: Drawn, box: Box, dim: 1 | 2 | 3, mesh: { index: Uint32Array; bvh: SerializedBVH } | undefined): void {
    this.#space = new Space(box, dim);
    this.#gizmo.setDimension(dim);
    this.#pointer.step = this.#space.step;
    this.#sides.setShape(drawn, this.#space);
    this.#picking = {};
    this.#mesh = mesh;
    this.#home();
    this.invalidate();
  }

  /** Takes weights to the GPU. False where they are more than it holds. */
  setWeights(slot: Slot, bound: Bound | undefined): boolean {
    const fits = this.#sides.setWeights(slot, bound);
    this.invalidate();
    return fits;
  }

  /** Shows a frame that the core has computed, `y` (n x 3, file units) with its local maps (n x 9), where the GPU cannot. */
  showFrame(slot: Slot, y: Float64Array, maps: Float64Array): void {
    this.#sides.showFrame(slot, y, maps);
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
    const places = selected(this.#history.session).map((point) => this.#space.toView(point[this.#view.moves]));
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
    this.stage.draw();
    return this.#sides.readback();
  }

  /** Where a control point is seen, in pixels of the page. */
  screenOf(place: Vec3): { x: number; y: number } {
    const { left, top, width, height } = this.stage.pane.getBoundingClientRect();
    const { x, y } = this.#space.toView(place).project(this.stage.camera);
    return { x: left + ((x + 1) / 2) * width, y: top + ((1 - y) / 2) * height };
  }

  /** A small picture of the view, as the address of an image; "" before there is a shape. */
  thumbnail(): string {
    const { domElement } = this.stage.renderer;
    if (!this.drawn || domElement.width === 0) return "";
    const small = document.createElement("canvas");
    [small.width, small.height] = THUMBNAIL;
    const scale = Math.max(small.width / domElement.width, small.height / domElement.height);
    const [width, height] = [scale * domElement.width, scale * domElement.height];
    this.stage.draw(); // what is drawn can be read until the browser shows it
    small.getContext("2d")?.drawImage(domElement, (small.width - width) / 2, (small.height - height) / 2, width, height);
    return small.toDataURL("image/webp", 0.8);
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
    for (const picking of Object.values(this.#picking)) picking.invalidate();
    this.stage.request();
  }

  /** Whether the shape is shown as it was, because one asks for it or moves control points at rest. */
  get #atRest(): boolean {
    return this.#view.before || this.#view.moves === "position";
  }

  /** Looks at the shape, at rest and with the targets of its control points. */
  #home(): void {
    const positions = this.drawn?.rest.positions;
    if (!positions) return;
    const { min, max } = new Box3().setFromArray(positions);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
      (i) => new Vector3(i & 1 ? min.x : max.x, i & 2 ? min.y : max.y, i & 4 ? min.z : max.z),
    );
    const targets = this.#history.session.points.map((point) => this.#space.toView(point.target));
    this.stage.home([...corners, ...targets], this.#space.dim < 3);
  }

  #drag(to: (place: Vec3) => Vec3, rotation?: Quaternion): void {
    this.#history.preview((session) => {
      // One that is rotated stays in its place, to the last bit.
      const moved = rotation && session.selection.length === 1 ? session : moveSelected(session, this.#view.moves, to);
      if (!rotation || this.#view.moves !== "target") return moved;
      return rotateSelected(moved, [rotation.x, rotation.y, rotation.z, rotation.w]);
    });
  }

  #frame(gizmo = true): void {
    if (!this.#stale) return;
    this.#stale = false;
    const { session } = this.#history;
    this.#sides.update(session, this.#view, this.#atRest);
    this.#markers.setSize(MARKER_PIXELS, this.stage.renderer.getPixelRatio());
    this.#markers.update(this.#markersOf(session));
    if (gizmo && !this.#gizmo.dragging) this.#gizmo.place(this.#pivot(session), this.#tool(session));
  }

  /** What the gizmo does: there are things that one control point, one at rest, or one on a line cannot. */
  #tool({ selection }: Session): Tool {
    const { tool, moves } = this.#view;
    const can = selection.length > 1 || (tool === "rotate" && moves === "target");
    return can && (tool !== "rotate" || this.#space.dim > 1) ? tool : "translate";
  }

  #markersOf(session: Session): Marker[] {
    const chosen = new Set(session.selection);
    const twins = new Set(session.settings.mirror ? session.selection.map((id) => twinOf(session, id)) : []);
    const shown = this.#view.before ? "position" : this.#view.moves;
    return session.points.map((point, number) => ({
      rest: this.#space.toView(point.position),
      place: this.#space.toView(placeOf(session, point, shown)),
      number,
      selected: chosen.has(point.id),
      twin: twins.has(point.id),
      locked: point.locked,
      grouped: point.group !== undefined,
    }));
  }

  /** The middle of the selected control points that can be moved. */
  #pivot(session: Session): Vector3 | undefined {
    const free = selected(session).filter((point) => !stays(session, point));
    if (free.length === 0 || this.#view.before) return undefined;
    const sum = new Vector3();
    for (const point of free) sum.add(this.#space.toView(point[this.#view.moves]));
    return sum.divideScalar(free.length);
  }

  #meet(ray: Ray, at: Vector2, through: boolean): Hit | undefined {
    if (!this.drawn) return undefined;
    const { clientWidth, clientHeight } = this.stage.pane;
    const slot = this.stage.onRight ? "comparison" : "main";
    const picking = (this.#picking[slot] ??= new Picking(this.drawn.rest.positions, () => this.#sides.read(slot), this.#mesh));
    return picking.meet(ray, through) ?? picking.nearest(at, new Vector2(clientWidth, clientHeight), this.stage.camera);
  }

  #click(hit: Hit | undefined): void {
    if (hit && this.#view.adding) this.#history.execute(addPoint(this.#placeOf(hit), this.#space.box));
    else this.#history.execute(select([]));
  }

  #placeOf({ rest, shown }: Hit): { position: Vec3; target: Vec3 } {
    const position = this.#space.toFile(rest);
    return { position, target: rest.distanceTo(shown) < 1e-6 ? position : this.#space.toFile(shown) };
  }

  #showSide(right: boolean): void {
    // What one drags by is on the side that takes the pointer.
    this.#gizmo.visible = right === this.stage.onRight;
    this.#sides.show(right ? "comparison" : "main");
  }
}

/** Where a control point is shown: what is held stays at rest. */
const placeOf = (session: Session, point: ControlPoint, moves: Moves): Vec3 => (stays(session, point) ? point.position : point[moves]);
