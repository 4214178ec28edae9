/** What the geometry worker is asked, and what it answers. */

import type { SerializedBVH } from "three-mesh-bvh";
import type { CornerData, RestMesh } from "./restVertices.ts";

export interface GeometryRequest {
  positions: Float32Array<ArrayBuffer>;
  triangles: Uint32Array<ArrayBuffer>;
  corners: CornerData[];
}

export interface GeometryAnswer {
  mesh: RestMesh;
  bvh: SerializedBVH;
}

/** Normals and the tree for picking, computed beside the main thread. */
export function prepareGeometry(request: GeometryRequest): Promise<GeometryAnswer> {
  return new Promise((resolve, reject) => {
    const worker = new Worker(new URL("./geometry.worker.ts", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<GeometryAnswer>) => {
      resolve(data);
      worker.terminate();
    };
    worker.onerror = (event) => {
      reject(new Error(`The shape could not be prepared for display: ${event.message}`));
      worker.terminate();
    };
    worker.postMessage(request);
  });
}
