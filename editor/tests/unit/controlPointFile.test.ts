import { describe, expect, it } from "vitest";
import { formatSession, parseSession } from "../../src/model/controlPointFile.ts";
import { EMPTY_SESSION, type Session } from "../../src/model/session.ts";
import { DEFAULT_SETTINGS } from "../../src/model/settings.ts";

const session: Session = {
  points: [
    { id: 1, name: "seat", position: [0.1, 0.2, 1 / 3], target: [0.1, 0.2, 1 / 3], locked: true },
    { id: 2, name: 'a "b", é', position: [1e-300, -5e5, 0], target: [0.1 + 0.2, 2, 3], locked: false },
  ],
  selection: [],
  pairs: [[1, 2]],
  settings: { ...DEFAULT_SETTINGS, kind: "classic", classic: { alpha: 2, epsilon: 0.01 }, temperature: 0.3, adherence: 0.25, mirror: "z" },
};

const file = (points: string): string => `{"format": "neuralmls-control-points", "version": 1, "control_points": [${points}]}`;

describe("control-point files", () => {
  it("written and read again say the same, bit for bit", () => {
    expect(parseSession(formatSession(session, 3), 3)).toEqual(session);
  });

  it("written are version 1, with the editor's own keys beside", () => {
    const document = JSON.parse(formatSession(session, 3)) as Record<string, unknown>;
    expect(document).toMatchObject({ format: "neuralmls-control-points", version: 1 });
    expect(document.control_points).toEqual([
      { name: "seat", position: [0.1, 0.2, 1 / 3], target: [0.1, 0.2, 1 / 3], locked: true },
      { name: 'a "b", é', position: [1e-300, -5e5, 0], target: [0.1 + 0.2, 2, 3] },
    ]);
  });

  it("of shapes in the plane have two coordinates", () => {
    const flat = { ...EMPTY_SESSION, points: [{ ...session.points[0], position: [1, 2, 0], target: [1, 3, 0] } as const] };
    const text = formatSession(flat, 2);
    expect(text).toContain('"position":[1,2],"target":[1,3]');
    expect(parseSession(text, 2).points).toEqual(flat.points);
    expect(() => parseSession(text, 3)).toThrow("expected 3 coordinates, as the shape has, found 2");
  });

  it("without targets stay where they are, and unknown keys are passed over", () => {
    const read = parseSession(file('{"name": "a", "position": [1, 2, 3], "colour": "red"}'), 3);
    expect(read.points).toEqual([{ id: 1, name: "a", position: [1, 2, 3], target: [1, 2, 3], locked: false }]);
    expect(read.settings).toEqual(DEFAULT_SETTINGS);
  });

  it("may be CSV", () => {
    const csv = '\uFEFFname,x,y,z,target_x,target_y,target_z,note\r\n"a, ""b""",1,2,3,,,\r\n\r\nc,4,5e-1,6,7,8,9,hello\r\n';
    expect(parseSession(csv, 3).points).toMatchObject([
      { name: 'a, "b"', position: [1, 2, 3], target: [1, 2, 3] },
      { name: "c", position: [4, 0.5, 6], target: [7, 8, 9] },
    ]);
    expect(parseSession("name,source_x,source_y\np,1,2\n", 2).points).toMatchObject([{ position: [1, 2, 0] }]);
  });

  it.each([
    ["", "the file is empty"],
    ["{", "not JSON"],
    ["{}", 'format: expected "neuralmls-control-points", found nothing'],
    ['{"format": "neuralmls-control-points", "version": 2}', "version: expected 1, found 2"],
    [file(""), "expected a list with at least one control point, found []"],
    [file('{"position": [1, 2, 3]}'), "control_points[0].name: expected a text that is not empty, found nothing"],
    [file('{"name": "a", "position": [1, 2, "3"]}'), 'control_points[0].position: expected a list of 1 to 3 finite numbers, found [1,2,"3"]'],
    [file('{"name": "a", "position": [1, 2, 3], "target": null}'), "control_points[0].target: expected a list of 3 finite numbers, found null"],
    [file('{"name": "a", "position": [1, 2, 3]}, {"name": "a", "position": [1, 2, 4]}'), "the name 'a' is there twice"],
    [file('{"name": "a", "position": [1, 2, 3]}, {"name": "b", "position": [1, 2, 3]}'), "'a' and 'b' are at the same place"],
    ["a,b\n1,2\n", "line 1: expected the header name,x,y,z"],
    ["name,x,y,z\n", "there are no control points below the header line"],
    ["name,x,y,z\na,1,2,\n", "line 2: expected a number for z of 'a', found nothing"],
    ["name,x,y,z\na,1,2,x3\n", "line 2: expected a number for z of 'a', found x3"],
    ['name,x,y,z\n"a,1,2,3\n', "line 2: a quotation mark is not closed"],
    ["name,x,y,z,target_x\na,1,2,3,4\n", "line 1: expected the header"],
  ])("that are wrong are told in a sentence: %j", (text, sentence) => {
    expect(() => parseSession(text, 3)).toThrow(sentence);
  });

  it("with settings out of their range have the default ones", () => {
    const text = file('{"name": "a", "position": [1, 2, 3]}').replace(/}$/, ', "editor": {"settings": {"temperature": -1, "adherence": 1.5, "transform": "melt", "neural": {"width": 1e9}}, "pairs": [["a", "b"], 7]}}');
    const read = parseSession(text, 3);
    expect(read.settings).toEqual(DEFAULT_SETTINGS);
    expect(read.pairs).toEqual([]);
  });
});
