/** What is drawn of a shape that has been opened. */

import { Color, type Vector3 } from "three";
import type { SerializedBVH } from "three-mesh-bvh";
import { appearanceOf, pointColours } from "./appearance.ts";
import { prepareGeometry } from "./geometry.ts";
import type { OpenedShape } from "./openedShape.ts";
import { type Drawn, plainMaterial } from "./shapeView.ts";

export interface Prepared {
  drawn: Drawn;
  mesh: { index: Uint32Array<ArrayBuffer>; bvh: SerializedBVH } | undefined;
  hasAppearance: boolean;
}

type Opened = Omit<OpenedShape, "isAt"> & { frame: { centre: readonly number[]; half: number } };

export async function draw(opened: Opened, files: ReadonlyMap<string, Uint8Array>): Promise<Prepared> {
  const { positions, triangles, frame } = opened;
  const isAt = (point: number, place: Vector3, tolerance: number): boolean =>
    place.toArray().every((c, at) => Math.abs((c - frame.centre[at]) / frame.half - positions[3 * point + at]) < tolerance);
  const shape: OpenedShape = { ...opened, isAt };
  const ofPoints = await pointColours(shape, files);
  if (!triangles || triangles.length === 0) {
    const points = Uint32Array.from({ length: positions.length / 3 }, (_, i) => i);
    const rest = { positions, normals: new Float32Array(positions.length).fill(0), points };
    const drawn: Drawn = { rest, index: null, ...(ofPoints && { colours: ofPoints }), groups: [], materials: [] };
    return { drawn, mesh: undefined, hasAppearance: ofPoints !== undefined };
  }
  const appearance = await appearanceOf(shape, files);
  const extras = [appearance?.uv, appearance?.colours].filter((extra) => extra !== undefined);
  const { mesh, bvh } = await prepareGeometry({ positions, triangles, corners: extras });
  const { index, extras: kept, ...rest } = mesh;
  const uv = appearance?.uv && kept[0];
  const colours = appearance?.colours
    ? kept.at(-1)
    : ofPoints && Float32Array.from({ length: 3 * rest.points.length }, (_, at) => ofPoints[3 * rest.points[Math.floor(at / 3)] + (at % 3)]);
  const drawn: Drawn = {
    rest,
    index,
    ...(uv && { uv }),
    ...(colours && { colours }),
    groups: appearance?.groups ?? [],
    materials: appearance?.materials ?? [plainMaterial()],
  };
  if (colours && !appearance) Object.assign(drawn.materials[0], { vertexColors: true }, { color: new Color(0xffffff) });
  return { drawn, mesh: { index, bvh }, hasAppearance: appearance !== undefined || colours !== undefined };
}
