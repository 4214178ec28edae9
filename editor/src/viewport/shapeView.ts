/** A shape as it is drawn: buffers that the kernel fills, in the materials that three knows. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GLBufferAttribute,
  Group,
  type Material,
  Mesh,
  MeshStandardMaterial,
  type Object3D,
  Points,
  Sphere,
  Vector3,
} from "three";
import type { Colouring } from "../model/view.ts";
import { still } from "./still.ts";
import { cloudMaterial, discDiameter } from "./cloud.ts";
import type { BoundVertices, GpuMotion, Kernel, RestVertices } from "../shader/kernel.ts";

/** What is drawn of a shape. */
export interface Drawn {
  rest: RestVertices;
  /** Three vertices a triangle; null for a cloud of points. */
  index: Uint32Array | null;
  uv?: Float32Array;
  colours?: Float32Array;
  /** Which triangles have which of the materials; empty: all the first one. */
  groups: { start: number; count: number; material: number }[];
  materials: Material[];
}

/** The material of shapes that bring none. */
export function plainMaterial(): MeshStandardMaterial {
  return new MeshStandardMaterial({ color: 0xb9bfc9, roughness: 0.62, metalness: 0.04, side: DoubleSide });
}

export class ShapeView {
  readonly object: Object3D;
  readonly bound: BoundVertices;
  readonly #drawn: Drawn;
  readonly #plain: BufferGeometry;
  readonly #tinted: BufferGeometry;
  readonly #plainMaterial: Material | Material[];
  readonly #tintMaterial: Material;
  readonly #node: Mesh | Points;
  readonly #wire: Mesh | undefined;

  constructor(kernel: Kernel, drawn: Drawn) {
    this.#drawn = drawn;
    this.bound = kernel.bind(drawn.rest);
    const { gl } = kernel;
    const attribute = (buffer: WebGLBuffer): BufferAttribute =>
      // The renderer treats both alike; the types do not say so.
      new GLBufferAttribute(buffer, gl.FLOAT, 3, 4, this.bound.count) as unknown as BufferAttribute;
    const [position, normal, tint] = [this.bound.positions, this.bound.normals, this.bound.tints].map(attribute);
    const index = drawn.index && new BufferAttribute(drawn.index, 1);
    const geometry = (): BufferGeometry => {
      const made = new BufferGeometry();
      made.setAttribute("position", position);
      made.setAttribute("normal", normal);
      if (drawn.uv) made.setAttribute("uv", new BufferAttribute(drawn.uv, 2));
      if (index) made.setIndex(index);
      made.boundingSphere = new Sphere(new Vector3(), Number.POSITIVE_INFINITY);
      return made;
    };
    this.#plain = geometry();
    if (drawn.colours) this.#plain.setAttribute("color", new BufferAttribute(drawn.colours, 3));
    for (const { start, count, material } of drawn.groups) this.#plain.addGroup(start, count, material);
    this.#tinted = geometry();
    this.#tinted.setAttribute("color", tint);
    if (index) {
      this.#tintMaterial = new MeshStandardMaterial({ vertexColors: true, roughness: 0.75, side: DoubleSide });
      this.#plainMaterial = drawn.groups.length > 0 ? drawn.materials : drawn.materials[0];
      this.#node = new Mesh(this.#plain, this.#plainMaterial);
      const wire = new MeshStandardMaterial({ color: 0x20242c, wireframe: true, transparent: true, opacity: 0.35 });
      // A little nearer to the eye than the faces.
      Object.assign(wire, { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
      this.#wire = new Mesh(this.#tinted, wire);
      this.#wire.visible = false;
      this.#wire.frustumCulled = false;
    } else {
      const coloured = drawn.colours !== undefined;
      const diameter = discDiameter(drawn.rest.positions);
      this.#plainMaterial = cloudMaterial(diameter, new Color(coloured ? 0xffffff : 0xa4b1c6), coloured);
      this.#tintMaterial = cloudMaterial(diameter, new Color(0xffffff), true);
      this.#node = new Points(this.#plain, this.#plainMaterial);
    }
    this.#node.frustumCulled = false;
    this.object = still(new Group()).add(still(this.#node));
    if (this.#wire) this.object.add(still(this.#wire));
  }

  get drawn(): Drawn {
    return this.#drawn;
  }

  /** Computes a frame on the GPU. */
  deform(motion: GpuMotion): void {
    this.bound.deform(motion);
  }

  show(colouring: Colouring, wireframe: boolean): void {
    const tinted = colouring !== "material";
    this.#node.geometry = tinted ? this.#tinted : this.#plain;
    this.#node.material = tinted ? this.#tintMaterial : this.#plainMaterial;
    if (this.#wire) this.#wire.visible = wireframe;
  }

  dispose(): void {
    this.#plain.dispose();
    this.#tinted.dispose();
    this.#tintMaterial.dispose();
    (this.#wire?.material as Material | undefined)?.dispose();
    this.bound.dispose();
  }
}
