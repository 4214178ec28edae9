/** Everything that can be done and undone. */

export { type Command, History } from "./history.ts";
export { load } from "./load.ts";
export { moveSelected, nudge, put, resetTargets, rotateSelected } from "./moves.ts";
export { addPoint, addPoints, type Box, group, type Place, placeAnew, removeSelected, rename, toggleLock, ungroup } from "./points.ts";
export { type Mode, select, selectAll, selectNext } from "./selection.ts";
export { pair, set, setMirror, setWeights, unpair } from "./settings.ts";
