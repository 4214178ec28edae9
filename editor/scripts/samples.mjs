/** Writes the samples that the editor offers, as the command line makes them, with a list of them: `samples.mjs NEURALMLS FOLDER`. */

import { execFileSync } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [program, folder] = process.argv.slice(2);
const titles = { chair: "Chair", airplane: "Airplane", car: "Car", table: "Table" };

mkdirSync(folder, { recursive: true });
const list = Object.entries(titles).map(([name, title]) => {
  const file = `${name}.obj`;
  execFileSync(program, ["sample", name, "-o", join(folder, file), "--force", "--quiet"], { stdio: "inherit" });
  return { name, title, file, points: `${name}.points.json`, materials: [`${name}.mtl`] };
});
writeFileSync(join(folder, "index.json"), JSON.stringify(list, null, 2));
