/** Control points on the screen: discs of the same size at every distance, and lines from where they were to where they are. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  GreaterDepth,
  Group,
  LessEqualDepth,
  LineBasicMaterial,
  LineSegments,
  Points,
  ShaderMaterial,
  SRGBColorSpace,
  type Vector3,
} from "three";
import { hueOf } from "../model/view.ts";
import { still } from "./still.ts";

export interface Marker {
  /** Relative to the shape's box. */
  rest: Vector3;
  place: Vector3;
  /** Its place in the list, which gives the colour. */
  number: number;
  selected: boolean;
  twin: boolean;
  locked: boolean;
  grouped: boolean;
}

const VERTEX = /* glsl */ `
attribute vec3 tone;
attribute float state;
uniform float pixels;
varying vec3 vTone;
varying float vState;
void main() {
  vTone = tone;
  vState = state;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  // Drawn a little in front of the surface that it lies on.
  gl_Position.z -= 0.004 * gl_Position.w * clamp(1.0 - gl_Position.z / gl_Position.w, 0.0, 1.0);
  gl_PointSize = pixels * (mod(state, 8.0) >= 1.0 ? 1.25 : 1.0);
}
`;

/** state: 0 plain, 1 selected, 2 twin of a selected one; + 4 locked, a square; + 8 grouped, with a dot in it. */
const FRAGMENT = /* glsl */ `
uniform float opacity;
varying vec3 vTone;
varying float vState;
void main() {
  bool grouped = vState >= 7.5;
  float state = grouped ? vState - 8.0 : vState;
  bool locked = state >= 3.5;
  state = locked ? state - 4.0 : state;
  vec2 c = 2.0 * gl_PointCoord - 1.0;
  float r = locked ? max(abs(c.x), abs(c.y)) * 1.15 : length(c);
  float edge = fwidth(r);
  float disc = 1.0 - smoothstep(0.94 - edge, 0.94, r);
  if (disc <= 0.0) discard;
  float core = 1.0 - smoothstep(0.60 - edge, 0.60 + edge, r);
  vec3 ring = state > 0.5 && state < 1.5 ? vec3(1.0, 0.26, 0.0) : state > 1.5 ? vec3(0.08, 0.5, 1.0) : vec3(1.0);
  float shadow = smoothstep(0.80, 0.94, r);
  vec3 tone = mix(mix(ring, vec3(0.04, 0.05, 0.07), 0.75 * shadow), vTone, core);
  float dot = grouped ? 1.0 - smoothstep(0.26 - edge, 0.26 + edge, r) : 0.0;
  gl_FragColor = vec4(mix(tone, vec3(1.0), dot), disc * opacity);
  #include <colorspace_fragment>
}
`;

export class Markers {
  readonly object = new Group();
  readonly #geometry = new BufferGeometry();
  readonly #lineGeometry = new BufferGeometry();
  #ends = new BufferAttribute(new Float32Array(0), 3);
  #tone = new BufferAttribute(new Float32Array(0), 3);
  #state = new BufferAttribute(new Float32Array(0), 1);
  readonly #pixels = { value: 16 };
  #count = -1;

  constructor() {
    const material = (opacity: number, hidden: boolean): ShaderMaterial =>
      new ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        uniforms: { pixels: this.#pixels, opacity: { value: opacity } },
        transparent: true,
        depthWrite: false,
        depthFunc: hidden ? GreaterDepth : LessEqualDepth,
      });
    const line = (opacity: number, hidden: boolean): LineBasicMaterial =>
      new LineBasicMaterial({
        color: 0xff8c1a,
        transparent: true,
        opacity,
        depthWrite: false,
        depthFunc: hidden ? GreaterDepth : LessEqualDepth,
      });
    const nodes = [
      new LineSegments(this.#lineGeometry, line(0.25, true)),
      new LineSegments(this.#lineGeometry, line(0.9, false)),
      new Points(this.#geometry, material(0.5, true)),
      new Points(this.#geometry, material(1, false)),
    ];
    nodes.forEach((node, i) => {
      node.frustumCulled = false;
      node.renderOrder = 10 + i;
      this.object.add(still(node));
    });
    still(this.object);
  }

  /** The size of a disc in pixels of the screen. */
  setSize(pixels: number, pixelRatio: number): void {
    this.#pixels.value = pixels * pixelRatio;
  }

  update(markers: readonly Marker[]): void {
    if (markers.length !== this.#count) this.#setCount(markers.length);
    markers.forEach((marker, i) => {
      writeVector(this.#ends, 2 * i, marker.rest);
      writeVector(this.#ends, 2 * i + 1, marker.place);
      const [r, g, b] = colourOf(marker.number);
      write(this.#tone, 6 * i + 3, r);
      write(this.#tone, 6 * i + 4, g);
      write(this.#tone, 6 * i + 5, b);
      write(this.#state, 2 * i + 1, (marker.selected ? 1 : marker.twin ? 2 : 0) + (marker.locked ? 4 : 0) + (marker.grouped ? 8 : 0));
    });
  }

  /** The ends of the lines are the places of the discs too: every second one of them. */
  #setCount(count: number): void {
    this.#count = count;
    this.#geometry.dispose();
    this.#lineGeometry.dispose();
    this.#ends = new BufferAttribute(new Float32Array(6 * count), 3);
    this.#tone = new BufferAttribute(new Float32Array(6 * count), 3);
    this.#state = new BufferAttribute(new Float32Array(2 * count), 1);
    this.#lineGeometry.setAttribute("position", this.#ends);
    this.#geometry.setAttribute("position", this.#ends);
    this.#geometry.setAttribute("tone", this.#tone);
    this.#geometry.setAttribute("state", this.#state);
    this.#geometry.setIndex(Array.from({ length: count }, (_, i) => 2 * i + 1));
  }
}

/** Only what has changed goes to the GPU. */
function write(attribute: BufferAttribute, at: number, value: number): void {
  const single = Math.fround(value);
  if (attribute.array[at] === single) return;
  attribute.array[at] = single;
  attribute.needsUpdate = true;
}

function writeVector(attribute: BufferAttribute, i: number, { x, y, z }: Vector3): void {
  write(attribute, 3 * i, x);
  write(attribute, 3 * i + 1, y);
  write(attribute, 3 * i + 2, z);
}

const colours: [number, number, number][] = [];

/** The colour of the i-th control point, linear. */
export function colourOf(i: number): [number, number, number] {
  return (colours[i] ??= new Color().setHSL(...hueOf(i), SRGBColorSpace).toArray() as [number, number, number]);
}
