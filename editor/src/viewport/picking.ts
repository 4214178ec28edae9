/** Where a ray meets the shape as it is shown, and which place at rest that is. */

import { BufferAttribute, BufferGeometry, type Camera, DoubleSide, Ray, Triangle, Vector2, Vector3 } from "three";
import { MeshBVH, type SerializedBVH } from "three-mesh-bvh";

/** A place on the shape, relative to its box: at rest, and where it is shown. */
export interface Hit {
  rest: Vector3;
  shown: Vector3;
}

/** How near to a point of a cloud one must click, in pixels. */
const REACH = 12;

export class Picking {
  readonly #rest: Float32Array;
  #shown: Float32Array;
  #stale = true;
  readonly #read: () => Float32Array;
  readonly #geometry: BufferGeometry | undefined;
  readonly #bvh: MeshBVH | undefined;

  /** `read` gives the places as they are shown now. A shape without faces has no tree. */
  constructor(rest: Float32Array, read: () => Float32Array, mesh?: { index: Uint32Array; bvh: SerializedBVH }) {
    this.#rest = rest;
    this.#shown = rest.slice();
    this.#read = read;
    if (!mesh) return;
    this.#geometry = new BufferGeometry();
    this.#geometry.setAttribute("position", new BufferAttribute(this.#shown, 3));
    this.#geometry.setIndex(new BufferAttribute(mesh.index, 1));
    this.#bvh = MeshBVH.deserialize(mesh.bvh, this.#geometry, { setIndex: false });
  }

  /** The shape has moved: it is looked at again when it is next asked for. */
  invalidate(): void {
    this.#stale = true;
  }

  /** The first place that the ray meets; `through`: the middle between where it enters and where it leaves. */
  meet(ray: Ray, through = false): Hit | undefined {
    if (!this.#bvh || !this.#geometry) return undefined;
    this.#refresh();
    const hits = this.#bvh.raycast(ray, DoubleSide);
    if (hits.length === 0) return undefined;
    hits.sort((a, b) => a.distance - b.distance);
    const first = this.#hit(hits[0].faceIndex as number, hits[0].point);
    if (!through || hits.length < 2) return first;
    const second = this.#hit(hits[1].faceIndex as number, hits[1].point);
    return { rest: first.rest.lerp(second.rest, 0.5), shown: first.shown.lerp(second.shown, 0.5) };
  }

  /** The point of a cloud that is shown next to a place on the screen, in pixels of a window of the given size. */
  nearest(at: Vector2, window: Vector2, camera: Camera): Hit | undefined {
    if (this.#bvh) return undefined;
    this.#refresh();
    const point = new Vector3();
    let best = -1;
    let bestDepth = Number.POSITIVE_INFINITY;
    for (let i = 0; i < this.#shown.length; i += 3) {
      point.fromArray(this.#shown, i).project(camera);
      const away = Math.hypot(((point.x + 1) / 2) * window.x - at.x, ((1 - point.y) / 2) * window.y - at.y);
      if (away < REACH && point.z < bestDepth) [best, bestDepth] = [i, point.z];
    }
    if (best < 0) return undefined;
    return { rest: new Vector3().fromArray(this.#rest, best), shown: new Vector3().fromArray(this.#shown, best) };
  }

  #hit(face: number, shown: Vector3): Hit {
    const index = this.#geometry?.index as BufferAttribute;
    const corners = [0, 1, 2].map((c) => index.getX(3 * face + c));
    const at = (places: Float32Array): Vector3[] => corners.map((c) => new Vector3().fromArray(places, 3 * c));
    const [a, b, c] = at(this.#shown);
    const share = Triangle.getBarycoord(shown, a, b, c, new Vector3()) ?? new Vector3(1, 0, 0);
    const [ra, rb, rc] = at(this.#rest);
    const rest = ra.multiplyScalar(share.x).addScaledVector(rb, share.y).addScaledVector(rc, share.z);
    return { rest, shown: shown.clone() };
  }

  #refresh(): void {
    if (!this.#stale) return;
    this.#stale = false;
    this.#shown.set(this.#read());
    this.#bvh?.refit();
  }
}
