/** Between the units of the file and those of the view, in which the longest side of the shape's box is 2 and its middle 0. */

import { Vector3 } from "three";
import type { Box } from "../commands/index.ts";
import type { Vec3 } from "../model/vec3.ts";

export class Space {
  readonly box: Box;
  readonly dim: 1 | 2 | 3;

  constructor(box: Box, dim: 1 | 2 | 3) {
    [this.box, this.dim] = [box, dim];
  }

  toView([x, y, z]: Vec3): Vector3 {
    const { centre, half } = this.box;
    return new Vector3((x - centre[0]) / half, (y - centre[1]) / half, (z - centre[2]) / half);
  }

  /** A shape in a plane or on a line stays in it. */
  toFile(place: Vector3): Vec3 {
    const { centre, half } = this.box;
    const y = this.dim > 1 ? centre[1] + half * place.y : 0;
    const z = this.dim > 2 ? centre[2] + half * place.z : 0;
    return [centre[0] + half * place.x, y, z];
  }

  /** Many places, 3 numbers each, written to `entered`. */
  allToView(places: Float64Array, entered: Float64Array): Float64Array {
    const { centre, half } = this.box;
    for (let at = 0; at < places.length; at++) entered[at] = (places[at] - centre[at % 3]) / half;
    return entered;
  }

  /** Steps of a drag, in the view's units: the next smaller of 1, 2 or 5 times a power of ten of the file's. */
  get step(): number {
    const size = this.box.half / 20;
    const power = 10 ** Math.floor(Math.log10(size));
    return (power * (size / power >= 5 ? 5 : size / power >= 2 ? 2 : 1)) / this.box.half;
  }
}
