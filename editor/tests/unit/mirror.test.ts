import { describe, expect, it } from "vitest";
import { addPoint, addPoints, History, moveSelected, nudge, pair, placeAnew, put, resetTargets, select, setMirror, toggleLock, unpair } from "../../src/commands/index.ts";
import type { Vec3 } from "../../src/model/vec3.ts";
import { EMPTY_SESSION } from "./core.ts";

const box = { centre: [10, 0, 0] as Vec3, half: 1 };

function history(...places: Vec3[]): History {
  const made = new History(EMPTY_SESSION);
  made.execute(addPoints(places.map((position) => ({ position, target: position }))));
  return made;
}

describe("mirror", () => {
  it("finds twins across the middle of the shape, and lets a move of one move the other", () => {
    const h = history([9.5, 1, 0], [10.5, 1, 0], [10, 0, 0], [10.9, -1, 0]);
    h.execute(setMirror("x", box));
    expect(h.session.pairs).toEqual([[1, 2]]);
    h.execute(put(1, "target", [9.2, 1.5, 0.25]));
    expect(h.session.points[1].target).toEqual([10.8, 1.5, 0.25]);
    expect(h.session.points[3].target).toEqual([10.9, -1, 0]);
    h.undo();
    expect(h.session.points[1].target).toEqual([10.5, 1, 0]);
  });

  it("lets the leader lead where both twins are selected", () => {
    const h = history([9.5, 0, 0], [10.5, 0, 0]);
    h.execute(setMirror("x", box));
    h.execute(select([2, 1]));
    h.execute(nudge("target", [-0.25, 0, 0]));
    expect(h.session.points.map((point) => point.target[0])).toEqual([9.25, 10.75]);
  });

  it("adds a twin with a new control point, but not on the plane", () => {
    const h = history([10, 1, 0]);
    h.execute(setMirror("x", box));
    h.execute(addPoint({ position: [9.25, 0, 0], target: [9.25, 0.5, 0] }, box));
    expect(h.session.points.map((point) => point.position)).toEqual([[10, 1, 0], [9.25, 0, 0], [10.75, 0, 0]]);
    expect(h.session.points[2].target).toEqual([10.75, 0.5, 0]);
    h.execute(addPoint({ position: [10, -1, 0], target: [10, -1, 0] }, box));
    expect(h.session.points).toHaveLength(4);
  });

  it("has pairs that can be edited; each control point has one twin", () => {
    const h = history([9, 0, 0], [11, 0, 0], [12, 0, 0]);
    h.execute(pair(1, 2));
    h.execute(pair(3, 2));
    expect(h.session.pairs).toEqual([[3, 2]]);
    h.execute(unpair(2));
    expect(h.session.pairs).toEqual([]);
  });
});

describe("moves", () => {
  it("pass over locked control points", () => {
    const h = history([0, 0, 0], [1, 0, 0]);
    h.execute(toggleLock([1]));
    h.execute(select([1, 2]));
    h.execute(nudge("target", [0, 1, 0]));
    expect(h.session.points.map((point) => point.target)).toEqual([[0, 0, 0], [1, 1, 0]]);
  });

  it("of places at rest keep the displacement", () => {
    const h = history([0, 0, 0], [1, 0, 0]);
    h.execute(put(1, "target", [0, 1, 0]));
    h.execute(put(1, "position", [0, 0, 2]));
    expect(h.session.points[0]).toMatchObject({ position: [0, 0, 2], target: [0, 1, 2] });
    h.execute(put(1, "position", [1, 0, 0]));
    expect(h.session.points[0].position).toEqual([0, 0, 2]);
  });

  it("reset to the places at rest", () => {
    const h = history([0, 0, 0], [1, 0, 0]);
    h.execute(select([1, 2]));
    const moved = moveSelected(h.session, "target", ([x, y, z]) => [x + 1, y, z]);
    expect(resetTargets("all").apply(moved).points).toEqual(h.session.points);
  });

  it("ignore what is no number", () => {
    const h = history([0, 0, 0]);
    const { session } = h;
    h.execute(put(1, "target", [Number.NaN, 0, 0]));
    expect(h.session).toBe(session);
  });
});

describe("placing anew", () => {
  it("keeps what is moved or locked, and lets the rest give way", () => {
    const h = history([0, 0, 0], [1, 0, 0], [2, 0, 0]);
    h.execute(put(1, "target", [0, 1, 0]));
    h.execute(toggleLock([2]));
    h.execute(placeAnew([[5, 0, 0], [6, 0, 0]].map((position) => ({ position: position as unknown as Vec3, target: position as unknown as Vec3 }))));
    expect(h.session.points.map((point) => point.position[0])).toEqual([0, 1, 5, 6]);
    expect(new Set(h.session.points.map((point) => point.name)).size).toBe(4);
  });
});
