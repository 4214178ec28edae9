import type { Turn } from "./turn.ts";

/** What was wrong with a file, in one sentence for a person. */
export class FileError extends Error {
  override name = "FileError";
}

/** A control point as it was read: as many coordinates as the file has. */
export interface RawEntry {
  name: string;
  position: number[];
  target: number[];
  turn?: Turn;
  locked?: boolean;
}
