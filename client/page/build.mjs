// Bundles the page: node build.mjs SOURCES NODE_MODULES SCENES TO
//
// SCENES is the folder of the scene files that ship. Writes index.html, page.js, page.css and icon.svg into TO, and into TO/licences the licence of each package that is in
// them. Says how much the page weighs.
import { copyFile, mkdir, readFile, readdir, rm, stat, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { readScenes } from "./scenes.mjs";

const [sources, modules, scenes, to] = process.argv.slice(2).map((path) => resolve(path));
const packages = createRequire(join(modules, "x"));
const { build } = packages("esbuild");
const { parse } = packages("smol-toml");

/** `import scenes from "shipped-scenes"`: what scenes.mjs reads. */
const shippedScenes = {
  name: "shipped-scenes",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^shipped-scenes$/ }, ({ path }) => ({ path, namespace: "scenes" }));
    onLoad({ filter: /.*/, namespace: "scenes" }, async () => ({
      contents: JSON.stringify(await readScenes(scenes, parse)), loader: "json" }));
  },
};

/** Package of each file that went into the bundles: node_modules/three/src/... is of three. */
function packagesOf(inputs) {
  const names = Object.keys(inputs).map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1]);
  return [...new Set(names.filter(Boolean))].sort();
}

async function licenceOf(name) {
  const folder = join(modules, name);
  const file = (await readdir(folder)).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) throw new Error(`package '${name}' has no licence text in ${folder}`);
  const { version } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
  return `${name} ${version}\n\n${await readFile(join(folder, file), "utf8")}`;
}

await rm(to, { recursive: true, force: true });
await mkdir(join(to, "licences"), { recursive: true });
const result = await build({
  entryPoints: { page: join(sources, "main.js"), "page-style": join(sources, "page.css") },
  outdir: to,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  nodePaths: [modules],
  plugins: [shippedScenes],
  legalComments: "none",
  metafile: true,
  write: false,
  logLevel: "warning",
});
for (const { path, contents } of result.outputFiles) await writeFile(path.replace("page-style", "page"), contents);
for (const asset of ["index.html", "icon.svg"]) await copyFile(join(sources, asset), join(to, asset));
for (const name of packagesOf(result.metafile.inputs)) {
  await writeFile(join(to, "licences", `${name.replace("/", "-")}.txt`), await licenceOf(name));
}
const files = ["index.html", "page.js", "page.css", "icon.svg"];
const sizes = await Promise.all(files.map(async (name) => (await stat(join(to, name))).size));
console.log(`The page weighs ${(sizes.reduce((sum, size) => sum + size, 0) / 1000).toFixed(0)} kB ` +
  `(${files.map((name, i) => `${name} ${(sizes[i] / 1000).toFixed(0)}`).join(", ")})`);
