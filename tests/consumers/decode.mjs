// Writes a glTF file with its compressed arrays decoded, under the same numbers: for comparing them with what luxel decoded.
// usage: node --import ./modules.mjs decode.mjs INPUT OUTPUT.glb
// Decoders: meshoptimizer's and Draco's own packages. Views and accessors keep their numbers; arrays that Draco held get views
// at the end; the count of an accessor is that of Draco. What is not compressed is copied as it is.
import fs from 'node:fs';
import path from 'node:path';
import draco3d from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer/decoder';

const [input, output] = process.argv.slice(2);
const ARRAYS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const NAMES = { 5120: 'DT_INT8', 5121: 'DT_UINT8', 5122: 'DT_INT16', 5123: 'DT_UINT16', 5125: 'DT_UINT32', 5126: 'DT_FLOAT32' };

function readFile(file) {
  const content = fs.readFileSync(file);
  if (content.toString('latin1', 0, 4) !== 'glTF') return { json: JSON.parse(content), body: null };
  const length = content.readUInt32LE(12);
  return { json: JSON.parse(content.subarray(20, 20 + length)), body: content.subarray(28 + length) };
}

function readBuffer(buffer, body, folder) {
  if (buffer.uri === undefined) return body ?? new Uint8Array(buffer.byteLength);
  if (buffer.uri.startsWith('data:')) return Buffer.from(buffer.uri.slice(buffer.uri.indexOf(',') + 1), 'base64');
  return fs.readFileSync(path.join(folder, decodeURIComponent(buffer.uri)));
}

function decodeView(view, buffers) {
  const meshopt = view.extensions?.EXT_meshopt_compression ?? view.extensions?.KHR_meshopt_compression;
  const { buffer, byteOffset = 0, byteLength } = meshopt ?? view;
  const source = buffers[buffer].subarray(byteOffset, byteOffset + byteLength);
  if (!meshopt) return source;
  const target = new Uint8Array(meshopt.count * meshopt.byteStride);
  MeshoptDecoder.decodeGltfBuffer(target, meshopt.count, meshopt.byteStride, source, meshopt.mode, meshopt.filter);
  delete view.extensions;
  return target;
}

function copyOut(module, bytes, fill) {
  const pointer = module._malloc(bytes);
  fill(pointer);
  const copy = module.HEAPU8.slice(pointer, pointer + bytes);
  module._free(pointer);
  return copy;
}

function decodeDraco(module, primitive, views, json) {
  const draco = primitive.extensions.KHR_draco_mesh_compression;
  const decoder = new module.Decoder(), mesh = new module.Mesh();
  const source = views[draco.bufferView];
  const status = decoder.DecodeArrayToMesh(new Int8Array(source), source.byteLength, mesh);
  if (!status.ok()) throw new Error('Draco: ' + status.error_msg());
  const place = (accessor, bytes, count) => {
    json.bufferViews.push({ buffer: 0, byteLength: bytes.byteLength });
    views.push(bytes);
    Object.assign(json.accessors[accessor], { bufferView: views.length - 1, byteOffset: 0, count });
  };
  for (const [name, id] of Object.entries(draco.attributes)) {
    const accessor = json.accessors[primitive.attributes[name]];
    const attribute = decoder.GetAttributeByUniqueId(mesh, id);
    const bytes = mesh.num_points() * attribute.num_components() * ARRAYS[accessor.componentType].BYTES_PER_ELEMENT;
    place(primitive.attributes[name], copyOut(module, bytes, pointer => decoder.GetAttributeDataArrayForAllPoints(
      mesh, attribute, module[NAMES[accessor.componentType]], bytes, pointer)), mesh.num_points());
  }
  const count = mesh.num_faces() * 3;
  const indices = new Uint32Array(copyOut(module, count * 4, pointer => decoder.GetTrianglesUInt32Array(mesh, count * 4, pointer)).buffer);
  place(primitive.indices, new Uint8Array(new (ARRAYS[json.accessors[primitive.indices].componentType])(indices).buffer), count);
}

function writeGlb(file, json, views) {
  let size = 0;
  const parts = [];
  views.forEach((bytes, index) => {
    Object.assign(json.bufferViews[index], { buffer: 0, byteOffset: size, byteLength: bytes.byteLength });
    const padding = (4 - bytes.byteLength % 4) % 4;
    parts.push(bytes, new Uint8Array(padding));
    size += bytes.byteLength + padding;
  });
  json.buffers = [{ byteLength: size }];
  let text = Buffer.from(JSON.stringify(json));
  text = Buffer.concat([text, Buffer.alloc((4 - text.length % 4) % 4, ' ')]);
  const head = Buffer.alloc(20), body = Buffer.alloc(8);
  head.write('glTF');
  [2, 28 + text.length + size, text.length].forEach((value, index) => head.writeUInt32LE(value, 4 + 4 * index));
  head.write('JSON', 16);
  body.writeUInt32LE(size);
  body.write('BIN\0', 4);
  fs.writeFileSync(file, Buffer.concat([head, text, body, ...parts]));
}

const { json, body } = readFile(input);
const buffers = (json.buffers ?? []).map(buffer => new Uint8Array(readBuffer(buffer, body, path.dirname(input))));
await MeshoptDecoder.ready;
const views = json.bufferViews.map(view => decodeView(view, buffers));
const compressed = (json.meshes ?? []).flatMap(mesh => mesh.primitives).filter(p => p.extensions?.KHR_draco_mesh_compression);
const module = compressed.length ? await draco3d.createDecoderModule() : null;
for (const primitive of compressed) decodeDraco(module, primitive, views, json);
writeGlb(output, json, views);
