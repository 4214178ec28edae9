/** Everything that can be done and undone. */

export { type Command, History } from "./history.ts";
export { load } from "./load.ts";
export { moveSelected, nudge, put, resetTargets, turnSelected } from "./moves.ts";
export { addPoint, addPoints, type Box, type Place, placeAnew, removeSelected, rename, toggleLock } from "./points.ts";
export { type Mode, select, selectAll, selectNext } from "./selection.ts";
export { pair, set, setClassic, setMirror, setNeural, unpair } from "./settings.ts";
