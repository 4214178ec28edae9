/**
 * Clouds of points, shaded by depth alone, for they have no normals: where what is beside a point is nearer to the eye, it is darker.
 *
 * Boucheny, "Interactive scientific visualization of large datasets: towards a perceptive-based approach", 2009 (eye-dome lighting).
 */

import {
  type Color,
  DepthTexture,
  NearestFilter,
  type PerspectiveCamera,
  Scene,
  ShaderMaterial,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { FullScreenQuad } from "three/addons/postprocessing/Pass.js";

const POINT_VERTEX = /* glsl */ `
uniform vec3 colour;
uniform float diameter;       // relative to the shape's box
uniform float windowHeight;   // pixels
varying vec3 vColour;
void main() {
  vColour = colour;
  #ifdef USE_COLOR
  vColour *= color;
  #endif
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = clamp(0.5 * windowHeight * projectionMatrix[1][1] * diameter / gl_Position.w, 1.5, 80.0);
}
`;

const POINT_FRAGMENT = /* glsl */ `
varying vec3 vColour;
void main() {
  vec2 c = 2.0 * gl_PointCoord - 1.0;
  if (dot(c, c) > 1.0) discard;
  gl_FragColor = sRGBTransferOETF(vec4(vColour, 1.0));
}
`;

const SHADE_VERTEX = /* glsl */ `
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

const SHADE_FRAGMENT = /* glsl */ `
uniform sampler2D colours, depths;
uniform vec2 corner;  // of the window, in pixels
uniform vec2 clip;    // the camera's near and far
const float REACH = 1.5, STRENGTH = 90.0, DARKEST = 0.4;

float logDepth(float z) { return log2(clip.x * clip.y / (clip.y - z * (clip.y - clip.x))); }

void main() {
  vec2 size = vec2(textureSize(depths, 0)), at = (gl_FragCoord.xy - corner) / size;
  float z = texture2D(depths, at).x;
  if (z >= 1.0) discard;
  float own = logDepth(z), nearer = 0.0;
  for (int i = 0; i < 8; i++) {
    float turn = 0.785398163 * float(i);
    nearer += max(0.0, own - logDepth(texture2D(depths, at + REACH * vec2(cos(turn), sin(turn)) / size).x));
  }
  gl_FragColor = vec4(texture2D(colours, at).rgb * mix(DARKEST, 1.0, exp(-STRENGTH * nearer / 8.0)), 1.0);
  gl_FragDepth = z;
}
`;

/** What all points of all clouds share. */
const windowHeight = { value: 1 };

/** Which neighbour tells how large a disc must be. The nearest does not: it is twice as far on a grid as among random points as dense. */
const NEIGHBOUR = 8;
/** Of the distance to it: so much that next to nothing of a surface of random points stays open. */
const SHARE = 1.7;
const LARGEST = 0.2;
/** Distances that are computed: a tenth of a second. */
const DISTANCES = 3e7;

/** How large the discs of points (relative to the shape's box, 3 numbers each) must be to close a surface: by the median of some of them. */
export function discDiameter(positions: Float32Array): number {
  const n = positions.length / 3;
  const samples = Math.min(n, 500, Math.max(25, Math.floor(DISTANCES / n)));
  const away = Array.from({ length: samples }, (_, i) => neighbour(positions, Math.floor((i * n) / samples))).sort((a, b) => a - b);
  return Math.min(LARGEST, SHARE * (away[Math.floor(samples / 2)] ?? 0));
}

/** How far away from a point its eighth neighbour is; those in the same place are none. */
function neighbour(positions: Float32Array, point: number): number {
  const [x, y, z] = positions.subarray(3 * point, 3 * point + 3);
  const nearest = new Array<number>(NEIGHBOUR).fill(Number.POSITIVE_INFINITY);
  for (let i = 0; i < positions.length; i += 3) {
    const square = (positions[i] - x) ** 2 + (positions[i + 1] - y) ** 2 + (positions[i + 2] - z) ** 2;
    if (square >= nearest[NEIGHBOUR - 1] || square === 0) continue;
    let at = NEIGHBOUR - 1;
    for (; at > 0 && nearest[at - 1] > square; at--) nearest[at] = nearest[at - 1];
    nearest[at] = square;
  }
  return Math.sqrt(nearest[NEIGHBOUR - 1]);
}

/** The material of a cloud of points. */
export function cloudMaterial(diameter: number, colour: Color, vertexColors: boolean): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: POINT_VERTEX,
    fragmentShader: POINT_FRAGMENT,
    uniforms: { colour: { value: colour }, diameter: { value: diameter }, windowHeight },
    vertexColors,
  });
}

export class Clouds {
  readonly scene = new Scene();
  readonly #target = new WebGLRenderTarget(1, 1, {
    minFilter: NearestFilter,
    magFilter: NearestFilter,
    depthTexture: new DepthTexture(1, 1),
  });
  readonly #corner = { value: new Vector2() };
  readonly #clip = { value: new Vector2() };
  readonly #shade = new FullScreenQuad(
    new ShaderMaterial({
      vertexShader: SHADE_VERTEX,
      fragmentShader: SHADE_FRAGMENT,
      uniforms: {
        colours: { value: this.#target.texture },
        depths: { value: this.#target.depthTexture },
        corner: this.#corner,
        clip: this.#clip,
      },
    }),
  );

  /** Draws the clouds into a window of the drawing surface, which the renderer is set to: `left` and sizes in pixels of the page. */
  draw(renderer: WebGLRenderer, camera: PerspectiveCamera, left: number, width: number, height: number): void {
    if (this.scene.children.length === 0) return;
    const ratio = renderer.getPixelRatio();
    const [w, h] = [width, height].map((pixels) => Math.max(1, Math.floor(pixels * ratio)));
    this.#target.setSize(w, h);
    windowHeight.value = h;
    this.#corner.value.set(Math.floor(left * ratio), 0);
    this.#clip.value.set(camera.near, camera.far);
    renderer.setRenderTarget(this.#target);
    renderer.clear();
    renderer.render(this.scene, camera);
    renderer.setRenderTarget(null);
    this.#shade.render(renderer);
  }
}
