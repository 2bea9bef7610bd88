// Reads a baked model with glTF-Transform and MOZ_lightmap's extension class, does what it is told, and writes it again.
// usage: node --import ./modules.mjs transform_check.mjs INPUT OUTPUT [STEP...]
//   STEP  dedup, prune, weld, flatten, join, meshopt (EXT_meshopt_compression, lossless: no quantisation), without-extension
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS, EXTMeshoptCompression } from '@gltf-transform/extensions';
import { dedup, flatten, join, prune, weld } from '@gltf-transform/functions';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';
import { LIGHTMAP_EXTENSIONS } from '../../tools/gltf-transform/moz-lightmap.js';

const [input, output, ...steps] = process.argv.slice(2);
await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready]);
const extensions = steps.includes('without-extension') ? ALL_EXTENSIONS : [...ALL_EXTENSIONS, ...LIGHTMAP_EXTENSIONS];
const io = new NodeIO().registerExtensions(extensions).registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'meshopt.encoder': MeshoptEncoder });
const document = await io.read(input);
const known = { dedup: dedup(), prune: prune(), weld: weld(), flatten: flatten(), join: join() };
await document.transform(...steps.filter(step => step in known).map(step => known[step]));
if (steps.includes('meshopt'))
  document.createExtension(EXTMeshoptCompression).setRequired(true).setEncoderOptions({ method: EXTMeshoptCompression.EncoderMethod.QUANTIZE });
await io.write(output, document);
