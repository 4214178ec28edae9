import { describe, expect, it } from "vitest";
import { History, resetTargets, rotateSelected } from "../../src/commands/index.ts";
import { mirrorOrientation } from "../../src/model/mirror.ts";
import { type Orientation, orientationsOf, quaternionOf, rotatedBy, rotationOf } from "../../src/model/orientation.ts";
import { type ControlPoint, isMoved } from "../../src/model/session.ts";
import { isStill, orientedPoints } from "../../src/shader/oriented.ts";
import { EMPTY_SESSION } from "./core.ts";

const orientation: Orientation = { axis: [1, -2, 0.5], degrees: 75, scale: 1.5 };
const point = (id: number, more: Partial<ControlPoint> = {}): ControlPoint => ({
  id,
  name: `p${id}`,
  position: [id, 0, 0],
  target: [id, 0, 0],
  weight: 1,
  locked: false,
  ...more,
});
const close = (a: readonly number[], b: readonly number[]): void => a.forEach((e, at) => expect(e).toBeCloseTo(b[at]!, 12));
const product = (a: readonly number[], b: readonly number[]): number[] =>
  a.map((_, at) => [0, 1, 2].reduce((sum, k) => sum + a[3 * Math.floor(at / 3) + k]! * b[3 * k + (at % 3)]!, 0));

describe("an orientation", () => {
  it("is counterclockwise, seen from the tip of its axis", () => {
    close(rotationOf({ axis: [0, 0, 3], degrees: 90, scale: 1 }), [0, -1, 0, 1, 0, 0, 0, 0, 1]);
    close([...(orientationsOf([{ axis: [0, 0, 3], degrees: -270, scale: 2 }]) ?? [])], [0, -2, 0, 2, 0, 0, 0, 0, 2]);
  });

  it("by nothing is nothing to the last bit", () => {
    expect(orientedPoints(orientationsOf([{ ...orientation, degrees: 0, scale: 1 }])!, Float64Array.of(1), 1).every(isStill)).toBe(true);
  });

  it("rotated further is the product of both, whatever the angle", () => {
    for (const degrees of [0, 1e-9, 30, 180, 200, -359, 1000]) {
      const by: Orientation = { axis: [0.3, 0.1, -1], degrees, scale: 1 };
      const found = rotatedBy(orientation, quaternionOf(by));
      close(rotationOf(found), product(rotationOf(by), rotationOf(orientation)));
      expect(found.scale).toBe(1.5);
      expect(found.degrees).toBeLessThanOrEqual(180);
    }
    expect(rotatedBy({ ...orientation, degrees: -40 }, quaternionOf({ ...orientation, degrees: 40 })).degrees).toBeCloseTo(0, 9);
  });

  it("mirrored is the rotation between two mirrors", () => {
    const mirror = [-1, 0, 0, 0, 1, 0, 0, 0, 1];
    close(rotationOf(mirrorOrientation(orientation, "x")), product(mirror, product(rotationOf(orientation), mirror)));
  });
});

describe("rotating", () => {
  const by = quaternionOf({ axis: [0, 1, 0], degrees: 40, scale: 1 });

  it("rotates one that is alone, and of several those that are oriented already; locked ones stay", () => {
    const points = [point(1), point(2, { orientation }), point(3, { orientation, locked: true })];
    const rotated = (selection: number[]) =>
      rotateSelected({ ...EMPTY_SESSION, points, selection }, by).points.map((after, i) => after !== points[i]);
    expect(rotated([1])).toEqual([true, false, false]);
    expect(rotated([1, 2, 3])).toEqual([false, true, false]);
    expect(rotated([3])).toEqual([false, false, false]);
  });

  it("is one step of undo, and a reset takes it back", () => {
    const history = new History({ ...EMPTY_SESSION, points: [point(1)], selection: [1] });
    const before = history.session;
    history.begin("Move");
    history.preview((session) => rotateSelected(session, by));
    history.preview((session) => rotateSelected(rotateSelected(session, by), by));
    history.commit();
    expect(history.session.points[0].orientation?.degrees).toBeCloseTo(80, 9);
    expect(isMoved(history.session.points[0])).toBe(true);
    history.execute(resetTargets("all"));
    expect(history.session.points).toEqual(before.points);
    history.undo();
    history.undo();
    expect(history.session).toBe(before);
  });
});
