/** What the shader has of the core: where to aim, and the map that fits all control points with equal weights. */

import { describe, expect, it } from "vitest";
import { type SessionDocument, toDocument } from "../../src/model/document.ts";
import type { Aim } from "../../src/model/handles.ts";
import { type Orientation, orientationsOf, rotationOf } from "../../src/model/orientation.ts";
import { orientedPoints } from "../../src/shader/oriented.ts";
import type { Settings } from "../../src/model/settings.ts";
import { pointAt } from "../../src/model/vec3.ts";
import { createHandles } from "../../src/worker/handles.ts";
import { defaults, EMPTY_SESSION } from "./core.ts";

type Matrix = number[];
const IDENTITY: Matrix = [1, 0, 0, 0, 1, 0, 0, 0, 1];
const soft: Settings = { ...defaults, handles: "soft" };

/** Numbers from a seed. */
function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 31 - 1;
  };
}

function rotation([w, x, y, z]: number[]): Matrix {
  const l = Math.hypot(w, x, y, z);
  [w, x, y, z] = [w / l, x / l, y / l, z / l];
  return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
}

function documentOf(p: readonly number[], dim: 1 | 2 | 3): SessionDocument {
  const points = Array.from({ length: p.length / 3 }, (_, i) => {
    const position = pointAt(p, i);
    return { id: i, name: `p${i}`, position, target: position, weight: 1, locked: false };
  });
  return toDocument({ ...EMPTY_SESSION, points }, dim);
}

/** The anchor of control points `p` that are moved to `q`, m x 3 each. */
function anchor(p: readonly number[], q: readonly number[], oriented: readonly (Orientation | undefined)[] = [], dim: 1 | 2 | 3 = 3): Aim {
  const m = p.length / 3;
  const own = Float32Array.from({ length: m * m }, (_, at) => (at % (m + 1) === 0 ? 6 : 0));
  const handles = createHandles(documentOf(p, dim), dim, own);
  const aim = handles.aim(Float64Array.from(q), orientationsOf(oriented), soft, []);
  handles.free();
  return aim;
}

const apply = (m: Matrix, points: number[]): number[] =>
  points.map((_, at) => [0, 1, 2].reduce((sum, k) => sum + m[3 * (at % 3) + k] * points[3 * Math.floor(at / 3) + k], 0));
const close = (found: ArrayLike<number>, expected: ArrayLike<number>, digits = 6): void =>
  // It goes to the shader in single precision.
  Array.from(expected).forEach((e, i) => expect(found[i]).toBeCloseTo(e, digits));

describe("the anchor", () => {
  const next = random(7);
  const points = (m: number): number[] => Array.from({ length: 3 * m }, next);

  it("of a rigid motion is its rotation, and the scale is 1", () => {
    const [p, turn] = [points(5), rotation([next(), next(), next(), next()])];
    const found = anchor(p, apply(turn, p).map((c, at) => c + [3, -2, 1][at % 3]));
    close(found.rotation, turn);
    close(found.linear, turn);
    expect(found.scale).toBeCloseTo(1, 9);
  });

  it("of an affine motion is its linear part", () => {
    const [p, map] = [points(6), points(3)];
    close(anchor(p, apply(map, p)).linear, map);
  });

  it("of a scaling is the scale", () => {
    const p = points(4);
    expect(anchor(p, p.map((c) => 2.5 * c)).scale).toBeCloseTo(2.5, 9);
  });

  it("of one, two or aligned control points that only shift is the identity", () => {
    // Numbers that shift without rounding: along what is open, an error of 1e-16 counts against a ridge of 1e-12.
    for (const p of [[0.25, 0.5, -0.75], [0.25, 0.5, -0.75, 1, -2, 0.5], [0, 0, 0, 1, 2, 3, 2, 4, 6]]) {
      const found = anchor(p, p.map((c) => c + 0.5));
      close(found.rotation, IDENTITY);
      close(found.linear, IDENTITY);
    }
  });

  it("of one that is oriented is as that", () => {
    const orientation: Orientation = { axis: [1, -2, 0.5], degrees: 75, scale: 1.5 };
    const found = anchor([1, 2, 3], [1, 2, 3], [orientation]);
    close(found.rotation, rotationOf(orientation));
    close(found.linear, rotationOf(orientation).map((e) => 1.5 * e));
    expect(found.scale).toBeCloseTo(1.5, 9);
  });

  it("is never a reflection", () => {
    const p = points(6);
    const [a, b, c, d, e, f, g, h, i] = anchor(p, p.map((v, at) => (at % 3 === 0 ? -v : v))).rotation;
    expect(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)).toBeCloseTo(1, 6);
  });

  it("uses the rotation that no random one beats", () => {
    const [p, q] = [points(6), points(6)];
    const centred = (v: number[]): number[] => v.map((c, at) => c - v.reduce((sum, e, k) => sum + (k % 3 === at % 3 ? e / 6 : 0), 0));
    const [a, b] = [centred(p), centred(q)];
    // tr(R C) is the sum of the products of the targets with the rotated control points.
    const value = (r: ArrayLike<number>): number => apply(Array.from(r), a).reduce((sum, c, at) => sum + c * b[at], 0);
    const best = value(anchor(p, q).rotation);
    for (let i = 0; i < 200; i++) expect(value(rotation([next(), next(), next(), next()]))).toBeLessThanOrEqual(best + 1e-6);
  });

  it("of a shape in the plane stays in it", () => {
    const p = [0, 0, 0, 1, 0, 0, 0, 2, 0];
    const found = anchor(p, [0, 0, 0, 0, 1, 0, -2, 0, 0], [], 2);
    close(found.rotation, [0, -1, 0, 1, 0, 0, 0, 0, 1]);
    close(found.linear, found.rotation);
  });
});

describe("handles", () => {
  const p = [0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3];
  const q = [0, 0, 0, 1, 0.5, 0, 0, 2, 0, 0.5, 0, 3];

  it("that are soft aim at their targets; others past them, and a change of the settings is heard", () => {
    const own = Float32Array.from({ length: 16 }, (_, at) => (at % 5 === 0 ? 3 : 0));
    const handles = createHandles(documentOf(p, 3), 3, own);
    const aim = (settings: Settings) => [...handles.aim(Float64Array.from(q), undefined, settings, []).targets];
    const [auto, near, half] = [aim(defaults), aim(soft), aim({ ...defaults, handles: 0.5 })];
    expect(near).toEqual(q);
    const farthest = (found: number[]) => Math.max(...found.map((c, at) => Math.abs(c - q[at])));
    expect(farthest(auto)).toBeGreaterThan(1e-3);
    expect(farthest(half)).toBeGreaterThan(1e-4);
    expect(farthest(half)).toBeLessThan(farthest(auto));
    expect(aim(defaults)).toEqual(auto);
    handles.free();
  });

  it("know how far the nearest other one is", () => {
    const handles = createHandles(documentOf(p, 3), 3, new Float32Array(16));
    close(handles.squares, [1, 1, 4, 9]);
    handles.free();
  });
});

describe("what is held", () => {
  const p = [0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0];
  const own = Float32Array.from({ length: 16 }, (_, at) => (at % 5 === 0 ? 6 : 0));
  const free = { locked: false };
  const piece = { locked: false, group: "seat" };
  const locked = { locked: true };

  it("moves as one piece with its group, or stays; a change of it is heard", () => {
    const handles = createHandles(documentOf(p, 3), 3, own);
    // A quarter turn about z of what would also grow.
    const q = Float64Array.of(0, 0, 0, 0, 2, 0, -2, 0, 0, 5, 3, 0);
    const aim = (holds: readonly (typeof piece | typeof free)[]) => {
      const { targets, orientations } = handles.aim(q, undefined, soft, holds);
      return { targets: [...targets], orientations: [...orientations] };
    };
    const loose = aim([free, free, free, free]);
    expect(loose.targets).toEqual([...q]);
    expect(loose.orientations.every(Number.isNaN)).toBe(true);
    const grouped = aim([piece, piece, piece, free]);
    const distance = (i: number, k: number) => Math.hypot(...[0, 1, 2].map((c) => grouped.targets[3 * i + c] - grouped.targets[3 * k + c]));
    close([distance(0, 1), distance(0, 2), distance(1, 2)], [1, 1, Math.SQRT2]);
    for (const i of [0, 1, 2]) close(grouped.orientations.slice(9 * i, 9 * i + 9), [0, -1, 0, 1, 0, 0, 0, 0, 1]);
    expect(grouped.targets.slice(9)).toEqual([5, 3, 0]);
    const held = aim([free, free, free, locked]);
    expect(held.targets).toEqual([...q.slice(0, 9), 5, 0, 0]);
    expect(orientedPoints(Float64Array.from(held.orientations), handles.squares, 1).map(({ index }) => index)).toEqual([3]);
    expect(aim([free, free, free, free])).toEqual(loose);
    handles.free();
  });
});
