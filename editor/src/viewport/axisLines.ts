/** Along which axes something is dragged: a line through it in the colour of each of them. */

import { BufferGeometry, Group, LineBasicMaterial, LineSegments, Vector3 } from "three";

/** Red, green and blue, as everywhere. */
export const AXIS_COLOURS = { X: 0xe0483e, Y: 0x55a630, Z: 0x3d7fe0 };

/** Where its parts end on both sides, relative to the shape's box. Software renderers lose a line with one end behind the eye: a short part of it at most. */
const ENDS = [0, 0.25, 0.5, 1, 2, 4, 8, 16, 32];

export class AxisLines {
  readonly object = new Group();

  constructor() {
    Object.entries(AXIS_COLOURS).forEach(([name, color], axis) => {
      const end = (at: number): Vector3 => new Vector3().setComponent(axis, at);
      const parts = [1, -1].flatMap((side) => ENDS.slice(1).flatMap((to, i) => [end(side * ENDS[i]), end(side * to)]));
      // Through the shape too, for one drags into and behind it.
      const material = new LineBasicMaterial({ color, transparent: true, depthTest: false, depthWrite: false });
      const line = new LineSegments(new BufferGeometry().setFromPoints(parts), material);
      Object.assign(line, { name, frustumCulled: false, renderOrder: 9 });
      this.object.add(line);
    });
    this.hide();
  }

  /** Shows those that a handle of the gizmo is named after: one, or the two of a plane. */
  show(handle: string, at: Vector3): void {
    for (const line of this.object.children) line.visible = handle.length < 3 && handle.includes(line.name);
    this.moveTo(at);
  }

  moveTo(place: Vector3): void {
    this.object.position.copy(place);
  }

  hide(): void {
    for (const line of this.object.children) line.visible = false;
  }
}
