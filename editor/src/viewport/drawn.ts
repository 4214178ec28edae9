/** What is drawn of a shape that has been opened. */

import type { SerializedBVH } from "three-mesh-bvh";
import { prepareGeometry } from "./geometry.ts";
import { type Drawn, plainMaterial } from "./shapeView.ts";

/** A shape as it was opened; the worker's `Opened` is one. */
export interface OpenedShape {
  name: string;
  /** n x 3, relative to the shape's box. */
  positions: Float32Array<ArrayBuffer>;
  triangles: Uint32Array<ArrayBuffer> | null;
}

export interface Prepared {
  drawn: Drawn;
  mesh: { index: Uint32Array<ArrayBuffer>; bvh: SerializedBVH } | undefined;
  hasAppearance: boolean;
}

export async function draw(opened: OpenedShape, _files: ReadonlyMap<string, Uint8Array>): Promise<Prepared> {
  const { positions, triangles } = opened;
  if (!triangles || triangles.length === 0) {
    const points = Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
    const rest = { positions, normals: new Float32Array(positions.length).fill(0), points };
    return { drawn: { rest, index: null, groups: [], materials: [] }, mesh: undefined, hasAppearance: false };
  }
  const { mesh, bvh } = await prepareGeometry({ positions, triangles });
  const { index, ...rest } = mesh;
  const drawn: Drawn = { rest, index, groups: [], materials: [plainMaterial()] };
  return { drawn, mesh: { index, bvh }, hasAppearance: false };
}
