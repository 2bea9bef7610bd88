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
  const keeping = ['-kv', '-vtf', '-vt', '16', '-ke', '-km'];
  const done = spawnSync(command[0], [...command.slice(1), '-i', input, '-o', output, ...keeping, ...options], { stdio: 'inherit' });
  if (done.error) fail(`gltfpack cannot be started (${done.error.message}); install it, or name it by GLTFPACK`);
  if (done.status !== 0) fail(`gltfpack ended with ${done.status}`);
}

/** The objects of a texture that may name a picture: itself, and extensions for pictures that glTF does not know. */
const namersOf = texture => [texture, ...Object.values(texture.extensions ?? {})].filter(item => item.source !== undefined);

/** Takes the picture of a lightmap along: into the packed model, or beside it where it lies beside the baked one. */
function addImage(packed, baked, number, files) {
  const { bufferView, ...image } = baked.json.images[number];
  if (bufferView === undefined) {
    const name = decodeURIComponent(image.uri), from = path.resolve(files.baked, name), to = path.resolve(files.packed, name);
    if (from !== to) fs.copyFileSync(from, to);
    return packed.json.images.push(image) - 1;
  }
  const view = baked.json.bufferViews[bufferView], start = view.byteOffset ?? 0;
  const bytes = padded(baked.body.subarray(start, start + view.byteLength), 0);
  packed.json.bufferViews.push({ buffer: 0, byteOffset: packed.size, byteLength: view.byteLength });
  packed.parts.push(bytes);
  packed.size += bytes.length;
  return packed.json.images.push({ ...image, bufferView: packed.json.bufferViews.length - 1 }) - 1;
}

/** Copies textures of lightmaps from the baked model; returns their new numbers by the old ones. */
function addTextures(packed, baked, numbers, files) {
  const added = new Map();
  for (const list of ['images', 'textures', 'bufferViews', 'samplers']) packed.json[list] ??= [];
  for (const number of numbers) {
    const texture = structuredClone(baked.json.textures[number]);
    for (const namer of namersOf(texture)) namer.source = addImage(packed, baked, namer.source, files);
    if (texture.sampler !== undefined) texture.sampler = packed.json.samplers.push({ ...baked.json.samplers[texture.sampler] }) - 1;
    added.set(number, packed.json.textures.push(texture) - 1);
  }
  for (const list of ['images', 'samplers']) if (!packed.json[list].length) delete packed.json[list];
  return added;
}

/** Names of extensions in an object and below. */
function extensionsIn(value) {
  if (value === null || typeof value !== 'object') return [];
  return [...Object.keys(value.extensions ?? {}), ...Object.entries(value).flatMap(([key, item]) => key === 'extras' ? [] : extensionsIn(item))];
}

function restore(packed, baked, files) {
  const carriers = packed.json.materials?.filter(material => material.extras?.[CARRIER]) ?? [];
  const added = addTextures(packed, baked, new Set(carriers.map(material => material.extras[CARRIER].index)), files);
  const used = new Set(packed.json.extensionsUsed ?? []).add(EXTENSION);
  for (const material of carriers) {
    const { [CARRIER]: lightmap, ...extras } = material.extras, index = added.get(lightmap.index);
    material.extensions = { ...material.extensions, [EXTENSION]: { ...lightmap, index } };
    if (Object.keys(extras).length) material.extras = extras;
    else delete material.extras;
    for (const name of extensionsIn([lightmap, packed.json.textures[index]])) used.add(name);
  }
  packed.json.extensionsUsed = [...used];
  packed.json.buffers[0].byteLength = packed.size;
}

const [input, output, ...options] = process.argv.slice(2);
if (!input || !output) fail('usage: node pack-lightmaps.mjs BAKED.glb OUT.glb [options of gltfpack]');
const refused = options.find(option => /^-(tc|tw|tu|tr|cf)$/.test(option));
if (refused) fail(`${refused}: pictures of lightmaps must stay as they are; leave this option out`);
const baked = readGlb(input);
if (baked.json.nodes?.some(node => node.extensions?.MX_lightmap))
  fail(`${input} has lightmaps on nodes (MX_lightmap), which gltfpack drops and merges; bake with another --profile than mx`);
if (!baked.json.materials?.some(lightmapOf)) fail(`${input} has no lightmaps`);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'pack-lightmaps-'));
try {
  const carried = path.join(folder, 'carried.glb'), packed = path.join(folder, 'packed.glb');
  writeGlb(carried, withCarriers(baked.json), [baked.body]);
  runGltfpack(carried, packed, options);
  const { json, body } = readGlb(packed), first = padded(body, 0);
  const model = { json, parts: [first], size: first.length };
  restore(model, baked, { baked: path.dirname(input), packed: path.dirname(output) });
  writeGlb(output, model.json, model.parts);
} finally {
  fs.rmSync(folder, { recursive: true });
}
