/** The main thread's end of the workers. */

import type { Core } from "./protocol.ts";

/** Starts loading the core; the first call waits for it. */
export declare function createCore(): Core;
