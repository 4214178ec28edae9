/** Camera, lights and the drawing surface; draws when something has changed, not otherwise. */

import {
  Box3,
  DirectionalLight,
  HemisphereLight,
  MOUSE,
  PerspectiveCamera,
  Scene,
  type Sphere,
  TOUCH,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Clouds } from "./cloud.ts";
import { still } from "./still.ts";

const FIELD_OF_VIEW = 32;
/** Room around the shape. */
const MARGIN = 1.22;

export class Stage {
  readonly scene = new Scene();
  readonly clouds = new Clouds();
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  readonly renderer: WebGLRenderer;
  /** The part of the drawing surface that takes the pointer: all of it, or the half in which the pointer is. */
  readonly pane: HTMLElement;
  #onRight = false;
  orbit!: OrbitControls;
  /** Called before a frame is drawn. */
  onFrame: () => void = () => {};
  /** Called after a frame is drawn, with the time at which it was begun. */
  onDrawn: (start: number) => void = () => {};
  /** What is seen in the right half, where there are two. */
  showRight: ((right: boolean) => void) | undefined;
  readonly #host: HTMLElement;
  /** Of the drawing surface, in pixels of the page. */
  #size = { width: 1, height: 1 };
  #wanted = false;

  constructor(host: HTMLElement) {
    this.#host = host;
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "high-performance" });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.domElement.setAttribute("aria-hidden", "true");
    this.renderer.autoClear = false;
    this.pane = document.createElement("div");
    this.pane.className = "pane";
    host.append(this.renderer.domElement, this.pane);
    const key = new DirectionalLight(0xffffff, 2.1);
    key.position.set(-1.2, 1.8, 2.2);
    const fill = new DirectionalLight(0xdfe8ff, 0.7);
    fill.position.set(2.5, -0.6, 1);
    this.camera.add(...[key, key.target, fill, fill.target].map(still));
    this.scene.add(this.camera, still(new HemisphereLight(0xffffff, 0x8a8378, 1.15)));
    still(this.scene);
    new ResizeObserver(() => this.resize()).observe(host);
    for (const type of ["pointermove", "pointerdown", "wheel"] as const) host.addEventListener(type, (event) => this.#follow(event));
  }

  /** After everything that takes the pointer before it. */
  startOrbit(): void {
    this.orbit = new OrbitControls(this.camera, this.pane);
    this.orbit.enableDamping = false;
    this.orbit.zoomToCursor = true;
    this.orbit.minDistance = 0.05;
    this.orbit.maxDistance = 40;
    this.orbit.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.orbit.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    this.orbit.addEventListener("change", () => this.request());
    this.home([new Vector3(-1, -1, -1), new Vector3(1, 1, 1)]);
  }

  get split(): boolean {
    return this.showRight !== undefined;
  }

  /** Whether the pointer is in the right half. */
  get onRight(): boolean {
    return this.split && this.#onRight;
  }

  /** Takes the pane to the half that the pointer has come to, and hands on what came beside it. Not away from what is dragged. */
  #follow(event: PointerEvent | WheelEvent): void {
    if (!this.split || event.target === this.pane) return;
    const pressed = event instanceof PointerEvent && (!event.isPrimary || (event.type === "pointermove" && event.buttons !== 0));
    if (!pressed) {
      const { left, width } = this.#host.getBoundingClientRect();
      this.#onRight = event.clientX > left + width / 2;
      this.#placePane();
      this.request();
    }
    if (event.type === "pointerdown") this.pane.setPointerCapture((event as PointerEvent).pointerId);
    const Type = event.constructor as new (type: string, init: object) => Event;
    if (!this.pane.dispatchEvent(new Type(event.type, event))) event.preventDefault();
  }

  #placePane(): void {
    this.pane.style.width = this.split ? "50%" : "100%";
    this.pane.style.left = this.onRight ? "50%" : "0";
  }

  /** Whether a drag of the left button or of one finger turns the view. */
  set turns(turns: boolean) {
    this.orbit.mouseButtons.LEFT = turns ? MOUSE.ROTATE : null;
    this.orbit.touches.ONE = turns ? TOUCH.ROTATE : null;
  }

  /** Draws soon. */
  request(): void {
    if (this.#wanted) return;
    this.#wanted = true;
    requestAnimationFrame(() => {
      this.#wanted = false;
      this.draw();
    });
  }

  draw(): void {
    const start = performance.now();
    this.#setDepths();
    this.onFrame();
    this.#render();
    this.onDrawn(start);
  }

  #render(): void {
    const { renderer, scene, camera } = this;
    const { width, height } = this.#size;
    renderer.setScissorTest(false);
    renderer.clear();
    if (!this.showRight) {
      renderer.setViewport(0, 0, width, height);
      this.clouds.draw(renderer, camera, 0, width, height);
      renderer.render(scene, camera);
      return;
    }
    renderer.setScissorTest(true);
    for (const right of [false, true]) {
      const x = right ? Math.ceil(width / 2) : 0;
      renderer.setViewport(x, 0, width / 2, height);
      renderer.setScissor(x, 0, width / 2, height);
      this.showRight(right);
      this.clouds.draw(renderer, camera, x, width / 2, height);
      renderer.render(scene, camera);
    }
    this.showRight(false);
  }

  resize(): void {
    const [width, height] = [this.#host.clientWidth, this.#host.clientHeight];
    if (width === 0 || height === 0) return;
    this.#size = { width, height };
    this.renderer.setSize(width, height, false);
    this.#placePane();
    const narrow = Math.min(1, this.camera.aspect);
    this.camera.aspect = width / (this.split ? 2 : 1) / height;
    // What was in the window stays in it.
    const farther = narrow / Math.min(1, this.camera.aspect);
    this.camera.position.sub(this.orbit.target).multiplyScalar(farther).add(this.orbit.target);
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.request();
  }

  /** Shows all of some places: from the front and a little above and beside, or straight from the front. */
  home(places: readonly Vector3[], straight = false): void {
    const { camera, orbit } = this;
    camera.position.set(straight ? 0 : 2.6, straight ? 0 : 1.5, 4.2);
    orbit.target.copy(new Box3().setFromPoints([...places]).getCenter(new Vector3()));
    camera.position.add(orbit.target);
    camera.lookAt(orbit.target);
    camera.updateMatrixWorld();
    // So far away that every place is within the window's four sides.
    const up = Math.tan((FIELD_OF_VIEW / 360) * Math.PI) / MARGIN;
    const [right, above, towards] = [0, 1, 2].map((axis) => new Vector3().setFromMatrixColumn(camera.matrixWorld, axis));
    let away = 0.1;
    for (const place of places) {
      const arm = place.clone().sub(orbit.target);
      const side = Math.max(Math.abs(arm.dot(above)) / up, Math.abs(arm.dot(right)) / (up * camera.aspect));
      away = Math.max(away, side + arm.dot(towards));
    }
    this.#goTo(away);
  }

  /** Turns to a place without changing the direction of view. */
  focus(sphere: Sphere): void {
    const from = this.camera.position.clone().sub(this.orbit.target);
    this.orbit.target.copy(sphere.center);
    this.camera.position.copy(sphere.center).add(from);
    const narrow = Math.min(1, this.camera.aspect);
    this.#goTo(sphere.radius / Math.sin((FIELD_OF_VIEW / 360) * Math.PI) / narrow);
  }

  #goTo(away: number): void {
    const { camera, orbit } = this;
    camera.position.sub(orbit.target).setLength(away).add(orbit.target);
    orbit.update();
    this.request();
  }

  /** Neither what is near nor what is far is cut off. */
  #setDepths(): void {
    const away = this.camera.position.distanceTo(this.orbit.target);
    const far = away + 20;
    if (this.camera.far === far) return;
    Object.assign(this.camera, { near: Math.max(0.002, away / 60), far });
    this.camera.updateProjectionMatrix();
  }
}
