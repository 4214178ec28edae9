/** The built core in Node, for tests of what is made of it. */

import { readFileSync } from "node:fs";
import { emptySession, type Session } from "../../src/model/session.ts";
import { initSync } from "../../src/wasm/neuralmls_wasm.js";
import { rules } from "../../src/worker/sessions.ts";

initSync({ module: readFileSync(new URL("../../src/wasm/neuralmls_wasm_bg.wasm", import.meta.url)) });

export const { defaults, constants } = rules();

/** The session without control points. */
export const EMPTY_SESSION: Session = emptySession(defaults);
