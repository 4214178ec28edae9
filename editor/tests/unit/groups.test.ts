import { describe, expect, it } from "vitest";
import { addPoints, group, History, nudge, placeAnew, put, removeSelected, resetTargets, select, selectNext, toggleLock, ungroup } from "../../src/commands/index.ts";
import { stays } from "../../src/model/session.ts";
import type { Vec3 } from "../../src/model/vec3.ts";
import { EMPTY_SESSION } from "./core.ts";

function history(): History {
  const made = new History(EMPTY_SESSION);
  const places: Vec3[] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]];
  made.execute(addPoints(places.map((position) => ({ position, target: position }))));
  made.execute(group([1, 2]));
  return made;
}

const targets = (h: History): number[] => h.session.points.map(({ target }) => target[1]);

describe("a group", () => {
  it("has a name of its own, and is undone and parted", () => {
    const h = history();
    h.execute(group([3, 4]));
    expect(h.session.points.map((point) => point.group)).toEqual(["group 1", "group 1", "group 2", "group 2"]);
    h.undo();
    h.execute(ungroup([1]));
    expect(h.session.points.map((point) => point.group)).toEqual([undefined, "group 1", undefined, undefined]);
    const one = h.session;
    h.execute(group([4]));
    expect(h.session).toBe(one);
  });

  it("is selected whole, and what was asked for leads", () => {
    const h = history();
    h.execute(select([1]));
    expect(h.session.selection).toEqual([2, 1]);
    h.execute(select([3], "add"));
    expect(h.session.selection).toEqual([2, 1, 3]);
    h.execute(select([2], "toggle"));
    expect(h.session.selection).toEqual([3]);
    h.execute(selectNext(-1));
    expect(h.session.selection).toEqual([1, 2]);
  });

  it("moves with one of it, by hand and by numbers", () => {
    const h = history();
    h.execute(select([2]));
    h.execute(nudge("target", [0, 1, 0]));
    expect(targets(h)).toEqual([1, 1, 0, 0]);
    h.execute(put(1, "target", [0, 0.1, 0]));
    expect(targets(h)[0]).toBe(0.1);
    expect(targets(h)[1]).toBeCloseTo(0.1, 12);
    h.execute(resetTargets("all"));
    expect(targets(h)).toEqual([0, 0, 0, 0]);
  });

  it("stays whole where one of it is locked", () => {
    const h = history();
    h.execute(toggleLock([1]));
    expect(h.session.points.map((point) => stays(h.session, point))).toEqual([true, true, false, false]);
    h.execute(select([2, 3]));
    h.execute(nudge("target", [0, 1, 0]));
    expect(targets(h)).toEqual([0, 0, 1, 0]);
  });

  it("does not give way to control points that are placed anew", () => {
    const h = history();
    h.execute(placeAnew([{ position: [9, 0, 0], target: [9, 0, 0] }]));
    expect(h.session.points.map(({ id }) => id)).toEqual([1, 2, 3]);
    h.execute(select([1]));
    h.execute(removeSelected());
    expect(h.session.points).toHaveLength(1);
  });
});
