/**
 * MOZ_lightmap for glTF-Transform: without it that library drops lightmaps, and takes their UV set for unused.
 *
 *     import { NodeIO } from '@gltf-transform/core';
 *     import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
 *     import { LIGHTMAP_EXTENSIONS } from './moz-lightmap.js';
 *     const io = new NodeIO().registerExtensions([...ALL_EXTENSIONS, ...LIGHTMAP_EXTENSIONS]);
 *
 * A material's lightmap is then `material.getExtension('MOZ_lightmap')`: intensity (default 1), a texture with its TextureInfo
 * (UV set, sampler, KHR_texture_transform), and the extras that luxel writes: { quantity, unit, encoding, ... }. MOZ_texture_rgbe and
 * EXT_texture_exr are among the classes: textures whose picture is a Radiance or an OpenEXR file.
 *
 * What may be done to a baked file, and how, is in docs/viewers.md.
 *
 * Source  MOZ_lightmap (draft by T. Takahiro); the extension interface of glTF-Transform 4.
 */
import { Extension, ExtensionProperty, PropertyType, TextureChannel, TextureInfo } from '@gltf-transform/core';

const NAME = 'MOZ_lightmap';
const RGBA = TextureChannel.R | TextureChannel.G | TextureChannel.B | TextureChannel.A;

/** The lightmap of a material. */
export class Lightmap extends ExtensionProperty {
  static EXTENSION_NAME = NAME;

  init() {
    this.extensionName = NAME;
    this.propertyType = 'Lightmap';
    this.parentTypes = [PropertyType.MATERIAL];
  }

  getDefaults() {
    return Object.assign(super.getDefaults(), {
      intensity: 1,
      lightmapTexture: null,
      lightmapTextureInfo: new TextureInfo(this.graph, 'lightmapTextureInfo'),
    });
  }

  /** Factor of decoded texels. */
  getIntensity() {
    return this.get('intensity');
  }

  setIntensity(intensity) {
    return this.set('intensity', intensity);
  }

  getLightmapTexture() {
    return this.getRef('lightmapTexture');
  }

  /** All four channels are data: some encodings have a factor in alpha. */
  setLightmapTexture(texture) {
    return this.setRef('lightmapTexture', texture, { channels: RGBA });
  }

  /** UV set, sampler and transform; null without a texture. */
  getLightmapTextureInfo() {
    return this.getRef('lightmapTexture') ? this.getRef('lightmapTextureInfo') : null;
  }
}

export class MOZLightmap extends Extension {
  static EXTENSION_NAME = NAME;
  extensionName = NAME;
  prereadTypes = [PropertyType.MESH];
  prewriteTypes = [PropertyType.MESH];

  createLightmap() {
    return new Lightmap(this.document.getGraph());
  }

  read() {
    return this;
  }

  write() {
    return this;
  }

  preread(context) {
    const { materials = [], textures = [] } = context.jsonDoc.json;
    materials.forEach((material, index) => {
      const { intensity, ...info } = material.extensions?.[NAME] ?? {};
      if (info.index === undefined) return;
      const lightmap = this.createLightmap().setLightmapTexture(context.textures[textures[info.index].source]);
      if (intensity !== undefined) lightmap.setIntensity(intensity);
      context.setTextureInfo(lightmap.getLightmapTextureInfo(), { texCoord: 1, ...info });
      context.materials[index].setExtension(NAME, lightmap);
    });
    return this;
  }

  prewrite(context) {
    for (const material of this.document.getRoot().listMaterials()) {
      const lightmap = material.getExtension(NAME);
      const texture = lightmap?.getLightmapTexture();
      if (!texture) continue;
      const definition = context.jsonDoc.json.materials[context.materialIndexMap.get(material)];
      // The texture's members and the intensity share one object: KHR_texture_transform finds it as the one of this TextureInfo.
      const textureInfo = lightmap.getLightmapTextureInfo(), info = context.createTextureInfoDef(texture, textureInfo);
      // Said even where it is 0, to which prune() moves it: readers take 1 for the default.
      Object.assign(info, { texCoord: textureInfo.getTexCoord(), intensity: lightmap.getIntensity() });
      definition.extensions = { ...definition.extensions, [NAME]: info };
    }
    return this;
  }
}

/** A class for an extension by which textures name pictures of a kind that glTF does not know; magic: how such a file begins. */
function pictureExtension(name, magic) {
  const isOne = texture => magic.every((byte, index) => texture.getImage()?.[index] === byte);
  return class extends Extension {
    static EXTENSION_NAME = name;
    extensionName = name;
    prereadTypes = [PropertyType.TEXTURE];

    preread(context) {
      for (const texture of context.jsonDoc.json.textures ?? [])
        texture.source = texture.extensions?.[name]?.source ?? texture.source;
      return this;
    }

    read() {
      return this;
    }

    write(context) {
      const images = this.document.getRoot().listTextures().filter(isOne).map(texture => context.imageIndexMap.get(texture));
      for (const texture of context.jsonDoc.json.textures ?? []) {
        if (!images.includes(texture.source)) continue;
        texture.extensions = { ...texture.extensions, [name]: { source: texture.source } };
        delete texture.source;
      }
      return this;
    }
  };
}

export const MOZTextureRGBE = pictureExtension('MOZ_texture_rgbe', [0x23, 0x3f]);              // "#?"
export const EXTTextureEXR = pictureExtension('EXT_texture_exr', [0x76, 0x2f, 0x31, 0x01]);

/** All that luxel's files may need beside ALL_EXTENSIONS. Pictures first: the lightmap's class asks for them. */
export const LIGHTMAP_EXTENSIONS = [MOZTextureRGBE, EXTTextureEXR, MOZLightmap];
