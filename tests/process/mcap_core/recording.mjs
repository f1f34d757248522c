// A recording, opened by the official MCAP reader.
//
// The packages of package.json are looked for in $FORCEBOUND_NODE_MODULES, or in node_modules here or above the working
// directory; without them the check that asks for them is skipped (exit 77).
import assert from "node:assert/strict";
import { open } from "node:fs/promises";
import { createRequire } from "node:module";
import { resolve } from "node:path";

/// Packages by the names that they have here.
export function load(packages) {
  const given = process.env.FORCEBOUND_NODE_MODULES;
  const places = [given && resolve(given, "x"), resolve("x"), import.meta.url].filter(Boolean);
  for (const place of places) {
    try {
      const require = createRequire(place);
      return Object.fromEntries(Object.entries(packages).map(([name, of]) => [name, require(of)]));
    } catch (error) {
      if (error.code !== "MODULE_NOT_FOUND") throw error;
    }
  }
  console.log("SKIPPED: npm packages are missing (npm ci with this folder's lock file)");
  process.exit(77);
}

export const { core, support, schemas, protobuf, descriptor } = load({
  core: "@mcap/core",
  support: "@mcap/support",
  schemas: "@foxglove/schemas/internal",
  protobuf: "protobufjs",
  descriptor: "protobufjs/ext/descriptor",
});

export const decompressHandlers = await support.loadDecompressHandlers();

export async function openIndexed(path) {
  const handle = await open(path);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, size) => {
      const buffer = new Uint8Array(Number(size));
      const { bytesRead } = await handle.read(buffer, 0, Number(size), Number(offset));
      assert.equal(bytesRead, Number(size));
      return buffer;
    },
  };
  return { handle, reader: await core.McapIndexedReader.Initialize({ readable, decompressHandlers }) };
}

/// The type by the schema in the file alone.
export function typeOf(schema) {
  assert.equal(schema.encoding, "protobuf");
  const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema.data));
  return root.resolveAll().lookupType(schema.name);
}

/// Decodes by the schema in the file alone.
export function decoderOf(schema) {
  const type = typeOf(schema);
  return (data) => type.toObject(type.decode(data), { longs: String, arrays: true, defaults: true });
}

