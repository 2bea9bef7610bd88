#!/usr/bin/env node
// Packs a baked model with gltfpack, without losing its lightmaps.
//
// usage: node pack-lightmaps.mjs BAKED.glb OUT.glb [options of gltfpack]
//
// gltfpack (1.3) drops material extensions that it does not know, MOZ_lightmap among them, and the textures that only these
// use. So the lightmap of each material goes through it as `extras`, and its picture beside it: both are put back after.
// Always given to gltfpack: -kv (keep TEXCOORD_1), -vtf -vt 16 (as floats, for there is nowhere to say how integers were scaled, of
// 16 bits, which is within 2^-16 of a page), -ke (keep extras) and -km (keep materials). With -noq they keep every bit. Others, such
// as -cc, -kn or -si 0.5, are yours, but not -tc, -tu, -tw, -tr and -cf: pictures of lightmaps must stay as they are.
//
// gltfpack is looked for on the path, or is what GLTFPACK names: a program, or the cli.js of its npm package.
// Reads and writes .glb only. No packages are needed but gltfpack itself.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const EXTENSION = 'MOZ_lightmap';
const CARRIER = 'luxelLightmap';  // in extras, on the way through gltfpack
const GLB_MAGIC = 0x46546c67, JSON_CHUNK = 0x4e4f534a, BIN_CHUNK = 0x004e4942;

function fail(message) {
  console.error(`pack-lightmaps: error: ${message}`);
  process.exit(1);
}

function readGlb(file) {
  const content = fs.readFileSync(file);
  if (content.length < 20 || content.readUInt32LE(0) !== GLB_MAGIC) fail(`${file} is no GLB; bake to a name that ends in .glb`);
  const length = content.readUInt32LE(12), rest = content.subarray(20 + length);
  return { json: JSON.parse(content.subarray(20, 20 + length)), body: rest.length ? rest.subarray(8, 8 + rest.readUInt32LE(0)) : Buffer.alloc(0) };
}

const padded = (bytes, fill) => Buffer.concat([bytes, Buffer.alloc((4 - bytes.length % 4) % 4, fill)]);

function writeGlb(file, json, parts) {
  const body = padded(Buffer.concat(parts), 0), text = padded(Buffer.from(JSON.stringify(json)), ' ');
  const words = (...values) => Buffer.from(Uint32Array.from(values).buffer);
  fs.writeFileSync(file, Buffer.concat([words(GLB_MAGIC, 2, 28 + text.length + body.length, text.length, JSON_CHUNK), text,
    words(body.length, BIN_CHUNK), body]));
}

const lightmapOf = material => material.extensions?.[EXTENSION];

/** The model as gltfpack gets it: each lightmap also as extras of its material. */
function withCarriers(json) {
  return { ...json, materials: json.materials.map(material => lightmapOf(material) ?
    { ...material, extras: { ...material.extras, [CARRIER]: lightmapOf(material) } } : material) };
}

function runGltfpack(input, output, options) {
  const program = process.env.GLTFPACK ?? 'gltfpack';
  const command = /\.[cm]?js$/.test(program) ? [process.execPath, program] : [program];
  const done = spawnSync(command[0], [...command.slice(1), '-i', input, '-o', output, '-kv', '-vtf', '-vt', '16', '-ke', '-km', ...options], { stdio: 'inherit' });
  if (done.error) fail(`gltfpack cannot be started (${done.error.message}); install it, or name it by GLTFPACK`);
  if (done.status !== 0) fail(`gltfpack ended with ${done.status}`);
}

/** Copies textures and pictures of lightmaps from the baked model; returns their new numbers by the old ones. */
function addTextures(packed, baked, numbers) {
  const { json } = packed, from = baked.json, sampler = (json.samplers ??= []), added = new Map();
  const parts = [padded(packed.body, 0)];
  let size = parts[0].length;
  for (const list of ['images', 'textures', 'bufferViews']) json[list] ??= [];
  for (const number of numbers) {
    const texture = { ...from.textures[number] }, image = { ...from.images[texture.source] };
    const view = from.bufferViews[image.bufferView], start = view.byteOffset ?? 0;
    const bytes = padded(baked.body.subarray(start, start + view.byteLength), 0);
    json.bufferViews.push({ buffer: 0, byteOffset: size, byteLength: view.byteLength });
    json.images.push({ ...image, bufferView: json.bufferViews.length - 1 });
    if (texture.sampler !== undefined) texture.sampler = sampler.push({ ...from.samplers[texture.sampler] }) - 1;
    added.set(number, json.textures.push({ ...texture, source: json.images.length - 1 }) - 1);
    parts.push(bytes);
    size += bytes.length;
  }
  if (!sampler.length) delete json.samplers;
  // gltfpack's first buffer is the one inside the file; a fallback buffer (-cf) has a number of its own
  json.buffers[0].byteLength = size;
  return { added, parts };
}

function restore(packed, baked) {
  const carriers = packed.json.materials?.filter(material => material.extras?.[CARRIER]) ?? [];
  const numbers = new Set(carriers.map(material => material.extras[CARRIER].index));
  const { added, parts } = addTextures(packed, baked, numbers);
  for (const material of carriers) {
    const { [CARRIER]: lightmap, ...extras } = material.extras;
    material.extensions = { ...material.extensions, [EXTENSION]: { ...lightmap, index: added.get(lightmap.index) } };
    if (Object.keys(extras).length) material.extras = extras;
    else delete material.extras;
  }
  packed.json.extensionsUsed = [...packed.json.extensionsUsed ?? [], EXTENSION];
  return parts;
}

const [input, output, ...options] = process.argv.slice(2);
if (!input || !output) fail('usage: node pack-lightmaps.mjs BAKED.glb OUT.glb [options of gltfpack]');
const refused = options.find(option => /^-(tc|tw|tu|tr|cf)$/.test(option));
if (refused) fail(`${refused}: pictures of lightmaps must stay as they are; leave this option out`);
const baked = readGlb(input);
if (!baked.json.materials?.some(lightmapOf)) fail(`${input} has no lightmaps`);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'pack-lightmaps-'));
try {
  const carried = path.join(folder, 'carried.glb'), packed = path.join(folder, 'packed.glb');
  writeGlb(carried, withCarriers(baked.json), [baked.body]);
  runGltfpack(carried, packed, options);
  const model = readGlb(packed);
  const parts = restore(model, baked);
  writeGlb(output, model.json, parts);
} finally {
  fs.rmSync(folder, { recursive: true });
}
