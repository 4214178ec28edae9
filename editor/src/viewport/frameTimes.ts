/** How long JavaScript takes for each frame of a drag, for the Performance API. */

export const FRAME_OF_A_DRAG = "neuralmls-drag-frame";

export class FrameTimes {
  #event = 0;
  /** Milliseconds of all that listens to the pointer since the last frame. */
  #handling = 0;
  #dragging = false;

  constructor() {
    // The first and the last of all who listen.
    window.addEventListener("pointermove", () => (this.#event = performance.now()), { capture: true });
    window.addEventListener("pointermove", () => (this.#handling += performance.now() - this.#event));
  }

  /** A frame that was begun at `start` has been handed to the GPU: it is told of if it is one of a drag. */
  tell(start: number, dragging: boolean): void {
    // The browser keeps them all: those of the last drag are enough.
    if (dragging && !this.#dragging) performance.clearMeasures(FRAME_OF_A_DRAG);
    if (dragging) performance.measure(FRAME_OF_A_DRAG, { start, duration: this.#handling + performance.now() - start });
    this.#dragging = dragging;
    this.#handling = 0;
  }
}
