/**
 * The one map that fits all control points with equal weights: what a local map follows where the control points around it
 * leave something open. In double precision, once a frame; the rule is that of `crates/core/src/mls`.
 *
 * Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987.
 */

import type { TurnedPoint } from "./turned.ts";

/** Row-major 3 x 3. */
export type Matrix = [number, number, number, number, number, number, number, number, number];

export interface Anchor {
  rotation: Matrix;
  scale: number;
  linear: Matrix;
}

export const IDENTITY: Matrix = [1, 0, 0, 0, 1, 0, 0, 0, 1];

/** How much the anchor counts against the local moments, relative to their size. */
const ANCHOR_WEIGHT = 1e-9;
/** What stands for a missing extent of the control points, relative to the one they have. */
const RIDGE = 1e-12;

/** The anchor of control points `p` that are moved to `q`, m x 3 each, some of them turned. */
export function anchor(p: ArrayLike<number>, q: ArrayLike<number>, turned: readonly TurnedPoint[] = []): Anchor {
  const m = p.length / 3;
  const pMean = mean(p, m);
  const qMean = mean(q, m);
  const pq = zero();
  const pp = zero();
  for (let i = 0; i < 3 * m; i += 3) {
    for (let c = 0; c < 3; c++) {
      const a = p[i + c] - pMean[c];
      for (let d = 0; d < 3; d++) {
        pq[3 * c + d] += a * (q[i + d] - qMean[d]);
        pp[3 * c + d] += a * (p[i + d] - pMean[d]);
      }
    }
  }
  // Of the rotations alone, for rotations; with their scales, for the affine map; and what a scale is found from.
  const [turns, scaled] = [zero(), zero()];
  let larger = 0;
  for (const { rotation, scale, square } of turned) {
    for (let at = 0; at < 9; at++) {
      const turn = (square / m) * rotation[3 * (at % 3) + Math.floor(at / 3)];
      turns[at] += turn;
      scaled[at] += scale * turn;
    }
    for (const diagonal of [0, 4, 8]) pp[diagonal] += square / m;
    larger += (3 * scale * square) / m;
  }
  const local = plus(pq, turns);
  const size = norm(local);
  const inverse = size > 0 && Number.isFinite(1 / size) ? 1 / size : 0;
  const rotation = bestRotation(local.map((e, at) => e * inverse + (at % 4 === 0 ? ANCHOR_WEIGHT : 0)) as Matrix);
  const extent = pp[0] + pp[4] + pp[8];
  const along = (traceOfProduct(rotation, pq) + larger) / extent;
  const scale = extent > 0 && Number.isFinite(along) ? Math.max(along, 0) : 1;
  return { rotation, scale, linear: linear(pp, plus(pq, scaled), rotation) };
}

function mean(v: ArrayLike<number>, m: number): [number, number, number] {
  const sum: [number, number, number] = [0, 0, 0];
  for (let i = 0; i < 3 * m; i++) sum[i % 3] += v[i] - v[i % 3];
  return [v[0] + sum[0] / m, v[1] + sum[1] / m, v[2] + sum[2] / m];
}

/** `R + (C^T - R P)(P + ridge)^-1`. */
function linear(pp: Matrix, pq: Matrix, rotation: Matrix): Matrix {
  const size = norm(pp);
  if (!(size > 0 && Number.isFinite(size))) return rotation;
  const ridged = pp.map((e, at) => e / size + (at % 4 === 0 ? RIDGE : 0)) as Matrix;
  const l = cholesky(ridged);
  if (!l) return rotation;
  const result = [...rotation] as Matrix;
  for (let r = 0; r < 3; r++) {
    const residual = [0, 1, 2].map((c) => {
      let rest = pq[3 * c + r];
      for (let k = 0; k < 3; k++) rest -= rotation[3 * r + k] * pp[3 * k + c];
      return rest / size;
    });
    solve(l, residual).forEach((e, c) => (result[3 * r + c] += e));
  }
  return result;
}

function cholesky(s: Matrix): Matrix | undefined {
  const l: Matrix = [0, 0, 0, 0, 0, 0, 0, 0, 0];
  for (let r = 0; r < 3; r++) {
    for (let c = 0; c <= r; c++) {
      let rest = s[3 * r + c];
      for (let k = 0; k < c; k++) rest -= l[3 * r + k] * l[3 * c + k];
      if (r !== c) l[3 * r + c] = rest / l[4 * c];
      else if (rest > 0) l[4 * r] = Math.sqrt(rest);
      else return undefined;
    }
  }
  return l;
}

function solve(l: Matrix, b: number[]): number[] {
  const x = [...b];
  for (let r = 0; r < 3; r++) {
    for (let k = 0; k < r; k++) x[r] -= l[3 * r + k] * x[k];
    x[r] /= l[4 * r];
  }
  for (let r = 2; r >= 0; r--) {
    for (let k = r + 1; k < 3; k++) x[r] -= l[3 * k + r] * x[k];
    x[r] /= l[4 * r];
  }
  return x;
}

const zero = (): Matrix => [0, 0, 0, 0, 0, 0, 0, 0, 0];
const plus = (a: Matrix, b: Matrix): Matrix => a.map((e, at) => e + b[at]) as Matrix;
const norm = (m: Matrix): number => Math.hypot(...m);

function traceOfProduct(a: Matrix, b: Matrix): number {
  let trace = 0;
  for (let r = 0; r < 3; r++) for (let k = 0; k < 3; k++) trace += a[3 * r + k] * b[3 * k + r];
  return trace;
}

/** The rotation R that maximises `tr(R C)`. */
export function bestRotation(c: Matrix): Matrix {
  const [w, x, y, z] = largestEigenvector(horn(c));
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
    2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
  ]; // prettier-ignore
}

/** Horn's matrix: `tr(R C) = u^T N u` for the rotation of the unit quaternion `u = (w, x, y, z)`. */
function horn([xx, xy, xz, yx, yy, yz, zx, zy, zz]: Matrix): number[][] {
  return [
    [xx + yy + zz, yz - zy, zx - xz, xy - yx],
    [yz - zy, xx - yy - zz, xy + yx, zx + xz],
    [zx - xz, xy + yx, yy - xx - zz, yz + zy],
    [xy - yx, zx + xz, yz + zy, zz - xx - yy],
  ];
}

/** Cyclic Jacobi rotations. */
function largestEigenvector(n: number[][]): number[] {
  const vectors = n.map((_, i) => n.map((_, j): number => (i === j ? 1 : 0)));
  for (let sweep = 0; sweep < 24; sweep++) {
    let rotated = false;
    for (let i = 0; i < 3; i++) {
      for (let j = i + 1; j < 4; j++) {
        const off = n[i][j];
        if (Math.abs(off) <= 1e-18 * (Math.abs(n[i][i]) + Math.abs(n[j][j]))) continue;
        rotated = true;
        const theta = (n[j][j] - n[i][i]) / (2 * off);
        const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(theta, 1));
        const cos = 1 / Math.hypot(t, 1);
        const sin = t * cos;
        n[i][i] -= t * off;
        n[j][j] += t * off;
        n[i][j] = n[j][i] = 0;
        for (let k = 0; k < 4; k++) {
          if (k !== i && k !== j) {
            const [ki, kj] = [n[k][i], n[k][j]];
            n[i][k] = n[k][i] = cos * ki - sin * kj;
            n[j][k] = n[k][j] = sin * ki + cos * kj;
          }
          const [vi, vj] = [vectors[k][i], vectors[k][j]];
          vectors[k][i] = cos * vi - sin * vj;
          vectors[k][j] = sin * vi + cos * vj;
        }
      }
    }
    if (!rotated) break;
  }
  let largest = 0;
  for (let i = 1; i < 4; i++) if (n[i][i] > n[largest][largest]) largest = i;
  const u = vectors.map((row) => row[largest]);
  const length = Math.hypot(...u);
  return u.map((e) => e / length);
}
