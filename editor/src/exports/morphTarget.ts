/** A GLB of the shape at rest, with the deformed one as a morph target. */

import { BufferAttribute, BufferGeometry, Mesh, Points, PointsMaterial, Scene } from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import type { Drawn } from "../viewport/shapeView.ts";

interface Box {
  readonly centre: readonly number[];
  readonly half: number;
}

/** `y`: the deformed points, n x 3, in file units. The mesh has the coordinates of the file. */
export async function morphTarget(drawn: Drawn, box: Box, y: Float64Array): Promise<Uint8Array<ArrayBuffer>> {
  const { rest } = drawn;
  const count = rest.points.length;
  const positions = new Float32Array(3 * count);
  const displacements = new Float32Array(3 * count);
  for (let i = 0; i < count; i++) {
    for (let c = 0; c < 3; c++) {
      const place = box.centre[c] + box.half * rest.positions[3 * i + c];
      positions[3 * i + c] = place;
      displacements[3 * i + c] = y[3 * rest.points[i] + c] - place;
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  if (drawn.index) geometry.setAttribute("normal", new BufferAttribute(rest.normals, 3));
  if (drawn.uv) geometry.setAttribute("uv", new BufferAttribute(drawn.uv, 2));
  if (drawn.colours) geometry.setAttribute("color", new BufferAttribute(drawn.colours, 3));
  if (drawn.index) geometry.setIndex(new BufferAttribute(drawn.index, 1));
  for (const { start, count, material } of drawn.groups) geometry.addGroup(start, count, material);
  const target = new BufferAttribute(displacements, 3);
  target.name = "bent";
  geometry.morphAttributes.position = [target];
  geometry.morphTargetsRelative = true;
  const material = drawn.groups.length > 0 ? drawn.materials : drawn.materials[0];
  const ofPoints = (): PointsMaterial => new PointsMaterial({ vertexColors: drawn.colours !== undefined });
  const node = drawn.index ? new Mesh(geometry, material) : new Points(geometry, ofPoints());
  node.updateMorphTargets();
  const made = await new GLTFExporter().parseAsync(new Scene().add(node), { binary: true });
  return new Uint8Array(made as ArrayBuffer);
}
