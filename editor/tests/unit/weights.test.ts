/** When weights are fitted, and which frames the core computes: with a core that only counts. */

import { beforeEach, describe, expect, it, vi } from "vitest";
import { initialState, type State } from "../../src/app/state.ts";
import { Store } from "../../src/app/store.ts";
import { Weights } from "../../src/app/weights.ts";
import { addPoint, History, nudge, select, set } from "../../src/commands/index.ts";
import type { Vec3 } from "../../src/model/vec3.ts";
import type { Core, SessionDocument } from "../../src/worker/protocol.ts";
import { defaults, EMPTY_SESSION } from "./core.ts";

const box = { centre: [0, 0, 0] as Vec3, half: 1 };
const array = (length = 0) => new Float64Array(length);

/** An editor without a view. */
function start({ holds = true, refuses = false } = {}) {
  const fits: SessionDocument[] = [];
  const frames: SessionDocument[] = [];
  const shown: string[] = [];
  let [running, most] = [0, 0];
  let hold: Promise<void> = Promise.resolve();
  const core = {
    async fit(session: SessionDocument) {
      fits.push(session);
      if (refuses && session.settings!.relax > 0) throw new Error("relax: refused");
      return { logits: new Float32Array(1), ownLogits: new Float32Array(1), loss: null, steps: 0, milliseconds: { train: 0, evaluate: 0 } };
    },
    handles: async () => ({ squares: array(), aim: () => ({}), free() {} }),
    async deform(session: SessionDocument) {
      most = Math.max(most, ++running);
      await hold;
      frames.push(session);
      running--;
      return { positions: array(), maps: array() };
    },
    report: async (session: SessionDocument) => ({ places: [], distances: session.control_points.map(() => 0), handles: "", soft: null, warnings: [] }),
  } as unknown as Core;
  const history = new History(EMPTY_SESSION);
  const store = new Store<State>({ ...initialState(defaults, "system"), shape: { opened: { dim: 3 } } as never });
  const weights = new Weights(core, history, store, () => holds);
  weights.showFrame = (slot) => shown.push(slot);
  const settled = async () => {
    await new Promise((resolve) => setTimeout(resolve));
    await weights.settled();
  };
  history.execute(addPoint({ position: [0, 0, 0], target: [0, 0, 0] }, box));
  const slowly = (wait: Promise<void>) => (hold = wait);
  return { history, store, weights, fits, frames, shown, settled, slowly, most: () => most };
}

describe("relax", () => {
  let editor: ReturnType<typeof start>;
  beforeEach(async () => {
    editor = start();
    await editor.settled();
    expect([editor.fits.length, editor.frames.length]).toEqual([1, 0]);
  });

  it("needs one fit as it leaves 0, and none as it slides or goes back", async () => {
    const { history, fits, frames, shown, settled } = editor;
    for (const relax of [0.25, 0.5, 1, 0, 0.75]) {
      history.execute(set("relax", relax));
      await settled();
      expect(fits).toHaveLength(2);
    }
    history.undo(); // all of the slider
    history.redo();
    await settled();
    expect(fits).toHaveLength(2);
    expect(fits[1].settings!.relax).toBe(0.25);
    expect(frames.map((frame) => frame.settings!.relax)).toEqual([0.25, 0.5, 1, 0.75, 0.75]);
    expect(shown).toEqual(frames.map(() => "main"));
  });

  it("is fitted anew with other control points, and without it where it is 0", async () => {
    const { history, fits, settled } = editor;
    history.execute(set("relax", 1));
    await settled();
    for (const relax of [1, 0]) {
      history.execute(set("relax", relax));
      history.execute(addPoint({ position: [relax, 1, 0], target: [relax, 1, 0] }, box));
      await settled();
      expect(fits.at(-1)!.settings!.relax).toBe(relax);
    }
    expect(fits).toHaveLength(4);
  });

  it("draws a frame at a time while dragging, and always the last one", async () => {
    const { history, frames, settled, slowly, most } = editor;
    history.execute(set("relax", 1));
    history.execute(select([1]));
    await settled();
    frames.length = 0;
    let release = (): void => {};
    slowly(new Promise((resolve) => (release = resolve)));
    history.begin("Move");
    for (let y = 1; y <= 20; y++) {
      history.preview((session) => nudge("target", [0, y, 0]).apply(session));
      await null;
    }
    release();
    history.commit();
    await settled();
    expect(most()).toBe(1);
    expect(frames.length).toBeLessThan(5);
    expect(frames.at(-1)!.control_points[0].target).toEqual([0, 20, 0]);
  });
});

it("that is refused leaves the shape as fast as before when it is 0 again", async () => {
  const { history, store, fits, frames, settled } = start({ refuses: true });
  await settled();
  history.execute(set("relax", 1));
  await settled();
  expect(store.value.fit).toEqual({ status: "failed", reason: "relax: refused" });
  history.execute(set("relax", 0));
  await settled();
  expect(store.value.fit.status).toBe("ready");
  expect([fits.length, frames.length]).toEqual([3, 0]);
});

it("frames are the core's where the graphics card does not hold the weights", async () => {
  const { history, store, frames, settled } = start({ holds: false });
  await settled();
  expect(store.value.slowFrames).toBe(true);
  history.execute(set("temperature", 2));
  await settled();
  await vi.waitFor(() => expect(frames.map((frame) => frame.settings!.temperature)).toEqual([1, 2]));
});
