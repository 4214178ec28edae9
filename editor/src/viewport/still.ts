import type { Object3D } from "three";

/** An object that stays where it is within what it belongs to: its matrix is not made anew in every frame. */
export function still<T extends Object3D>(object: T): T {
  object.updateMatrix();
  object.matrixAutoUpdate = false;
  return object;
}
