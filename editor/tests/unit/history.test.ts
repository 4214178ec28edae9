import { describe, expect, it } from "vitest";
import { addPoint, History, moveSelected, nudge, removeSelected, rename, select, set, setWeights, toggleLock } from "../../src/commands/index.ts";
import type { Session } from "../../src/model/session.ts";
import { add, type Vec3 } from "../../src/model/vec3.ts";
import { EMPTY_SESSION } from "./core.ts";

const box = { centre: [0, 0, 0] as Vec3, half: 1 };
const at = (x: number, y = 0, z = 0): Vec3 => [x, y, z];

function withPoints(...places: Vec3[]): History {
  const history = new History(EMPTY_SESSION);
  for (const position of places) history.execute(addPoint({ position, target: position }, box));
  return history;
}

const targets = (session: Session): Vec3[] => session.points.map((point) => point.target);

describe("history", () => {
  it("undoes and redoes every kind of command", () => {
    const history = withPoints(at(-0.5), at(0.5));
    const before: Session[] = [];
    const commands = [
      select([1]),
      nudge("target", at(0, 1)),
      nudge("position", at(0, 0, 1)),
      rename(1, "head"),
      toggleLock([1]),
      set("temperature", 0.5),
      set("handles", 0.5),
      set("relax", 0.5),
      set("kind", "inverse-distance"),
      setWeights("inverse-distance", { alpha: 2 }),
      setWeights("neural", { seed: 3 }),
      select([1, 2]),
      removeSelected(),
    ];
    for (const command of commands) {
      before.push(history.session);
      history.execute(command);
      expect(history.session, command.label).not.toBe(before.at(-1));
    }
    const last = history.session;
    for (const session of before.reverse()) {
      history.undo();
      expect(history.session).toBe(session);
    }
    for (const _ of commands) history.redo();
    expect(history.session).toBe(last);
  });

  it("makes one step of a drag of several points", () => {
    const history = withPoints(at(-0.5), at(0.5));
    history.execute(select([1, 2]));
    const before = history.session;
    history.begin("Move");
    for (const y of [0.1, 0.2, 0.3]) history.preview((s) => moveSelected(s, "target", (place) => add(place, at(0, y))));
    history.commit();
    expect(targets(history.session)).toEqual([at(-0.5, 0.3), at(0.5, 0.3)]);
    history.undo();
    expect(history.session).toBe(before);
    history.redo();
    expect(targets(history.session)).toEqual([at(-0.5, 0.3), at(0.5, 0.3)]);
  });

  it("takes a cancelled drag back and leaves no step", () => {
    const history = withPoints(at(0.5));
    const { session, undoLabel } = history;
    history.begin("Move");
    history.preview((s) => moveSelected(s, "target", (place) => add(place, at(1))));
    history.cancel();
    history.commit();
    expect(history.session).toBe(session);
    expect(history.undoLabel).toBe(undoLabel);
  });

  it("makes one step of a slider, and two after it was let go", () => {
    const history = new History(EMPTY_SESSION);
    for (const t of [0.9, 0.8, 0.7]) history.execute(set("temperature", t));
    history.seal();
    history.execute(set("temperature", 0.6));
    history.undo();
    expect(history.session.settings.temperature).toBe(0.7);
    history.undo();
    expect(history.session).toBe(EMPTY_SESSION);
  });

  it("records nothing where nothing changes", () => {
    const history = withPoints(at(0.5));
    const { undoLabel } = history;
    history.execute(set("temperature", 1));
    history.execute(rename(1, "  "));
    history.execute(select([1]));
    history.execute(addPoint({ position: at(0.5), target: at(0.5) }, box));
    expect(history.undoLabel).toBe(undoLabel);
  });

  it("forgets what was undone when something else is done", () => {
    const history = withPoints(at(0.5), at(0.6));
    history.undo();
    history.execute(set("transform", "affine"));
    history.redo();
    expect(history.session.points).toHaveLength(1);
    expect(history.redoLabel).toBeUndefined();
  });
});
