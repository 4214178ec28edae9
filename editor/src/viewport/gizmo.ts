/** The gizmo: moves, rotates or scales the selected control points along axes, in planes and freely. */

import { Group, type Matrix4, Object3D, type Quaternion, type Scene, Vector3 } from "three";
import { TransformControls } from "three/addons/controls/TransformControls.js";
import type { Tool } from "../model/view.ts";
import { AXIS_COLOURS, AxisLines } from "./axisLines.ts";
import type { Stage } from "./stage.ts";

export interface GizmoEvents {
  begin(): void;
  /** How places (relative to the shape's box) move, from those with which the drag began, and how they rotate, if they do. */
  move(map: (place: Vector3) => Vector3, rotation: Quaternion | undefined): void;
  end(): void;
}

export class Gizmo {
  readonly #controls: TransformControls;
  readonly #scene: Scene;
  readonly #shown = new Group();
  readonly #proxy = new Object3D();
  readonly #lines = new AxisLines();
  readonly #start = new Vector3();
  #dim: 1 | 2 | 3 = 3;
  /** Steps that translations keep to, relative to the shape's box; 0: none. */
  snap = 0;

  constructor(stage: Stage, scene: Scene, events: GizmoEvents) {
    this.#scene = scene;
    this.#controls = new TransformControls(stage.camera, stage.pane);
    this.#controls.setSize(0.78);
    this.#controls.setColors(AXIS_COLOURS.X, AXIS_COLOURS.Y, AXIS_COLOURS.Z, 0xffb020);
    this.#shown.add(this.#controls.getHelper());
    scene.add(this.#proxy, this.#shown, this.#lines.object);
    this.#controls.addEventListener("change", () => stage.request());
    this.#controls.addEventListener("dragging-changed", ({ value }) => {
      stage.orbit.enabled = !value;
      this.#show(!value);
      if (!value) this.#lines.hide();
    });
    this.#controls.addEventListener("mouseDown", () => {
      this.#start.copy(this.#proxy.position);
      this.#lines.show(this.#controls.axis ?? "", this.#start);
      events.begin();
    });
    this.#controls.addEventListener("objectChange", () => {
      events.move(this.#map(), this.#controls.mode === "rotate" ? this.#proxy.quaternion : undefined);
      this.#lines.moveTo(this.#proxy.position);
    });
    this.#controls.addEventListener("mouseUp", () => {
      events.end();
      this.#settle();
    });
  }

  /** Only the axes that the shape has. */
  setDimension(dim: 1 | 2 | 3): void {
    this.#dim = dim;
    this.#showAxes();
  }

  /** A control point in the plane rotates about z alone. */
  #showAxes(): void {
    const [dim, rotates] = [this.#dim, this.#controls.mode === "rotate"];
    const axes = { showX: dim > 2 || !rotates, showY: dim > 2 || (dim > 1 && !rotates), showZ: dim > 2 || (dim > 1 && rotates) };
    Object.assign(this.#controls, { ...axes, showXY: dim > 1, showYZ: dim > 2, showXZ: dim > 2 });
  }

  get dragging(): boolean {
    return this.#controls.dragging;
  }

  /** Whether the pointer is over one of its handles. */
  get hovered(): boolean {
    return this.#controls.axis !== null;
  }

  set visible(visible: boolean) {
    this.#shown.visible = visible;
  }

  /** Neither seen nor asked where the pointer is, for as long as something else is dragged. */
  set away(away: boolean) {
    this.#controls.enabled = !away;
    this.#show(!away);
  }

  /** While something is dragged it is the shape that one looks at, and a frame is to be quick. */
  #show(shown: boolean): void {
    if (shown) this.#scene.add(this.#shown);
    else this.#shown.removeFromParent();
  }

  /** Puts the gizmo at a place, or takes it away. Not during its own drag. */
  place(at: Vector3 | undefined, tool: Tool): void {
    if (this.dragging) return;
    if (!at) {
      this.#controls.detach();
      return;
    }
    this.#proxy.position.copy(at);
    if (this.#controls.mode !== tool) {
      this.#controls.setMode(tool);
      this.#showAxes();
    }
    if (!this.#controls.object) this.#controls.attach(this.#proxy);
  }

  /** Ends the drag; what it did is taken back by who listens. */
  cancel(): void {
    if (!this.dragging) return;
    this.#controls.reset();
    this.#controls.pointerUp({ button: 0 } as PointerEvent);
    this.#settle();
  }

  #settle(): void {
    this.#proxy.quaternion.identity();
    this.#proxy.scale.set(1, 1, 1);
  }

  #map(): (place: Vector3) => Vector3 {
    if (this.#controls.mode === "translate") {
      const by = snapped(this.#proxy.position.clone().sub(this.#start), this.snap);
      this.#proxy.position.copy(this.#start).add(by);
      return (place) => place.clone().add(by);
    }
    this.#proxy.updateMatrix();
    const pivot = this.#start;
    const matrix: Matrix4 = this.#proxy.matrix.clone().setPosition(0, 0, 0);
    return (place) => place.clone().sub(pivot).applyMatrix4(matrix).add(pivot);
  }
}

/** A displacement in whole steps along each axis. */
export function snapped(by: Vector3, step: number): Vector3 {
  return step > 0 ? by.divideScalar(step).round().multiplyScalar(step) : by;
}
