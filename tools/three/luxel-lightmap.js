/**
 * Lightmaps of luxel in three.js: a plugin of GLTFLoader for MOZ_lightmap and MX_lightmap, as luxel and other tools write them.
 *
 *     import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
 *     import { luxelLightmaps } from './luxel-lightmap.js';
 *     const loader = new GLTFLoader();
 *     loader.register(luxelLightmaps());
 *
 * Every material with MOZ_lightmap gets `lightMap`, on the UV set and with the KHR_texture_transform that it names, and
 * `lightMapIntensity`. three then shows, where there is no other light,
 *
 *     radiance [nits] = reflectance / pi * irradiance [lux],
 *     irradiance = decoded texel * intensity * extras.irradianceFactor (1 where a file does not say it)
 *
 * times `renderer.toneMappingExposure`. How a texel is decoded follows from `extras.encoding` of the extension:
 *
 *     srgb8    8 bits, sRGB encoded        by the graphics card, before it interpolates
 *     linear8  8 bits, proportional        taken as they are
 *     linear16, rgbm8, rgbm8-mx, rgbe8, half  to half floats while loading (lightmap-decoders.js, which is loaded when it is needed)
 *
 * A file without `extras.encoding` is not luxel's; options.encoding says what it has.
 *
 * Nodes with MX_lightmap get materials of their own with the same: nodes that share a mesh differ by `scale` and `offset`, which move uv1 to
 * the node's place on the page. Such lightmaps are rgbm8-mx, and say irradiance / pi (their irradianceFactor is pi), as its description has it.
 *
 * Copies by EXT_mesh_gpu_instancing, each with a place of its own on the page (attributes _LIGHTMAP_OFFSET and _LIGHTMAP_SCALE of the
 * extension), get geometry that shares all arrays but those, and materials whose shader adds the place.
 *
 * The lamps of a file are in its lightmaps already: they are made invisible, so that nothing is lit twice.
 * Works with materials that are lit and with those that are unlit (MeshBasicMaterial: three divides by pi there too). Emission
 * stays what the material says: nits, on the same scale. docs/viewers.md has a page, and advice about exposure.
 *
 * Source  MOZ_lightmap (draft by T. Takahiro), MX_lightmap (draft by R. Long); three.js r187, which has no loader for them.
 */
import {
  BufferGeometry, InstancedBufferAttribute, LoaderUtils, MeshPhysicalMaterial, MeshStandardMaterial, NoColorSpace, SRGBColorSpace,
} from 'three';

const EXTENSION = 'MOZ_lightmap', NODE_EXTENSION = 'MX_lightmap';

/** What the description of MX_lightmap says of all of them. */
const MX_MEANING = { encoding: 'rgbm8-mx', range: 34.49, irradianceFactor: Math.PI };

/** Of encodings that browsers and graphics cards decode by themselves. The others are made half floats. */
const COLOR_SPACES = { srgb8: SRGBColorSpace, linear8: NoColorSpace };

/** What three's HDRLoader makes of a mantissa m is m / 255, where the file means m / 256. */
const DECODER_FACTORS = { rgbe8: 255 / 256 };

/** Extensions by which a texture names a picture that glTF does not know. */
const PICTURE_EXTENSIONS = ['MOZ_texture_rgbe', 'EXT_texture_exr', 'KHR_texture_basisu'];

/** Places of copies, as luxel writes them: coordinate on the page = uv1 * scale + offset. */
const COPY_OFFSET = '_LIGHTMAP_OFFSET', COPY_SCALE = '_LIGHTMAP_SCALE';

/** The same arrays and these: a geometry may be shown by several nodes, whose copies have other places. */
function geometryWithPlaces(geometry, places) {
  const placed = new BufferGeometry();
  placed.name = geometry.name;
  placed.setIndex(geometry.index);
  placed.morphAttributes = geometry.morphAttributes;
  placed.morphTargetsRelative = geometry.morphTargetsRelative;
  placed.boundingBox = geometry.boundingBox;
  placed.boundingSphere = geometry.boundingSphere;
  for (const [name, attribute] of [...Object.entries(geometry.attributes), ...places]) placed.setAttribute(name, attribute);
  return placed;
}

/** The MX_lightmap of a node with the members of a MOZ_lightmap, and its place on the page. */
function nodeLightmap(node) {
  const lightmap = node?.extensions?.[NODE_EXTENSION];
  if (!lightmap) return undefined;
  const { lightMapTexture, intensity = 1, scale = [1, 1], offset = [0, 0], extras } = lightmap;
  const areCopies = node.extensions.EXT_mesh_gpu_instancing !== undefined;   // these have their places in attributes
  return { texCoord: 1, ...lightMapTexture, intensity, extras: { ...MX_MEANING, ...extras }, place: areCopies ? undefined : { scale, offset } };
}

/** A copy that reflects as luxel baked it (options.lambert). */
function lambertCopy(material) {
  if (!material.isMeshStandardMaterial) return material.clone();
  const copy = new MeshPhysicalMaterial(), { defines } = copy;
  (material.isMeshPhysicalMaterial ? copy.copy : MeshStandardMaterial.prototype.copy).call(copy, material);
  return Object.assign(copy, { defines, metalness: 0, specularIntensity: 0 });
}

function withPlaces(vertexShader) {
  const place = `(lightMapTransform * vec3(LIGHTMAP_UV * ${COPY_SCALE} + ${COPY_OFFSET}, 1.0)).xy`;
  return `attribute vec2 ${COPY_OFFSET};\nattribute vec2 ${COPY_SCALE};\n` +
    vertexShader.replace('#include <uv_vertex>', `#include <uv_vertex>\n#ifdef USE_LIGHTMAP\n  vLightMapUv = ${place};\n#endif`);
}

/**
 * What to give to GLTFLoader.register().
 *
 * @param {object} [options]
 * @param {boolean} [options.lambert=false]  true: surfaces reflect as luxel baked them, diffusely: metals too, and without the
 *     1.5 % and more (at grazing angles) of diffuse light that three's standard material takes away for its mirror-like part. Right
 *     without an environment map, where that part has nothing to show; then radiance is exactly reflectance / pi * irradiance.
 * @param {number} [options.scale=1]  factor of all lightmaps, for scenes whose other lights are on another scale than luxel's
 * @param {boolean} [options.keepLamps=false]  true: the lamps of the file stay visible
 * @param {string} [options.encoding='srgb8']  of files that do not say it themselves
 */
export function luxelLightmaps(options = {}) {
  return parser => new LightmapPlugin(parser, { lambert: false, scale: 1, keepLamps: false, encoding: 'srgb8', ...options });
}

class LightmapPlugin {
  constructor(parser, options) {
    this.name = EXTENSION;
    this.parser = parser;
    this.options = options;
    const { materials = [], nodes = [] } = parser.json;
    this.lightmaps = [...materials.map((_, index) => this.lightmapOf(index)), ...nodes.map(nodeLightmap)].filter(Boolean);
    this.litByNodes = new Map();   // materials: lightmap as text: promise of the copy with it
  }

  // --- called by GLTFLoader; null leaves the choice to other plugins and to itself ----------------------------------------

  getMaterialType(materialIndex) {
    return this.lightmapOf(materialIndex) && this.options.lambert ? MeshPhysicalMaterial : null;
  }

  extendMaterialParams(materialIndex, params) {
    const lightmap = this.lightmapOf(materialIndex);
    if (!lightmap) return Promise.resolve();
    if (this.options.lambert) Object.assign(params, { metalness: 0, specularIntensity: 0 });
    return this.assignLightmap(params, lightmap);
  }

  /** Unlit materials: GLTFLoader makes them without asking plugins for parameters. */
  loadMaterial(materialIndex) {
    const lightmap = this.lightmapOf(materialIndex);
    if (!lightmap || !this.isUnlit(materialIndex)) return null;
    return this.parser.loadMaterial(materialIndex).then(async material => {
      await this.assignLightmap(material, lightmap);
      return material;
    });
  }

  /** Pictures that have to be decoded here. */
  loadTexture(textureIndex) {
    const lightmap = this.lightmaps.find(item => item.index === textureIndex);
    return lightmap && !(this.encodingOf(lightmap) in COLOR_SPACES) ? this.decodeTexture(textureIndex, lightmap) : null;
  }

  /** After the whole file is loaded. */
  async afterRoot(gltf) {
    if (!this.lightmaps.length) return;
    const objects = [];
    for (const scene of gltf.scenes) scene.traverse(object => objects.push(object));
    if (!this.options.keepLamps) for (const object of objects) if (object.isLight) object.visible = false;
    await Promise.all(objects.map(async object => {
      await this.lightNode(object);
      await this.placeCopies(object);
    }));
  }

  // -------------------------------------------------------------------------------------------------------------------------

  lightmapOf(materialIndex) {
    return this.parser.json.materials[materialIndex].extensions?.[EXTENSION];
  }

  isUnlit(materialIndex) {
    return this.parser.json.materials[materialIndex].extensions?.KHR_materials_unlit !== undefined;
  }

  encodingOf(lightmap) {
    return lightmap.extras?.encoding ?? this.options.encoding;
  }

  /** Into a material, or into the parameters of one. */
  async assignLightmap(params, lightmap) {
    const encoding = this.encodingOf(lightmap);
    const { intensity = 1, extras: { irradianceFactor = 1 } = {} } = lightmap;
    params.lightMapIntensity = intensity * irradianceFactor * (DECODER_FACTORS[encoding] ?? 1) * this.options.scale;
    await this.parser.assignTexture(params, 'lightMap', { texCoord: 1, ...lightmap }, COLOR_SPACES[encoding]);
  }

  /** The node of the file that an object stands for, if it does. */
  nodeOf(object) {
    return this.parser.json.nodes?.[this.parser.associations.get(object)?.nodes];
  }

  /** The meshes of a node itself, without those of its children. */
  meshesOf(object) {
    const below = object.children.filter(child => !this.nodeOf(child)).flatMap(child => this.meshesOf(child));
    return object.isMesh ? [object, ...below] : below;
  }

  /** Of a node with MX_lightmap. */
  async lightNode(object) {
    const lightmap = nodeLightmap(this.nodeOf(object));
    if (!lightmap) return;
    const set = lightmap.texCoord ? `uv${lightmap.texCoord}` : 'uv';
    await Promise.all(this.meshesOf(object).map(async mesh => {
      if (mesh.geometry.attributes[set]) mesh.material = await this.materialOfNode(mesh.material, lightmap);
    }));
  }

  /** One for each lightmap and place, as a material may be shown by many nodes. */
  materialOfNode(material, lightmap) {
    if (!this.litByNodes.has(material)) this.litByNodes.set(material, new Map());
    const copies = this.litByNodes.get(material), key = JSON.stringify(lightmap);
    if (!copies.has(key)) copies.set(key, this.makeMaterialOfNode(material, lightmap));
    return copies.get(key);
  }

  async makeMaterialOfNode(material, lightmap) {
    const copy = this.options.lambert ? lambertCopy(material) : material.clone();
    await this.assignLightmap(copy, lightmap);
    if (!lightmap.place) return copy;
    copy.lightMap = copy.lightMap.clone();   // shares the picture
    copy.lightMap.repeat.fromArray(lightmap.place.scale);
    copy.lightMap.offset.fromArray(lightmap.place.offset);
    return copy;
  }

  /** Of a node with EXT_mesh_gpu_instancing that has places for its copies. */
  async placeCopies(object) {
    const { parser } = this, node = this.nodeOf(object);
    const attributes = node?.extensions?.EXT_mesh_gpu_instancing?.attributes;
    if (attributes?.[COPY_OFFSET] === undefined || attributes[COPY_SCALE] === undefined) return;
    const places = await Promise.all([COPY_OFFSET, COPY_SCALE].map(async name => {
      const { array } = await parser.getDependency('accessor', attributes[name]);
      return [name, new InstancedBufferAttribute(array, 2)];
    }));
    for (const mesh of this.meshesOf(object)) {
      if (!mesh.isInstancedMesh || !mesh.material.lightMap) continue;
      mesh.geometry = geometryWithPlaces(mesh.geometry, places);
      mesh.material = this.materialWithPlaces(mesh.material);
    }
  }

  /** One for each, as others may show it without places. */
  materialWithPlaces(material) {
    this.placed ??= new Map();
    if (!this.placed.has(material)) {
      const copy = material.clone();
      copy.onBeforeCompile = shader => { shader.vertexShader = withPlaces(shader.vertexShader); };
      copy.customProgramCacheKey = () => 'luxel copies';
      this.placed.set(material, copy);
    }
    return this.placed.get(material);
  }

  async decodeTexture(textureIndex, lightmap) {
    const [bytes, { decodeLightmap }] = await Promise.all([this.readPicture(textureIndex), import('./lightmap-decoders.js')]);
    const texture = await decodeLightmap(bytes, this.encodingOf(lightmap), lightmap.extras?.range);
    texture.name = this.parser.json.textures[textureIndex].name ?? '';
    this.parser.associations.set(texture, { textures: textureIndex });
    return texture;
  }

  /** The file behind a texture, as bytes. */
  async readPicture(textureIndex) {
    const { parser } = this, texture = parser.json.textures[textureIndex];
    const extension = PICTURE_EXTENSIONS.find(name => texture.extensions?.[name]);
    const image = parser.json.images[(extension ? texture.extensions[extension] : texture).source];
    if (image.bufferView !== undefined) return new Uint8Array(await parser.getDependency('bufferView', image.bufferView));
    return new Uint8Array(await parser.fileLoader.loadAsync(LoaderUtils.resolveURL(image.uri, parser.options.path)));
  }
}
