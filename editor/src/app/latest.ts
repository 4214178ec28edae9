/** Work of which one run is on its way at a time; whatever is asked for meanwhile is one more, so that the last always comes. */
export class Latest {
  readonly #work: () => Promise<void>;
  #running: Promise<void> | undefined;
  #again = false;

  /** `work` is never rejected. */
  constructor(work: () => Promise<void>) {
    this.#work = work;
  }

  ask(): void {
    this.#again = true;
    this.#running ??= this.#run();
  }

  /** Resolves when nothing is asked for any more. */
  async done(): Promise<void> {
    await this.#running;
  }

  async #run(): Promise<void> {
    await null; // so that whoever asks is done with what it does
    while (this.#again) {
      this.#again = false;
      await this.#work();
    }
    this.#running = undefined;
  }
}
