/** The CSV form of control-point files: a header line, then one control point a line. */

import { FileError, type RawEntry } from "./fileError.ts";
import { AXES } from "./vec3.ts";

/** Throws FileError, which says the line. Columns that are not known are passed over. */
export function parseCsv(text: string): RawEntry[] {
  const rows = splitRows(text);
  const header = rows.shift();
  if (!header) throw new FileError("the file is empty");
  const titles = header.cells.map((title) => title.toLowerCase());
  const axes = (prefix: string): number[] => {
    const columns = AXES.map((axis) => titles.indexOf(prefix + axis));
    const count = columns.findIndex((column) => column < 0);
    return columns.slice(0, count < 0 ? 3 : count);
  };
  const name = titles.indexOf("name");
  const position = axes("").length > 0 ? axes("") : axes("source_");
  const target = axes("target_");
  if (name < 0 || position.length === 0 || (target.length > 0 && target.length !== position.length)) {
    throw new FileError(
      `line ${header.line}: expected the header name,x,y,z or name,x,y,z,target_x,target_y,target_z, ` +
        `found ${header.cells.join().slice(0, 60)}`,
    );
  }
  if (rows.length === 0) throw new FileError("there are no control points below the header line; at least one is needed");
  return rows.map(({ cells, line }) => {
    if (!cells[name]) throw new FileError(`line ${line}: the control point has no name`);
    const numbers = (columns: number[]): number[] =>
      columns.map((column) => {
        const cell = cells[column] ?? "";
        const value = cell === "" ? Number.NaN : Number(cell);
        if (Number.isFinite(value)) return value;
        const found = cell === "" ? "nothing" : cell.slice(0, 60);
        throw new FileError(`line ${line}: expected a number for ${titles[column]} of '${cells[name]}', found ${found}`);
      });
    const at = numbers(position);
    const stays = target.every((column) => !cells[column]);
    return { name: cells[name], position: at, target: stays ? at : numbers(target) };
  });
}

interface Row {
  cells: string[];
  line: number;
}

/** Cells, with quotes as in RFC 4180. Lines without any text are left out. */
function splitRows(text: string): Row[] {
  const rows: Row[] = [];
  let [cells, cell, quoted, line, start] = [[] as string[], "", false, 1, 1];
  const endCell = (): void => {
    cells.push(cell.trim());
    cell = "";
  };
  const endRow = (): void => {
    endCell();
    if (cells.some((c) => c !== "")) rows.push({ cells, line: start });
    cells = [];
    start = line;
  };
  for (let i = 0; i < text.length; i++) {
    const c = text[i];
    if (c === "\n") line++;
    if (quoted) {
      if (c !== '"') cell += c;
      else if (text[i + 1] === '"') cell += text[++i];
      else quoted = false;
    } else if (c === '"' && cell.trim() === "") {
      [quoted, cell] = [true, ""];
    } else if (c === ",") {
      endCell();
    } else if (c === "\n") {
      endRow();
    } else {
      cell += c;
    }
  }
  if (quoted) throw new FileError(`line ${start}: a quotation mark is not closed`);
  endRow();
  return rows;
}
