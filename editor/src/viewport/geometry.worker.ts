/** Prepares a mesh for display and picking; see geometry.ts. */

import { BufferAttribute, BufferGeometry } from "three";
import { MeshBVH } from "three-mesh-bvh";
import type { GeometryRequest } from "./geometry.ts";
import { restMesh } from "./restVertices.ts";

self.onmessage = ({ data }: MessageEvent<GeometryRequest>): void => {
  const mesh = restMesh(data.positions, data.triangles, data.corners);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new BufferAttribute(mesh.index, 1));
  // Indirect: the order of the triangles stays that of the shape.
  const bvh = MeshBVH.serialize(new MeshBVH(geometry, { indirect: true }), { cloneBuffers: false });
  self.postMessage({ mesh, bvh });
};
