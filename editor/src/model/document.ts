/**
 * A session as a session file has it (docs/session.schema.json). The core reads and writes the files, and refuses what is wrong with them;
 * what comes here has passed it.
 */

import type { Orientation } from "./orientation.ts";
import type { ControlPoint, Pair, Session } from "./session.ts";
import type { HandlesSetting, Settings, Transform, Weights, WeightsKind } from "./settings.ts";
import { AXES, type Vec3 } from "./vec3.ts";

/** The document of a session file, version 2. */
export interface SessionDocument {
  format: "neuralmls-control-points";
  version: 2;
  control_points: PointEntry[];
  settings?: SettingsEntry;
  /** The box in which weights are trained. */
  frame?: object;
  /** The editor's own. */
  editor?: unknown;
}

interface PointEntry {
  name: string;
  position: number[];
  target: number[];
  rotation?: { axis?: number[]; degrees: number };
  scale?: number;
  weight?: number;
  locked?: boolean;
  mirror_of?: string;
  group?: string;
}

export interface SettingsEntry {
  weights: WeightsEntry;
  transform: Transform;
  temperature: number;
  handles: HandlesSetting;
  relax: number;
}

export type WeightsEntry = { kind: WeightsKind };

/** `dim`: as many coordinates a point are written as the shape's file has. */
export function toDocument(session: Session, dim: 1 | 2 | 3): SessionDocument {
  const { points, settings, frame, others } = session;
  const nameOf = new Map(points.map((point) => [point.id, point.name]));
  const twinOf = new Map(session.pairs.map(([a, b]) => [b, nameOf.get(a)]));
  return {
    ...others,
    format: "neuralmls-control-points",
    version: 2,
    control_points: points.map((point) => {
      const { name, position, target, orientation, weight, locked, group } = point;
      const { rotation, ...others } = (point.others ?? {}) as Partial<PointEntry>;
      const twin = twinOf.get(point.id);
      const places = { position: position.slice(0, dim), target: target.slice(0, dim) };
      const carried = orientation && orientationKeys(orientation, rotation, dim);
      const bonds = { ...(twin !== undefined && { mirror_of: twin }), ...(group !== undefined && { group }) };
      return { ...others, name, ...places, ...carried, weight, locked, ...bonds };
    }),
    settings: settingsEntry(settings),
    ...(frame && { frame }),
    ...(settings.mirror && { editor: { ...editorOf(others), mirror: settings.mirror } }),
  };
}

/** The settings alone. */
export function settingsEntry({ kind, weights, transform, temperature, handles, relax, others }: Settings): SettingsEntry {
  return { ...others, weights: { kind, ...weights[kind] }, transform, temperature, handles, relax };
}

/** `defaults`: the settings that hold where the document says nothing. */
export function fromDocument(document: SessionDocument, defaults: Settings): Session {
  const { format: _format, version: _version, control_points, settings, frame, editor, ...others } = document;
  const points = control_points.map(pointFrom);
  const { mirror, ...unknown } = editorOf({ editor });
  return {
    points,
    selection: [],
    pairs: pairsFrom(control_points, points),
    settings: {
      ...(settings ? settingsFrom(settings, defaults.weights) : defaults),
      mirror: AXES.find((axis) => axis === mirror) ?? null,
    },
    ...(frame && { frame }),
    others: { ...others, ...(Object.keys(unknown).length > 0 && { editor: unknown }) },
  };
}

/** The settings of a file, which has those of one kind of weights; `weights` has those of the others. */
export function settingsFrom({ weights: used, transform, temperature, handles, relax, ...others }: SettingsEntry, weights: Weights): Settings {
  const { kind, ...parameters } = used;
  return { kind, weights: { ...weights, [kind]: parameters }, transform, temperature, handles, relax, mirror: null, others };
}

function editorOf({ editor }: Pick<SessionDocument, "editor">): { mirror?: unknown } {
  return typeof editor === "object" && editor !== null ? editor : {};
}

function pointFrom(entry: PointEntry, i: number): ControlPoint {
  const { name, position, target, rotation, scale, weight, locked, mirror_of: _, group, ...others } = entry;
  const { axis, degrees, ...unknown } = rotation ?? { degrees: 0 };
  const orientation: Orientation | undefined =
    rotation || scale !== undefined ? { axis: pad(axis ?? [0, 0, 1]), degrees, scale: scale ?? 1 } : undefined;
  if (Object.keys(unknown).length > 0) Object.assign(others, { rotation: unknown });
  return {
    id: i + 1,
    name,
    position: pad(position),
    target: pad(target),
    ...(orientation && { orientation }),
    weight: weight ?? 1,
    locked: locked ?? false,
    ...(group !== undefined && { group }),
    ...(Object.keys(others).length > 0 && { others }),
  };
}

function orientationKeys({ axis, degrees, scale }: Orientation, others: object | undefined, dim: number): Partial<PointEntry> {
  // In the plane the axis is (0, 0, 1), and a rotation about its opposite is one backwards.
  const plane = { degrees: axis[2] < 0 ? -degrees : degrees };
  const rotation = { ...others, ...(dim === 3 ? { axis: [...axis], degrees } : plane) };
  return { ...(dim > 1 && { rotation }), ...((scale !== 1 || dim === 1) && { scale }) };
}

/** Each control point has one twin. */
function pairsFrom(entries: readonly PointEntry[], points: readonly ControlPoint[]): Pair[] {
  const idOf = new Map(points.map((point) => [point.name, point.id]));
  const taken = new Set<number>();
  return entries.flatMap(({ mirror_of }, i): Pair[] => {
    const [twin, id] = [mirror_of === undefined ? undefined : idOf.get(mirror_of), points[i].id];
    if (twin === undefined || taken.has(twin) || taken.has(id)) return [];
    taken.add(twin).add(id);
    return [[twin, id]];
  });
}

const pad = (v: readonly number[]): Vec3 => [v[0], v[1] ?? 0, v[2] ?? 0];
