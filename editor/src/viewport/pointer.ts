/**
 * What the pointer does on the shape: a click adds or selects, a drag of a marker moves freely, Shift and drag (or a drag
 * alone, where boxes are chosen) selects a box, Alt adds at a chosen depth. All else is left to the camera.
 */

import { type Camera, Plane, Ray, Raycaster, Vector2, Vector3 } from "three";
import type { Gizmo } from "./gizmo.ts";
import { snapped } from "./gizmo.ts";
import type { Hit } from "./picking.ts";
import type { Stage } from "./stage.ts";

/** What the pointer asks for. Markers by their place in the list. */
export interface PointerEvents {
  /** The markers as they are shown, relative to the shape's box. */
  markers(): readonly Vector3[];
  /** Whether a drag beside the markers selects in a box without Shift, which fingers do not have. */
  boxes(): boolean;
  isSelected(marker: number): boolean;
  meet(ray: Ray, at: Vector2, through: boolean): Hit | undefined;
  click(hit: Hit | undefined): void;
  select(markers: number[], mode: "replace" | "add" | "toggle"): void;
  beginMove(marker: number): void;
  move(by: Vector3): void;
  beginAdd(): void;
  add(hit: Hit): void;
  commit(): void;
}

type Action =
  | { kind: "press"; marker: number }
  | { kind: "move"; plane: Plane; from: Vector3 }
  | { kind: "box" }
  | { kind: "depth"; hit: Hit; ray: Ray }
  | { kind: "click" };

/** Farther than this, in pixels, a press is a drag. */
const STILL = 4;
/** How near to a marker the pointer must be, in pixels: mouse or pen, finger. */
const REACH = { fine: 11, finger: 24 };

export class Pointer {
  /** Steps of a free drag while Ctrl is held, relative to the shape's box. */
  step = 0;
  readonly #stage: Stage;
  readonly #gizmo: Gizmo;
  readonly #events: PointerEvents;
  readonly #box = document.createElement("div");
  readonly #caster = new Raycaster();
  readonly #from = new Vector2();
  /** Where the pane is: asked when something begins, for the answer may ask for a layout. */
  #pane = new DOMRect(0, 0, 1, 1);
  #action: Action | undefined;

  constructor(stage: Stage, gizmo: Gizmo, events: PointerEvents) {
    [this.#stage, this.#gizmo, this.#events] = [stage, gizmo, events];
    this.#box.className = "selection-box";
    this.#box.hidden = true;
    stage.pane.append(this.#box);
    stage.pane.addEventListener("pointerdown", (event) => this.#down(event));
    stage.pane.addEventListener("pointermove", (event) => this.#moved(event));
    stage.pane.addEventListener("pointerup", (event) => this.#up(event));
    stage.pane.addEventListener("pointercancel", () => this.cancel());
  }

  get busy(): boolean {
    return this.#action !== undefined && this.#action.kind !== "click";
  }

  /** Forgets what was begun. */
  cancel(): void {
    this.#end();
  }

  #down(event: PointerEvent): void {
    if (this.#gizmo.dragging || !event.isPrimary) {
      // A second finger: the camera's.
      if (!this.#gizmo.dragging) this.#end();
      return;
    }
    if (event.button !== 0) return;
    this.#pane = this.#stage.pane.getBoundingClientRect();
    this.#from.copy(this.#at(event));
    const marker = this.#markerAt(event);
    if (marker >= 0) this.#action = { kind: "press", marker };
    else if (event.shiftKey || this.#events.boxes()) this.#action = { kind: "box" };
    else if (event.altKey) this.#beginDepth(event);
    else this.#action = { kind: "click" };
    // A second finger is the camera's, so that it knows of the first.
    this.#stage.orbit.enabled = this.#action?.kind === "click" || (this.#action?.kind === "box" && !event.shiftKey);
  }

  #moved(event: PointerEvent): void {
    this.#gizmo.snap = event.ctrlKey || event.metaKey ? this.step : 0;
    if (!this.#action) {
      if (event.pointerType === "mouse" && event.buttons === 0) {
        this.#pane = this.#stage.pane.getBoundingClientRect();
        const over = this.#gizmo.hovered || this.#markerAt(event) >= 0;
        this.#stage.pane.classList.toggle("over-marker", over);
      }
      return;
    }
    const away = this.#at(event).distanceTo(this.#from);
    if (this.#action.kind === "press" && away > STILL) this.#beginMove(this.#action.marker);
    if (this.#action.kind === "move") {
      const to = this.#ray(event).intersectPlane(this.#action.plane, new Vector3());
      if (to) this.#events.move(snapped(to.sub(this.#action.from), this.#gizmo.snap));
    } else if (this.#action.kind === "depth") {
      this.#events.add(this.#atDepth(this.#action, event));
    } else if (this.#action.kind === "box" && away > STILL) {
      this.#showBox(this.#at(event));
    }
  }

  #up(event: PointerEvent): void {
    const action = this.#action;
    if (!action) return;
    const still = this.#at(event).distanceTo(this.#from) <= STILL;
    this.#end();
    if (action.kind === "press") {
      const several = event.shiftKey || event.ctrlKey || event.metaKey || this.#events.boxes();
      this.#events.select([action.marker], several ? "toggle" : "replace");
    } else if (action.kind === "move" || action.kind === "depth") {
      this.#events.commit();
    } else if (action.kind === "box" && !still) {
      this.#events.select(this.#markersInBox(this.#at(event)), "add");
    } else if (action.kind === "box" && !event.shiftKey) {
      this.#events.click(undefined);
    } else if (action.kind === "click" && still) {
      this.#events.click(this.#events.meet(this.#ray(event), this.#at(event), false));
    }
  }

  #end(): void {
    this.#action = undefined;
    this.#box.hidden = true;
    this.#stage.orbit.enabled = true;
    this.#gizmo.away = false;
  }

  #beginMove(marker: number): void {
    if (!this.#events.isSelected(marker)) this.#events.select([marker], "replace");
    const from = this.#events.markers()[marker].clone();
    const ray = this.#rayAt(this.#from);
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.#stage.camera.getWorldDirection(new Vector3()), from);
    const grip = ray.intersectPlane(plane, new Vector3()) ?? from;
    this.#action = { kind: "move", plane, from: grip };
    this.#gizmo.away = true;
    this.#events.beginMove(marker);
  }

  /** Between where the ray enters and where it leaves the shape; off the shape on a plane through what is looked at. */
  #beginDepth(event: PointerEvent): void {
    const ray = this.#ray(event);
    let hit = this.#events.meet(ray, this.#at(event), true);
    if (!hit) {
      const direction = this.#stage.camera.getWorldDirection(new Vector3());
      const plane = new Plane().setFromNormalAndCoplanarPoint(direction, this.#stage.orbit.target);
      const at = ray.intersectPlane(plane, new Vector3());
      if (!at) return;
      hit = { rest: at, shown: at.clone() };
    }
    this.#action = { kind: "depth", hit, ray: ray.clone() };
    this.#events.beginAdd();
    this.#events.add(hit);
  }

  /** Up is farther away: a quarter of the window is half of the shape's size. */
  #atDepth({ hit, ray }: { hit: Hit; ray: Ray }, event: PointerEvent): Hit {
    const deeper = (4 * (this.#from.y - this.#at(event).y)) / this.#pane.height;
    const by = ray.direction.clone().multiplyScalar(deeper);
    return { rest: hit.rest.clone().add(by), shown: hit.shown.clone().add(by) };
  }

  #at(event: PointerEvent): Vector2 {
    return new Vector2(event.clientX - this.#pane.left, event.clientY - this.#pane.top);
  }

  #ray(event: PointerEvent): Ray {
    return this.#rayAt(this.#at(event));
  }

  #rayAt(at: Vector2): Ray {
    const { width, height } = this.#pane;
    const ndc = new Vector2((at.x / width) * 2 - 1, 1 - (at.y / height) * 2);
    this.#caster.setFromCamera(ndc, this.#stage.camera);
    return this.#caster.ray;
  }

  #markerAt(event: PointerEvent): number {
    const at = this.#at(event);
    let [best, nearest] = [-1, event.pointerType === "touch" ? REACH.finger : REACH.fine];
    this.#events.markers().forEach((place, i) => {
      const away = this.#onScreen(place).distanceTo(at);
      if (away < nearest) [best, nearest] = [i, away];
    });
    return best;
  }

  #markersInBox(to: Vector2): number[] {
    const [low, high] = [this.#from.clone().min(to), this.#from.clone().max(to)];
    return this.#events.markers().flatMap((place, i) => {
      const at = this.#onScreen(place);
      return at.x >= low.x && at.x <= high.x && at.y >= low.y && at.y <= high.y ? [i] : [];
    });
  }

  #onScreen(place: Vector3): Vector2 {
    return toScreen(place, this.#stage.camera, this.#pane.width, this.#pane.height);
  }

  #showBox(to: Vector2): void {
    const [low, high] = [this.#from.clone().min(to), this.#from.clone().max(to)];
    this.#box.hidden = false;
    Object.assign(this.#box.style, {
      left: `${low.x}px`,
      top: `${low.y}px`,
      width: `${high.x - low.x}px`,
      height: `${high.y - low.y}px`,
    });
  }
}

/** Where a place is seen, in pixels from the upper left; far away where it is behind the eye. */
function toScreen(place: Vector3, camera: Camera, width: number, height: number): Vector2 {
  const { x, y, z } = place.clone().project(camera);
  return z > 1 ? new Vector2(1e9, 1e9) : new Vector2(((x + 1) / 2) * width, ((1 - y) / 2) * height);
}
