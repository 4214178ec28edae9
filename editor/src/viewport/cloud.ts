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
  gl_PointSize = clamp(0.5 * windowHeight * projectionMatrix[1][1] * diameter / gl_Position.w, 1.5, 40.0);
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

/** Cells of a grid along a side of the shape's box, of which those with points tell how large a surface these are spread over. */
const CELLS = 32;
const LARGEST = 0.08;

/** How large the discs of points (relative to the shape's box, 3 numbers each) must be to close a surface. */
export function discDiameter(positions: Float32Array): number {
  const taken = new Set<number>();
  const cell = (c: number): number => Math.min(CELLS - 1, Math.max(0, Math.floor(((c + 1) / 2) * CELLS)));
  for (let i = 0; i < positions.length; i += 3) {
    taken.add((cell(positions[i]) * CELLS + cell(positions[i + 1])) * CELLS + cell(positions[i + 2]));
  }
  const spacing = (2 / CELLS) * Math.sqrt(taken.size / (positions.length / 3));
  return Math.min(LARGEST, 1.7 * spacing);
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
