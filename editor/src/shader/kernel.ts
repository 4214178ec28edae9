/**
 * The drag on the GPU. Rest places, normals and logits go up once; a frame uploads the control points alone, and the vertex
 * shader writes the deformed shape into buffers (transform feedback) that are then drawn as any other. Nothing is computed again for
 * a frame in which only the camera moves.
 */

import type { Aim, Constants } from "../model/handles.ts";
import type { Transform } from "../model/settings.ts";
import { deformVertexShader, NO_FRAGMENTS } from "./glsl.ts";
import { isStill, type OrientedPoint } from "./oriented.ts";

/** What is drawn: each vertex belongs to a point of the shape, whose logits it has. */
export interface RestVertices {
  /** Relative to the shape's box, 3 numbers each. */
  positions: Float32Array<ArrayBuffer>;
  normals: Float32Array<ArrayBuffer>;
  points: Uint32Array<ArrayBuffer>;
}

export type Tint = { by: "nothing" } | { by: "weight"; of: number } | { by: "point" };

/** How the control points are moved; coordinates relative to the shape's box. */
export interface GpuMotion {
  /** m x 3 */
  p: Float64Array;
  q: Float64Array;
  oriented: readonly OrientedPoint[];
  /** What local maps follow where the control points around them leave something open. */
  anchor: Pick<Aim, "rotation" | "scale" | "linear">;
  transform: Transform;
  temperature: number;
  tint: Tint;
}

const TRANSFORM_CODES: Record<Transform, number> = { rigid: 0, similarity: 1, affine: 2 };
const TINT_CODES: Record<Tint["by"], number> = { nothing: 0, weight: 1, point: 2 };
const UNIFORMS = [
  "logits", "controlPoints", "m", "transform", "temperature", "moved", "anyOriented",
  "anchorRotation", "anchorScale", "anchorLinear", "tintBy", "tinted",
] as const; // prettier-ignore
/** Those of one number that are no whole ones. */
const FRACTIONS: ReadonlySet<(typeof UNIFORMS)[number]> = new Set(["temperature", "anchorScale"]);
/** Of the table of control points: p, q, colours, and the rows of rotations with squares and scales beside. */
const ROWS = 6;
/** Larger than any logit that means anything, and safe to compute with, unlike infinity. */
const LARGEST_LOGIT = 1e30;

/** The texture units of the two samplers: the last that every vertex shader has, beyond those that materials come to. */
const UNITS = { logits: 14, controlPoints: 15 };

/** Who keeps account of a context that is shared; contexts are such themselves. */
export type GlState = {
  [name in "useProgram" | "activeTexture" | "bindTexture" | "pixelStorei"]: (
    ...values: Parameters<WebGL2RenderingContext[name]>
  ) => unknown;
};

export class Kernel {
  readonly gl: WebGL2RenderingContext;
  readonly program: WebGLProgram;
  readonly uniforms: Record<(typeof UNIFORMS)[number], WebGLUniformLocation | null>;
  readonly state: GlState;
  /** What the uniforms of one number are: most of them are the same in every frame. */
  readonly #numbers = new Map<(typeof UNIFORMS)[number], number>();

  /** `state` is asked for what others set too, so that they know; the context itself where there is nobody else. */
  constructor(gl: WebGL2RenderingContext, constants: Constants, state: GlState = gl) {
    [this.gl, this.state] = [gl, state];
    this.program = link(gl, deformVertexShader(constants));
    this.uniforms = Object.fromEntries(
      UNIFORMS.map((name) => [name, gl.getUniformLocation(this.program, name)]),
    ) as typeof this.uniforms;
  }

  /** Takes a shape to the GPU. */
  bind(rest: RestVertices): BoundVertices {
    return this.use(() => new BoundVertices(this, rest));
  }

  /** Does some work in the context, between frames of who shares it: they leave no vertex array bound, nor does this. */
  use<T>(work: () => T): T {
    const { gl, state } = this;
    state.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    state.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    state.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    state.pixelStorei(gl.UNPACK_ROW_LENGTH, 0);
    try {
      return work();
    } finally {
      gl.bindVertexArray(null);
      gl.bindBuffer(gl.ARRAY_BUFFER, null);
    }
  }

  /** Sets a uniform of one number of the program that is in use. */
  setNumber(name: (typeof UNIFORMS)[number], value: number): void {
    if (this.#numbers.get(name) === value) return;
    this.#numbers.set(name, value);
    if (FRACTIONS.has(name)) this.gl.uniform1f(this.uniforms[name], value);
    else this.gl.uniform1i(this.uniforms[name], value);
  }

  /** Makes a texture the one that is worked on, and that the sampler of its unit reads. */
  bindTexture(unit: keyof typeof UNITS, texture: WebGLTexture | null): void {
    this.state.activeTexture(this.gl.TEXTURE0 + UNITS[unit]);
    this.state.bindTexture(this.gl.TEXTURE_2D, texture);
  }
}

/** The vertices of one shape on the GPU, with the buffers that their deformed places are written to. */
export class BoundVertices {
  readonly count: number;
  readonly positions: WebGLBuffer;
  readonly normals: WebGLBuffer;
  readonly tints: WebGLBuffer;
  readonly #kernel: Kernel;
  readonly #inputs: WebGLBuffer[] = [];
  readonly #array: WebGLVertexArrayObject;
  readonly #feedback: WebGLTransformFeedback;
  readonly #controlPoints: WebGLTexture;
  #logits: WebGLTexture | undefined;
  #m = 0;
  #table: Float32Array = new Float32Array(0);

  constructor(kernel: Kernel, rest: RestVertices) {
    const { gl } = kernel;
    this.#kernel = kernel;
    this.count = rest.points.length;
    this.#array = gl.createVertexArray();
    gl.bindVertexArray(this.#array);
    [rest.positions, rest.normals, rest.points].forEach((data, location) => {
      const buffer = gl.createBuffer();
      this.#inputs.push(buffer);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(location);
      if (location === 2) gl.vertexAttribIPointer(location, 1, gl.UNSIGNED_INT, 0, 0);
      else gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
    });
    gl.bindVertexArray(null);
    const output = (data: Float32Array<ArrayBuffer>): WebGLBuffer => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_COPY);
      return buffer;
    };
    this.positions = output(rest.positions);
    this.normals = output(rest.normals);
    this.tints = output(new Float32Array(3 * this.count).fill(1));
    this.#feedback = gl.createTransformFeedback();
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, this.#feedback);
    [this.positions, this.normals, this.tints].forEach((buffer, at) =>
      gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, at, buffer),
    );
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, null);
    this.#controlPoints = dataTexture(kernel, "controlPoints");
  }

  /**
   * Takes logits to the GPU, n x m row by row, with a colour for each control point, m x 3.
   *
   * Returns false, and keeps what there was, where they are more than a texture holds.
   */
  setLogits(logits: Float32Array, m: number, colours: Float32Array): boolean {
    const { gl } = this.#kernel;
    const limit = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
    const perPoint = Math.ceil(m / 4);
    const texels = (logits.length / m) * perPoint;
    const width = Math.min(texels, limit, 4096);
    const height = Math.ceil(texels / width);
    if (height > limit || m > limit) return false;
    const padded = new Float32Array(4 * width * height);
    for (let from = 0, to = 0; from < logits.length; from += m, to += 4 * perPoint) {
      for (let i = 0; i < m; i++) padded[to + i] = Math.min(logits[from + i], LARGEST_LOGIT);
    }
    this.#kernel.use(() => {
      this.#logits ??= dataTexture(this.#kernel, "logits");
      this.#kernel.bindTexture("logits", this.#logits);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, padded);
      this.#m = m;
      this.#table = new Float32Array(4 * m * ROWS);
      for (let i = 0; i < m; i++) this.#table.set(colours.subarray(3 * i, 3 * i + 3), 4 * (2 * m + i));
      this.#kernel.bindTexture("controlPoints", this.#controlPoints);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, m, ROWS, 0, gl.RGBA, gl.FLOAT, null);
    });
    return true;
  }

  /** Computes a frame. */
  deform(motion: GpuMotion): void {
    if (this.#logits && motion.p.length === 3 * this.#m) this.#kernel.use(() => this.#compute(motion));
  }

  #compute({ p, q, oriented, anchor, transform, temperature, tint }: GpuMotion): void {
    const kernel = this.#kernel;
    const { gl, program, state, uniforms } = kernel;
    const m = this.#m;
    state.useProgram(program);
    kernel.bindTexture("logits", this.#logits ?? null);
    kernel.bindTexture("controlPoints", this.#controlPoints);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, m, ROWS, gl.RGBA, gl.FLOAT, this.#fill(p, q, oriented));
    kernel.setNumber("logits", UNITS.logits);
    kernel.setNumber("controlPoints", UNITS.controlPoints);
    kernel.setNumber("m", m);
    kernel.setNumber("transform", TRANSFORM_CODES[transform]);
    kernel.setNumber("temperature", temperature);
    kernel.setNumber("moved", p.every((c, at) => c === q[at]) && oriented.every(isStill) ? 0 : 1);
    kernel.setNumber("anyOriented", oriented.length > 0 ? 1 : 0);
    kernel.setNumber("anchorScale", anchor.scale);
    kernel.setNumber("tintBy", TINT_CODES[tint.by]);
    kernel.setNumber("tinted", tint.by === "weight" ? tint.of : -1);
    gl.uniformMatrix3fv(uniforms.anchorRotation, true, anchor.rotation);
    gl.uniformMatrix3fv(uniforms.anchorLinear, true, anchor.linear);
    gl.bindVertexArray(this.#array);
    // What is written to must not be bound to anything else, and drawing may have left it so.
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, this.#feedback);
    gl.enable(gl.RASTERIZER_DISCARD);
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArrays(gl.POINTS, 0, this.count);
    gl.endTransformFeedback();
    gl.disable(gl.RASTERIZER_DISCARD);
    gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, null);
  }

  /** Shows places that were computed elsewhere. */
  show({ positions, normals }: Pick<RestVertices, "positions" | "normals">): void {
    const { gl } = this.#kernel;
    this.#kernel.use(() => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, positions);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.normals);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, normals);
    });
  }

  /** The deformed places as the GPU has them: for checks, as it waits for the GPU. */
  read(): Float32Array<ArrayBuffer> {
    const { gl } = this.#kernel;
    const positions = new Float32Array(3 * this.count);
    this.#kernel.use(() => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
      gl.getBufferSubData(gl.ARRAY_BUFFER, 0, positions);
    });
    return positions;
  }

  dispose(): void {
    const { gl } = this.#kernel;
    for (const buffer of [...this.#inputs, this.positions, this.normals, this.tints]) gl.deleteBuffer(buffer);
    gl.deleteVertexArray(this.#array);
    gl.deleteTransformFeedback(this.#feedback);
    gl.deleteTexture(this.#controlPoints);
    if (this.#logits) gl.deleteTexture(this.#logits);
  }

  #fill(p: Float64Array, q: Float64Array, oriented: readonly OrientedPoint[]): Float32Array {
    const [table, m] = [this.#table, this.#m];
    for (let i = 0; i < m; i++) {
      for (let c = 0; c < 3; c++) {
        table[4 * i + c] = p[3 * i + c];
        table[4 * (m + i) + c] = q[3 * i + c];
      }
    }
    table.fill(0, 12 * m);
    for (const { index, rotation, scale, square } of oriented) {
      for (let row = 0; row < 3; row++) table.set(rotation.slice(3 * row, 3 * row + 3), 4 * ((3 + row) * m + index));
      table[4 * (3 * m + index) + 3] = square;
      table[4 * (4 * m + index) + 3] = scale;
    }
    return table;
  }
}

function dataTexture(kernel: Kernel, unit: keyof typeof UNITS): WebGLTexture {
  const { gl } = kernel;
  const texture = gl.createTexture();
  kernel.bindTexture(unit, texture);
  for (const parameter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, parameter, gl.NEAREST);
  }
  return texture;
}

function link(gl: WebGL2RenderingContext, vertexShader: string): WebGLProgram {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertexShader],
    [gl.FRAGMENT_SHADER, NO_FRAGMENTS],
  ] as const) {
    const shader = gl.createShader(type);
    if (!shader) throw new Error("The browser has lost its graphics: reload the page.");
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.transformFeedbackVaryings(program, ["y", "turned", "tint"], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    const logs = gl.getAttachedShaders(program)?.map((shader) => gl.getShaderInfoLog(shader)) ?? [];
    throw new Error(`The drag's shader was refused: ${[gl.getProgramInfoLog(program), ...logs].join(" ").trim()}`);
  }
  return program;
}
