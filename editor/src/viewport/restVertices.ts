/** The vertices that are drawn for a triangle mesh: a point has several where faces meet at a sharp edge, each with its normal. */

/** Faces that meet at a larger angle are shaded apart (cosine of 40 degrees). */
const CREASE = Math.cos((40 / 180) * Math.PI);
/** More normals than this at one place are not told apart. */
const MOST_NORMALS = 24;

export interface RestMesh {
  positions: Float32Array<ArrayBuffer>;
  normals: Float32Array<ArrayBuffer>;
  /** The point of the shape that each vertex belongs to. */
  points: Uint32Array<ArrayBuffer>;
  /** Three vertices a triangle, in the order of the shape's triangles. */
  index: Uint32Array<ArrayBuffer>;
  /** What corners bring along (texture coordinates, colours), now for each vertex. */
  extras: Float32Array<ArrayBuffer>[];
}

/** Numbers that belong to the corners of triangles: `size` for each of the 3 f corners. */
export interface CornerData {
  data: Float32Array<ArrayBuffer>;
  size: number;
}

/**
 * `positions` (n x 3), `triangles` (f x 3): vertices with normals that are smooth but for creases. Corners with different data are
 * different vertices.
 */
export function restMesh(positions: Float32Array, triangles: Uint32Array, corners: readonly CornerData[] = []): RestMesh {
  const places = weld(positions);
  const faceNormals = normalsOfFaces(positions, triangles);
  const around = cornersAround(places, triangles);
  const n = positions.length / 3;
  const clusterOf = new Uint8Array(triangles.length);
  const index = new Uint32Array(triangles.length);
  // A corner's vertex is that of its point and of its cluster of faces; a chain for each point.
  const points: number[] = [];
  const normals: number[] = [];
  /** A corner of each vertex: the others have the same cluster and data. */
  const cornerOf: number[] = [];
  const next: number[] = [];
  const firstOf = new Int32Array(n).fill(-1);
  const sums = new Float64Array(3 * MOST_NORMALS);
  const seeds = new Float64Array(3 * MOST_NORMALS);
  for (let place = 0; place < n; place++) {
    const [begin, end] = [around.first[place], around.first[place + 1]];
    let count = 0;
    for (let at = begin; at < end; at++) {
      const c = around.list[at];
      const f = 3 * Math.floor(c / 3);
      const [x, y, z] = [faceNormals[f], faceNormals[f + 1], faceNormals[f + 2]];
      const area = Math.hypot(x, y, z) || 1e-30;
      let cluster = 0;
      for (; cluster < count; cluster++) {
        const s = 3 * cluster;
        if (x * seeds[s] + y * seeds[s + 1] + z * seeds[s + 2] >= CREASE * area) break;
      }
      if (cluster === count) {
        if (count === MOST_NORMALS) cluster--;
        else {
          count++;
          seeds.set([x / area, y / area, z / area], 3 * cluster);
          sums.fill(0, 3 * cluster, 3 * cluster + 3);
        }
      }
      clusterOf[c] = cluster;
      sums[3 * cluster] += x;
      sums[3 * cluster + 1] += y;
      sums[3 * cluster + 2] += z;
    }
    for (let at = begin; at < end; at++) {
      const c = around.list[at];
      const point = triangles[c];
      let vertex = firstOf[point];
      while (vertex >= 0 && !(clusterOf[cornerOf[vertex]] === clusterOf[c] && same(corners, cornerOf[vertex], c))) {
        vertex = next[vertex];
      }
      if (vertex < 0) {
        vertex = points.length;
        points.push(point);
        cornerOf.push(c);
        next.push(firstOf[point]);
        firstOf[point] = vertex;
        const s = 3 * clusterOf[c];
        const length = Math.hypot(sums[s], sums[s + 1], sums[s + 2]);
        normals.push(...(length > 0 ? [sums[s] / length, sums[s + 1] / length, sums[s + 2] / length] : [0, 1, 0]));
      }
      index[c] = vertex;
    }
  }
  return {
    positions: gather(positions, points, 3),
    normals: new Float32Array(normals),
    points: new Uint32Array(points),
    index,
    extras: corners.map((extra) => gather(extra.data, cornerOf, extra.size)),
  };
}

function same(corners: readonly CornerData[], a: number, b: number): boolean {
  for (const { data, size } of corners) {
    for (let k = 0; k < size; k++) if (data[size * a + k] !== data[size * b + k]) return false;
  }
  return true;
}

/** Some of the rows of a table. */
function gather(table: Float32Array, rows: ArrayLike<number>, size: number): Float32Array<ArrayBuffer> {
  const gathered = new Float32Array(size * rows.length);
  for (let i = 0; i < rows.length; i++) {
    for (let c = 0; c < size; c++) gathered[size * i + c] = table[size * rows[i] + c];
  }
  return gathered;
}

/** For each point the first one at the very same place, so that soups are shaded as if they were connected. */
export function weld(positions: Float32Array): Uint32Array {
  const n = positions.length / 3;
  const bits = new Uint32Array(positions.slice().map((c) => c + 0).buffer); // + 0: no minus zero
  let slots = 16;
  while (slots < 2 * n) slots *= 2;
  const table = new Int32Array(slots).fill(-1);
  const first = new Uint32Array(n);
  for (let i = 0; i < n; i++) {
    const [a, b, c] = [bits[3 * i], bits[3 * i + 1], bits[3 * i + 2]];
    let hash = Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca6b) ^ Math.imul(c, 0xc2b2ae35);
    hash = Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d);
    let slot = (hash ^ (hash >>> 13)) & (slots - 1);
    for (; ; slot = (slot + 1) & (slots - 1)) {
      const j = table[slot];
      if (j < 0) {
        table[slot] = first[i] = i;
        break;
      }
      if (bits[3 * j] === a && bits[3 * j + 1] === b && bits[3 * j + 2] === c) {
        first[i] = j;
        break;
      }
    }
  }
  return first;
}

/** Normals as long as twice the face's area. */
function normalsOfFaces(v: Float32Array, triangles: Uint32Array): Float32Array {
  const normals = new Float32Array(triangles.length);
  for (let f = 0; f < triangles.length; f += 3) {
    const [i, j, k] = [3 * triangles[f], 3 * triangles[f + 1], 3 * triangles[f + 2]];
    const [ax, ay, az] = [v[j] - v[i], v[j + 1] - v[i + 1], v[j + 2] - v[i + 2]];
    const [bx, by, bz] = [v[k] - v[i], v[k + 1] - v[i + 1], v[k + 2] - v[i + 2]];
    normals[f] = ay * bz - az * by;
    normals[f + 1] = az * bx - ax * bz;
    normals[f + 2] = ax * by - ay * bx;
  }
  return normals;
}

/** The corners of triangles around each place. */
function cornersAround(places: Uint32Array, triangles: Uint32Array): { first: Uint32Array; list: Uint32Array } {
  const first = new Uint32Array(places.length + 1);
  for (const point of triangles) first[places[point] + 1]++;
  for (let i = 0; i < places.length; i++) first[i + 1] += first[i];
  const list = new Uint32Array(triangles.length);
  const at = first.slice();
  for (let c = 0; c < triangles.length; c++) list[at[places[triangles[c]]]++] = c;
  return { first, list };
}
