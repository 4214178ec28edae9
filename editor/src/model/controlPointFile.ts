/**
 * Control-point files, JSON and CSV, as docs/control-points.md has them: what `neuralmls deform --points` reads.
 *
 * A session file is the JSON form with the editor's own keys beside the known ones: `locked` in a control point, and `editor`.
 */

import { parseCsv } from "./controlPointCsv.ts";
import { FileError, type RawEntry } from "./fileError.ts";
import type { ControlPoint, Pair, Session } from "./session.ts";
import { asRecord, settingsFrom } from "./settings.ts";
import type { Turn } from "./turn.ts";
import { distance, type Vec3 } from "./vec3.ts";

const FORMAT = "neuralmls-control-points";
const VERSION = 1;

/** The text of a session file. `dim`: as many coordinates a point are written as the shape's file has. */
export function formatSession(session: Session, dim: 1 | 2 | 3): string {
  const nameOf = new Map(session.points.map((point) => [point.id, point.name]));
  const lines = session.points.map(({ name, position, target, turn, locked }) => {
    const places = { position: position.slice(0, dim), target: target.slice(0, dim) };
    const entry = { name, ...places, ...(turn && turnKeys(turn, dim)), ...(locked && { locked }) };
    return "    " + JSON.stringify(entry);
  });
  const editor = {
    settings: session.settings,
    pairs: session.pairs.map((pair) => pair.map((id) => nameOf.get(id))),
  };
  return (
    `{\n  "format": "${FORMAT}",\n  "version": ${VERSION},\n  "control_points": [\n${lines.join(",\n")}\n  ],\n` +
    `  "editor": ${JSON.stringify(editor)}\n}\n`
  );
}

/**
 * Reads a control-point file, JSON or CSV by its content. `dim` is that of the shape.
 *
 * Throws FileError, which does not name the file.
 */
export function parseSession(text: string, dim: 1 | 2 | 3): Session {
  const body = text.replace(/^\uFEFF/, "");
  if (body.trim() === "") throw new FileError("the file is empty");
  const json = body.trimStart().startsWith("{");
  const document = json ? parseDocument(body) : undefined;
  const entries = document ? document.entries : parseCsv(body);
  check(entries, dim);
  const points = entries.map(
    ({ name, position, target, turn, locked }, i): ControlPoint => ({
      id: i + 1,
      name,
      position: pad(position),
      target: pad(target),
      ...(turn && { turn }),
      locked: locked ?? false,
    }),
  );
  const editor = asRecord(document?.editor);
  return { points, selection: [], pairs: pairsFrom(editor.pairs, points), settings: settingsFrom(editor.settings) };
}

function parseDocument(text: string): { entries: RawEntry[]; editor: unknown } {
  let parsed: unknown;
  try {
    parsed = JSON.parse(text);
  } catch (error) {
    throw new FileError(`not JSON: ${error instanceof Error ? error.message : String(error)}`);
  }
  const document = asRecord(parsed);
  if (document.format !== FORMAT) throw new FileError(`format: expected "${FORMAT}", found ${shown(document.format)}`);
  if (document.version !== VERSION) throw new FileError(`version: expected ${VERSION}, found ${shown(document.version)}`);
  const list = document.control_points;
  if (!Array.isArray(list) || list.length === 0) {
    throw new FileError(`control_points: expected a list with at least one control point, found ${shown(list)}`);
  }
  return { entries: list.map(entryFrom), editor: document.editor };
}

function entryFrom(found: unknown, i: number): RawEntry {
  const where = `control_points[${i}]`;
  const { name, position, target, rotation, scale, locked } = asRecord(found);
  if (typeof name !== "string" || name.trim() === "") {
    throw new FileError(`${where}.name: expected a text that is not empty, found ${shown(name)}`);
  }
  const at = coordinates(position, `${where}.position`);
  const moved = "target" in asRecord(found) ? coordinates(target, `${where}.target`, at.length) : at;
  const turn = rotation === undefined && scale === undefined ? undefined : turnFrom(rotation, scale, where, at.length);
  return { name, position: at, target: moved, ...(turn && { turn }), locked: locked === true };
}

function turnFrom(rotation: unknown, scale: unknown, where: string, dim: number): Turn {
  let [axis, degrees] = [[0, 0, 1], 0];
  if (rotation !== undefined) {
    if (dim === 1) throw new FileError(`${where}.rotation: a control point on a line has none`);
    const found = asRecord(rotation);
    if (dim === 3) axis = coordinates(found.axis, `${where}.rotation.axis`, 3);
    if (axis.every((c) => c === 0)) throw new FileError(`${where}.rotation.axis: expected numbers that are not all 0`);
    degrees = number(found.degrees, `${where}.rotation.degrees`);
  }
  const larger = scale === undefined ? 1 : number(scale, `${where}.scale`);
  if (larger <= 0) throw new FileError(`${where}.scale: expected a number above 0, found ${shown(scale)}`);
  return { axis: pad(axis), degrees, scale: larger };
}

function turnKeys({ axis, degrees, scale }: Turn, dim: number): object {
  return {
    ...(dim > 1 && { rotation: { ...(dim === 3 && { axis }), degrees } }),
    ...((scale !== 1 || dim === 1) && { scale }),
  };
}

function number(value: unknown, where: string): number {
  if (typeof value === "number" && Number.isFinite(value)) return value;
  throw new FileError(`${where}: expected a finite number, found ${shown(value)}`);
}

function coordinates(value: unknown, where: string, count?: number): number[] {
  const numbers = Array.isArray(value) && value.every((v) => typeof v === "number" && Number.isFinite(v)) ? value : [];
  if (count === undefined ? numbers.length < 1 || numbers.length > 3 : numbers.length !== count) {
    const expected = count === undefined ? "1 to 3" : String(count);
    throw new FileError(`${where}: expected a list of ${expected} finite numbers, found ${shown(value)}`);
  }
  return numbers as number[];
}

function check(entries: readonly RawEntry[], dim: number): void {
  const names = new Set<string>();
  const places = new Map<string, string>();
  for (const { name, position } of entries) {
    if (position.length !== dim) {
      throw new FileError(`'${name}': expected ${dim} coordinates, as the shape has, found ${position.length}`);
    }
    if (names.has(name)) throw new FileError(`the name '${name}' is there twice`);
    names.add(name);
    const place = position.join();
    const other = places.get(place);
    if (other !== undefined) throw new FileError(`'${other}' and '${name}' are at the same place`);
    places.set(place, name);
  }
}

function pairsFrom(found: unknown, points: readonly ControlPoint[]): Pair[] {
  if (!Array.isArray(found)) return [];
  const idOf = new Map(points.map((point) => [point.name, point.id]));
  const taken = new Set<number>();
  return found.flatMap((names: unknown) => {
    const [a, b] = Array.isArray(names) ? names.map((name: unknown) => idOf.get(String(name))) : [];
    if (a === undefined || b === undefined || a === b || taken.has(a) || taken.has(b)) return [];
    taken.add(a).add(b);
    return [[a, b] as const];
  });
}

const pad = (v: readonly number[]): Vec3 => [v[0], v[1] ?? 0, v[2] ?? 0];

function shown(value: unknown): string {
  const text = value === undefined ? "nothing" : JSON.stringify(value);
  return text.length <= 60 ? text : text.slice(0, 57) + "...";
}

/** Control points farther outside of the shape than twice its size: probably another shape's. */
export function areFarAway(session: Session, centre: Vec3, half: number): boolean {
  return session.points.some((point) => distance(point.position, centre) > 6 * half);
}
