// The scenes that ship, as the page draws them where a program does not tell their shapes: with remote rendering the
// client itself does not know them.
import { readFile, readdir } from "node:fs/promises";
import { basename, join } from "node:path";

/** What of an object, a body or a piece of tissue can be drawn without another file; else null. */
function drawn({ name, shape }) {
  if (!shape || shape.file) return null;
  if (shape.kind === "block") return { ...shape, name, kind: "box" };
  return { ...shape, name };
}

/** @param {(text: string) => object} parse TOML @returns {Promise<Object<string, {shapes: object[], more: string}>>} by name */
export async function readScenes(folder, parse) {
  const scenes = {};
  for (const file of (await readdir(folder)).filter((entry) => entry.endsWith(".toml")).sort()) {
    const { scene, object = [], body = [], tissue = [], field = [] } = parse(await readFile(join(folder, file), "utf8"));
    const name = scene.name ?? basename(file, ".toml");
    const parts = [...object, ...body, ...tissue];
    const more = [...parts.filter((part) => !drawn(part)).map((part) => `'${part.name}' is not drawn`),
      ...field.map((part) => `'${part.name}' has no shape: ${part.effects.join(", ")}`)];
    if (body.length + tissue.length > 0) more.push("what moves or deforms is drawn as it begins");
    scenes[name] = { shapes: parts.map(drawn).filter(Boolean), more: more.join("; ") };
  }
  return scenes;
}
