// node write_obj.mjs FILE.obj: writes the package's mesh, one vertex or triangle a line.
import { createRequire } from "node:module";
import { writeFileSync } from "node:fs";

const require = createRequire(process.cwd() + "/");
const { positions, cells } = require("bunny");
const lines = positions.map((p) => "v " + p.join(" ")).concat(cells.map((c) => "f " + c.map((i) => i + 1).join(" ")));
writeFileSync(process.argv[2], lines.join("\n") + "\n");
