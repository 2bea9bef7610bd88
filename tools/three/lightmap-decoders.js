/**
 * Pictures of lightmaps that a browser cannot show, or would spoil, as textures of half floats. Loaded by luxel-lightmap.js
 * when a model has them.
 *
 *     encoding  file                            a texel is
 *     linear16  PNG, 16 bits a channel          sample / 65535            (browsers cut it to 8 bits)
 *     rgbm8     PNG, RGBA of 8 bits             rgb / 255 * a / 255 * range   (browsers interpolate the four, and multiply by a)
 *     rgbm8-mx  the same                        rgb / 255 * (a / 255)^2.2 * range
 *     rgbe8     Radiance .hdr                   mantissa * 2^(exponent - 136)
 *     half      OpenEXR, or KTX 2.0 with zstd   as it is
 *
 * They are decoded before the graphics card interpolates, so what is shown between texels is right too. Memory: 8 bytes a texel.
 * Decoders of EXR, HDR, KTX and zstd are three's own, from three/addons, and only loaded where they are needed.
 */
import { ClampToEdgeWrapping, DataTexture, DataUtils, HalfFloatType, LinearFilter, NoColorSpace, RGBAFormat } from 'three';

const LARGEST_HALF = 65504;

/** Of every byte of alpha. */
const MX_POWERS = Float64Array.from({ length: 256 }, (_, a) => (a / 255) ** 2.2);

/**
 * @param {Uint8Array} bytes  the file
 * @param {string} encoding   extras.encoding of the lightmap
 * @param {number} range      extras.range, of rgbm8 and rgbm8-mx
 * @returns {Promise<DataTexture>} RGBA of half floats, first row at the top, as textures of glTF are
 */
export async function decodeLightmap(bytes, encoding, range = 1) {
  const { width, height, data } = await decoderOf(bytes, encoding)(bytes, range);
  const texture = new DataTexture(data, width, height, RGBAFormat, HalfFloatType);
  texture.colorSpace = NoColorSpace;
  texture.minFilter = texture.magFilter = LinearFilter;   // a smaller picture would mix neighbouring charts
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

function decoderOf(bytes, encoding) {
  switch (encoding) {
    case 'linear16': return (file) => halves(file, samples => value => samples[value] / 65535);
    case 'rgbm8': return (file, range) => halves(file, samples => (value, alpha) => samples[value] * samples[alpha] / 65025 * range);
    case 'rgbm8-mx': return (file, range) => halves(file, samples => (value, alpha) => samples[value] / 255 * MX_POWERS[samples[alpha]] * range);
    case 'rgbe8': return decodeHdr;
    case 'half': return bytes[0] === 0xab ? decodeKtx2 : decodeExr;
    default: throw new Error(`lightmap: encoding "${encoding}" is not known here`);
  }
}

/** RGBA of halves of a PNG; makeDecode(samples)(place of a channel, place of the texel's alpha) is its value. */
async function halves(file, makeDecode) {
  const { width, height, channels, samples } = await readPng(file);
  const decode = makeDecode(samples), data = new Uint16Array(width * height * 4), one = DataUtils.toHalfFloat(1);
  for (let texel = 0; texel < width * height; texel++) {
    const from = texel * channels, to = texel * 4;
    for (let c = 0; c < 3; c++) data[to + c] = DataUtils.toHalfFloat(Math.min(decode(from + c, from + 3), LARGEST_HALF));
    data[to + 3] = one;
  }
  return { width, height, data };
}

async function decodeHdr(bytes) {
  const { HDRLoader } = await import('three/addons/loaders/HDRLoader.js');
  return new HDRLoader().setDataType(HalfFloatType).parse(tightBuffer(bytes));
}

async function decodeExr(bytes) {
  const { EXRLoader } = await import('three/addons/loaders/EXRLoader.js');
  const { width, height, data, format } = new EXRLoader().setDataType(HalfFloatType).setOutputFormat(RGBAFormat).parse(tightBuffer(bytes));
  if (format !== RGBAFormat) throw new Error('MOZ_lightmap: expected an OpenEXR file with R, G and B');
  const flipped = new Uint16Array(data.length), row = width * 4;   // EXRLoader puts the bottom row first
  for (let y = 0; y < height; y++) flipped.set(data.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
  return { width, height, data: flipped };
}

async function decodeKtx2(bytes) {
  const R16G16B16A16_SFLOAT = 97, NONE = 0, ZSTD = 2;
  const { read } = await import('three/addons/libs/ktx-parse.module.js');
  const file = read(bytes), { pixelWidth: width, pixelHeight: height, levels: [level] } = file;
  if (file.vkFormat !== R16G16B16A16_SFLOAT || ![NONE, ZSTD].includes(file.supercompressionScheme))
    throw new Error('MOZ_lightmap: expected KTX 2.0 with vkFormat 97, plain or by zstd, ' +
      `found vkFormat ${file.vkFormat}, scheme ${file.supercompressionScheme}`);
  let content = level.levelData;
  if (file.supercompressionScheme === ZSTD) {
    const { ZSTDDecoder } = await import('three/addons/libs/zstddec.module.js');
    const zstd = new ZSTDDecoder();
    await zstd.init();
    content = zstd.decode(content, level.uncompressedByteLength);
  }
  return { width, height, data: new Uint16Array(tightBuffer(content)) };
}

/** A buffer of exactly these bytes. */
function tightBuffer(bytes) {
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
}

// --- PNG -----------------------------------------------------------------------------------------------------------------

/**
 * RGB or RGBA of 8 or 16 bits, not interlaced, which is what lightmaps are: { width, height, channels, samples }.
 * Source: Portable Network Graphics Specification (Third Edition), W3C.
 */
async function readPng(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), parts = [];
  let width, height, depth, kind, interlace;
  for (let at = 8; at + 12 <= bytes.length;) {
    const length = view.getUint32(at), name = String.fromCharCode(...bytes.subarray(at + 4, at + 8)), start = at + 8;
    if (name === 'IHDR') {
      [width, height] = [view.getUint32(start), view.getUint32(start + 4)];
      [depth, kind, interlace] = [bytes[start + 8], bytes[start + 9], bytes[start + 12]];
    }
    if (name === 'IDAT') parts.push(bytes.subarray(start, start + length));
    at = start + length + 4;
  }
  const channels = { 2: 3, 6: 4 }[kind];
  if (!channels || ![8, 16].includes(depth) || interlace)
    throw new Error(`MOZ_lightmap: expected a PNG of RGB or RGBA with 8 or 16 bits, found colour type ${kind} with ${depth} bits`);
  const rows = unfilter(await inflate(parts), height, width * channels * depth / 8, channels * depth / 8);
  return { width, height, channels, samples: depth === 8 ? rows : bigEndian(rows) };
}

async function inflate(parts) {
  const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Takes the filters of the rows away: `row` bytes each, behind a byte that names the filter; `step` bytes a texel. */
function unfilter(filtered, height, row, step) {
  if (filtered.length < height * (row + 1)) throw new Error('MOZ_lightmap: the PNG ends too early');
  const out = new Uint8Array(height * row);
  for (let y = 0; y < height; y++) {
    const from = y * (row + 1), to = y * row, predict = PREDICTORS[filtered[from]];
    if (!predict) throw new Error(`MOZ_lightmap: the PNG has a filter ${filtered[from]}, which there is not`);
    for (let x = 0; x < row; x++) {
      const left = x < step ? 0 : out[to + x - step], up = y ? out[to + x - row] : 0, corner = y && x >= step ? out[to + x - row - step] : 0;
      out[to + x] = filtered[from + 1 + x] + predict(left, up, corner);
    }
  }
  return out;
}

/** By the number of the filter. */
const PREDICTORS = [() => 0, left => left, (left, up) => up, (left, up) => (left + up) >> 1, paeth];

function paeth(left, up, corner) {
  const a = Math.abs(up - corner), b = Math.abs(left - corner), c = Math.abs(left + up - 2 * corner);
  return a <= b && a <= c ? left : b <= c ? up : corner;
}

function bigEndian(bytes) {
  const samples = new Uint16Array(bytes.length / 2);
  for (let i = 0; i < samples.length; i++) samples[i] = bytes[2 * i] << 8 | bytes[2 * i + 1];
  return samples;
}
