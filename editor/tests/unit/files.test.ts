import { expect, it } from "vitest";
import { sort } from "../../src/app/files.ts";

const files = (given: Record<string, string>) => new Map(Object.entries(given).map(([name, text]) => [name, new TextEncoder().encode(text)]));

it.each([
  [{ "cloud.csv": "x,y,z\n1,2,3\n4,5,nan\n" }, "cloud.csv", []],
  [{ "cloud.txt": "//X Y Z\n1 2e-3 3\n4 5 6\n" }, "cloud.txt", []],
  [{ "points.csv": "name,x,y,z\n1,1,2,3\n" }, undefined, ["points.csv"]],
  [{ "picked.txt": "tip,1,2,3\nheel,4,5,6\n" }, undefined, ["picked.txt"]],
  [{ "face.pts": "Version 1.0\n2\nS000 1 2 3\nS001 4 5 6\n" }, undefined, ["face.pts"]],
  [{ "scan.pts": "2\n1 2 3 0 255 255 255\n4 5 6 0 255 255 255\n" }, "scan.pts", []],
  [{ "a.obj": "v 1 2 3\n", "a.mtl": "", "numbers.csv": "1,2,3\n4,5,6\n" }, "a.obj", ["numbers.csv"]],
  [{ "dst.fcsv": "", "src.fcsv": "" }, undefined, ["src.fcsv", "dst.fcsv"]],
  [{ "face_target.mrk.json": "", "face.mrk.json": "", "face.ply": "" }, "face.ply", ["face.mrk.json", "face_target.mrk.json"]],
])("what is a shape and what are control points is seen: %j", (given, shape, points) => {
  expect(sort(files(given as Record<string, string>))).toEqual({ shape, points });
});
