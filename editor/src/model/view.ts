/** How the shape is looked at. Not part of a session: it is not undone and not saved with it. */

import type { Moves } from "./session.ts";

/** What the colours of the surface show. */
export type Colouring = "material" | "weight" | "points";
export type Tool = "translate" | "rotate" | "scale";

export interface View {
  readonly colouring: Colouring;
  readonly wireframe: boolean;
  /** The shape as it was, for as long as a key is held. */
  readonly before: boolean;
  /** Neural and inverse-distance weights side by side. */
  readonly comparison: boolean;
  readonly tool: Tool;
  /** What the gizmo, the arrows and the numbers move. */
  readonly moves: Moves;
  /** Whether a click on the surface adds a control point. */
  readonly adding: boolean;
  /** Whether a drag beside the control points selects those in a box, rather than to turn the view. */
  readonly boxes: boolean;
}

export const DEFAULT_VIEW: View = {
  colouring: "material",
  wireframe: false,
  before: false,
  comparison: false,
  tool: "translate",
  moves: "target",
  adding: true,
  boxes: false,
};

const GOLDEN_ANGLE = 137.508;

/** The colour of the i-th control point: hue, saturation, lightness, each 0 to 1. Neighbours in the list differ well. */
export function hueOf(i: number): [number, number, number] {
  return [((i * GOLDEN_ANGLE + 210) % 360) / 360, 0.68, 0.56];
}

/** The same as CSS writes it. */
export function cssColour(i: number): string {
  const [h, s, l] = hueOf(i);
  return `hsl(${(360 * h).toFixed(0)} ${(100 * s).toFixed(0)}% ${(100 * l).toFixed(0)}%)`;
}
