import { describe, expect, it } from "vitest";
import { setMirror } from "../../src/commands/index.ts";
import { fromDocument, type SessionDocument, toDocument } from "../../src/model/document.ts";
import type { Orientation } from "../../src/model/orientation.ts";
import type { Session } from "../../src/model/session.ts";
import { readSession, withSession } from "../../src/worker/sessions.ts";
import { defaults, EMPTY_SESSION } from "./core.ts";

const session: Session = {
  points: [
    { id: 1, name: "seat", position: [0.1, 0.2, 1 / 3], target: [0.1, 0.2, 1 / 3], weight: 0.25, locked: true, group: "legs", others: { mine: [1] } },
    { id: 2, name: 'a "b", é', position: [1e-300, -5e5, 0], target: [0.1 + 0.2, 2, 3], orientation: { axis: [1, -2, 0.5], degrees: 75, scale: 1.5 }, weight: 1, locked: false },
  ],
  selection: [],
  pairs: [[1, 2]],
  settings: {
    ...defaults,
    kind: "inverse-distance",
    weights: { ...defaults.weights, "inverse-distance": { alpha: 2, epsilon: 0.01 } },
    temperature: 0.3,
    handles: 0.25,
    relax: 0.75,
    mirror: "z",
  },
  frame: { min: [-1, -1, -1], max: [1, 1, 2] },
  others: { theirs: "kept", editor: { camera: 7 } },
};

const bytes = (text: string): Uint8Array => new TextEncoder().encode(text);
const box = (dim: number) => ({ min: new Float64Array(dim).fill(-1), max: new Float64Array(dim).fill(1) });

/** Through the text of a file and the core, there and back. */
function written(session: Session, dim: 1 | 2 | 3): { text: string; read: Session } {
  const text = withSession(toDocument(session, dim), (session) => session.to_json());
  const { document } = readSession(new Map([["a.json", bytes(text)]]), ["a.json"], box(dim));
  return { text, read: fromDocument(document, defaults) };
}

const read = (text: string, name = "a.json", dim = 3) => readSession(new Map([[name, bytes(text)]]), [name], box(dim));

describe("a session file", () => {
  it("written and read again says the same, bit for bit, with what others wrote into it", () => {
    expect(written(session, 3).read).toEqual(session);
  });

  it("is version 2, one control point a line", () => {
    const { text } = written(session, 3);
    const document = JSON.parse(text) as SessionDocument;
    expect(document).toMatchObject({ format: "neuralmls-control-points", version: 2, theirs: "kept", editor: { camera: 7, mirror: "z" } });
    expect(document.control_points[0]).toEqual({ name: "seat", position: [0.1, 0.2, 1 / 3], target: [0.1, 0.2, 1 / 3], weight: 0.25, locked: true, group: "legs", mine: [1] });
    expect(document.control_points[1].mirror_of).toBe("seat");
    expect(document.settings).toMatchObject({ weights: { kind: "inverse-distance", alpha: 2, epsilon: 0.01 }, temperature: 0.3, handles: 0.25, relax: 0.75 });
    expect(text.split("\n").filter((line) => line.includes('"name"'))).toHaveLength(2);
  });

  it("keeps orientations in each dimension; in the plane they go round one axis", () => {
    const kept: [1 | 2 | 3, Orientation, Orientation?][] = [
      [3, { axis: [1, -2, 0.5], degrees: 75, scale: 1.5 }],
      [2, { axis: [0, 0, 1], degrees: 75, scale: 1.5 }],
      [2, { axis: [0, 0, -1], degrees: 75, scale: 1 }, { axis: [0, 0, 1], degrees: -75, scale: 1 }],
      [1, { axis: [0, 0, 1], degrees: 0, scale: 1.5 }],
    ];
    for (const [dim, orientation, expected] of kept) {
      const [place, other]: Session["points"][number]["position"][] = [[1, 0, 0], [2, 0, 0]];
      const points = [
        { id: 1, name: "a", position: place, target: place, orientation, weight: 1, locked: false },
        { id: 2, name: "b", position: other, target: other, weight: 1, locked: false },
      ];
      const found = written({ ...EMPTY_SESSION, points }, dim).read.points;
      expect(found).toEqual([{ ...points[0], orientation: expected ?? orientation }, points[1]]);
    }
  });

  it("without settings has the defaults, whatever was set before", () => {
    const { document } = read('{"format": "neuralmls-control-points", "version": 1, "control_points": [{"name": "a", "position": [0, 0, 0]}]}');
    expect(fromDocument(document, defaults).settings).toEqual(defaults);
  });

  it("for shape-aware weights asks for them, and is not changed", () => {
    const shape = { ...session, settings: { ...session.settings, kind: "shape-aware" as const } };
    expect(written(shape, 3).read.settings.kind).toBe("shape-aware");
  });

  it("of the editor before this one keeps its settings and its pairs", () => {
    const editor = {
      settings: { kind: "classic", neural: { width: 64, seed: 3, steps: null }, classic: { alpha: 2, epsilon: 0.5 }, transform: "affine", temperature: 2, adherence: 0, mirror: "y" },
      pairs: [["a", "b"]],
    };
    const control_points = [{ name: "a", position: [0, 0, 0], locked: true }, { name: "b", position: [1, 0, 0] }];
    const found = fromDocument(read(JSON.stringify({ format: "neuralmls-control-points", version: 1, control_points, editor })).document, defaults);
    expect(found.pairs.flat().sort()).toEqual([1, 2]);
    expect(found.points.map(({ locked }) => locked)).toEqual([true, false]);
    expect(found.settings).toMatchObject({ kind: "inverse-distance", transform: "affine", temperature: 2, handles: "soft", mirror: "y" });
    expect(found.settings.weights["inverse-distance"]).toEqual({ alpha: 2, epsilon: 0.5 });
  });

  it("is refused with the core's sentence, after the file's name", () => {
    expect(() => read("{}")).toThrow(/^a\.json: format/);
    expect(() => read("name,x,y\na,0,0\n", "flat.csv")).toThrow(/^flat\.csv: /);
    expect(() => read('{"format": "neuralmls-control-points", "version": 2, "control_points": [{"name": "a", "position": [0, 0, 0]}], "settings": {"temperature": -1}}')).toThrow(/temperature/);
  });
});

describe("two files", () => {
  const files = new Map([["src.csv", bytes("name,x,y,z\na,0,0,0\nb,0.5,0,0\nlonely,0,0.5,0\n")], ["dst.csv", bytes("name,x,y,z\nb,0,1,0\na,0,0,1\n")]]);

  it("are joined by the names in them: where control points are at rest, and where they go", () => {
    const { document, notes } = readSession(files, ["src.csv", "dst.csv"], box(3));
    const found = fromDocument(document, defaults).points.slice(0, 2).map(({ name, position, target }) => ({ name, position, target }));
    expect(found).toEqual([
      { name: "a", position: [0, 0, 0], target: [0, 0, 1] },
      { name: "b", position: [0.5, 0, 0], target: [0, 1, 0] },
    ]);
    expect(notes.join()).toContain("lonely");
  });

  it("without anything in common are refused by their names", () => {
    const strange = new Map([["src.csv", bytes("name,x,y,z\na,0,0,0\n")], ["dst.csv", bytes("name,x,y,z\nz,0,1,0\n")]]);
    expect(() => readSession(strange, ["src.csv", "dst.csv"], box(3))).toThrow(/^src\.csv and dst\.csv: /);
  });
});

it("a mirror that is set is in the file, and comes back", () => {
  const mirrored = setMirror("x", { centre: [0, 0, 0], half: 1 }).apply({ ...EMPTY_SESSION, points: session.points });
  expect(written(mirrored, 3).read.settings.mirror).toBe("x");
});
