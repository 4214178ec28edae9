import { describe, expect, it } from "vitest";
import { History, resetTargets, turnSelected } from "../../src/commands/index.ts";
import { formatSession, parseSession } from "../../src/model/controlPointFile.ts";
import { type ControlPoint, EMPTY_SESSION, isMoved, type Session } from "../../src/model/session.ts";
import { mirrorTurn, quaternionOf, rotationOf, type Turn, turnedBy, turnsOf } from "../../src/model/turn.ts";
import { isStill, turnedPoints } from "../../src/shader/turned.ts";

const turn: Turn = { axis: [1, -2, 0.5], degrees: 75, scale: 1.5 };
const point = (id: number, more: Partial<ControlPoint> = {}): ControlPoint => ({
  id,
  name: `p${id}`,
  position: [id, 0, 0],
  target: [id, 0, 0],
  locked: false,
  ...more,
});
const close = (a: readonly number[], b: readonly number[]): void => a.forEach((e, at) => expect(e).toBeCloseTo(b[at]!, 12));
const product = (a: readonly number[], b: readonly number[]): number[] =>
  a.map((_, at) => [0, 1, 2].reduce((sum, k) => sum + a[3 * Math.floor(at / 3) + k]! * b[3 * k + (at % 3)]!, 0));

describe("a turn", () => {
  it("is counterclockwise, seen from the tip of its axis", () => {
    close(rotationOf({ axis: [0, 0, 3], degrees: 90, scale: 1 }), [0, -1, 0, 1, 0, 0, 0, 0, 1]);
    close([...(turnsOf([{ axis: [0, 0, 3], degrees: -270, scale: 2 }]).turns ?? [])], [0, -2, 0, 2, 0, 0, 0, 0, 2]);
  });

  it("by nothing is nothing to the last bit", () => {
    expect(turnedPoints(Float64Array.of(0, 0, 0), [{ ...turn, degrees: 0, scale: 1 }]).every(isStill)).toBe(true);
  });

  it("turned further is the product of both, whatever the angle", () => {
    for (const degrees of [0, 1e-9, 30, 180, 200, -359, 1000]) {
      const by: Turn = { axis: [0.3, 0.1, -1], degrees, scale: 1 };
      const found = turnedBy(turn, quaternionOf(by));
      close(rotationOf(found), product(rotationOf(by), rotationOf(turn)));
      expect(found.scale).toBe(1.5);
      expect(found.degrees).toBeLessThanOrEqual(180);
    }
    expect(turnedBy({ ...turn, degrees: -40 }, quaternionOf({ ...turn, degrees: 40 })).degrees).toBeCloseTo(0, 9);
  });

  it("mirrored is the rotation between two mirrors", () => {
    const mirror = [-1, 0, 0, 0, 1, 0, 0, 0, 1];
    close(rotationOf(mirrorTurn(turn, "x")), product(mirror, product(rotationOf(turn), mirror)));
  });

  it("is written and read again, bit for bit, in each dimension", () => {
    const kept: [1 | 2 | 3, Turn][] = [[3, turn], [2, { ...turn, axis: [0, 0, 1] }], [1, { axis: [0, 0, 1], degrees: 0, scale: 1.5 }]];
    for (const [dim, turn] of kept) {
      const session: Session = { ...EMPTY_SESSION, points: [point(1, { turn }), point(2)] };
      expect(parseSession(formatSession(session, dim), dim).points).toEqual(session.points);
    }
  });

  it.each([
    ['"rotation": {"degrees": 40}', "control_points[0].rotation.axis: expected a list of 3 finite numbers, found nothing"],
    ['"rotation": {"axis": [0, 0, 0], "degrees": 40}', "not all 0"],
    ['"rotation": {"axis": [0, 0, 1]}', "control_points[0].rotation.degrees: expected a finite number, found nothing"],
    ['"scale": -1', "control_points[0].scale: expected a number above 0, found -1"],
  ])("that is none is refused: %s", (keys, words) => {
    const text = `{"format": "neuralmls-control-points", "version": 1, "control_points": [{"name": "a", "position": [0, 0, 0], ${keys}}]}`;
    expect(() => parseSession(text, 3)).toThrow(words);
  });
});

describe("turning", () => {
  const by = quaternionOf({ axis: [0, 1, 0], degrees: 40, scale: 1 });

  it("turns one that is alone, and of several those that are turned already; locked ones stay", () => {
    const points = [point(1), point(2, { turn }), point(3, { turn, locked: true })];
    const turned = (selection: number[]) =>
      turnSelected({ ...EMPTY_SESSION, points, selection }, by).points.map((after, i) => after !== points[i]);
    expect(turned([1])).toEqual([true, false, false]);
    expect(turned([1, 2, 3])).toEqual([false, true, false]);
    expect(turned([3])).toEqual([false, false, false]);
  });

  it("is one step of undo, and a reset takes it back", () => {
    const history = new History({ ...EMPTY_SESSION, points: [point(1)], selection: [1] });
    const before = history.session;
    history.begin("Move");
    history.preview((session) => turnSelected(session, by));
    history.preview((session) => turnSelected(turnSelected(session, by), by));
    history.commit();
    expect(history.session.points[0].turn?.degrees).toBeCloseTo(80, 9);
    expect(isMoved(history.session.points[0])).toBe(true);
    history.execute(resetTargets("all"));
    expect(history.session.points).toEqual(before.points);
    history.undo();
    history.undo();
    expect(history.session).toBe(before);
  });
});
