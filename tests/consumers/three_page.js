// In the browser: shows a baked model by three.js with luxel's plugin, and compares what is drawn with the float pages.
// Kept apart from the driver (three_check.mjs), which calls the functions on `window.check`.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { luxelLightmaps } from '/tools/luxel-lightmap.js';

const SIZE = 512;   // pixels of the picture, across
const STEP = 4;     // every so many pixels are compared

let renderer;

function useRenderer(width, height, antialias) {
  renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true, antialias });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height, false);
  document.body.replaceChildren(renderer.domElement);
}

function load(url, options) {
  const loader = new GLTFLoader();
  loader.register(luxelLightmaps(options));
  return loader.loadAsync(url);
}

function cameraOf({ from, at, fov }, aspect, near = 0.01) {
  const camera = new THREE.PerspectiveCamera(fov, aspect, near, 100);
  camera.position.set(...from);
  camera.lookAt(...at);
  camera.updateMatrixWorld(true);
  return camera;
}

// --- what is drawn -------------------------------------------------------------------------------------------------------

/** Linear values of every pixel, without tone mapping: rows from the bottom, RGBA floats. */
function drawLinear(scene, camera) {
  const target = new THREE.WebGLRenderTarget(SIZE, SIZE, { type: THREE.FloatType, colorSpace: THREE.NoColorSpace });
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const pixels = new Float32Array(SIZE * SIZE * 4);
  renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, pixels);
  renderer.setRenderTarget(null);
  target.dispose();
  return pixels;
}

/** What a user sees: bytes of the canvas, sRGB, with linear tone mapping at this exposure. Rows from the bottom. */
function drawExposed(scene, camera, exposure) {
  renderer.toneMapping = THREE.LinearToneMapping;
  renderer.toneMappingExposure = exposure;
  renderer.render(scene, camera);
  const context = renderer.getContext(), pixels = new Uint8Array(SIZE * SIZE * 4);
  context.readPixels(0, 0, SIZE, SIZE, context.RGBA, context.UNSIGNED_BYTE, pixels);
  return pixels;
}

// --- what should be drawn ------------------------------------------------------------------------------------------------

async function loadPages(urls) {
  const loader = new EXRLoader().setDataType(THREE.FloatType);
  return Promise.all(urls.map(async url => {
    const { image: { width, height, data } } = await loader.loadAsync(url);
    const channels = data.length / (width * height);
    const largest = data.reduce((most, value, at) => at % channels < 3 ? Math.max(most, value) : most, 0);
    return { width, height, data, channels, largest };
  }));
}

/** Irradiance at a place of a page, in lux: linear between texel centres, as on the graphics card. v is down from the top. */
function irradianceAt(page, uv) {
  const { width, height, data, channels } = page;
  const x = uv.x * width - 0.5, y = uv.y * height - 0.5;
  const left = Math.floor(x), top = Math.floor(y), sum = [0, 0, 0];
  for (const [column, row, weight] of [[left, top, (1 - x + left) * (1 - y + top)], [left + 1, top, (x - left) * (1 - y + top)],
    [left, top + 1, (1 - x + left) * (y - top)], [left + 1, top + 1, (x - left) * (y - top)]]) {
    const c = Math.min(Math.max(column, 0), width - 1), r = Math.min(Math.max(row, 0), height - 1);
    const at = ((height - 1 - r) * width + c) * channels;  // the loader puts the bottom row first
    for (let k = 0; k < 3; k++) sum[k] += weight * data[at + k];
  }
  return sum;
}

/** The first surface behind the middle of a pixel, if its lightmap is seen from its front; else null. */
function hitAt(raycaster, camera, meshes, column, row) {
  const place = new THREE.Vector2((column + 0.5) / SIZE * 2 - 1, (row + 0.5) / SIZE * 2 - 1);
  raycaster.setFromCamera(place, camera);
  return raycaster.intersectObjects(meshes, false)[0] ?? null;
}

function expectedAt(hit, pages) {
  const { material } = hit.object, uv = hit.uv1.clone();
  if (hit.object.isInstancedMesh) {
    const { _LIGHTMAP_OFFSET: offset, _LIGHTMAP_SCALE: scale } = hit.object.geometry.attributes, i = hit.instanceId;
    uv.set(uv.x * scale.getX(i) + offset.getX(i), uv.y * scale.getY(i) + offset.getY(i));
  }
  material.lightMap.updateMatrix();
  uv.applyMatrix3(material.lightMap.matrix);
  const page = pages[Number(/^lightmap(\d+)/.exec(material.lightMap.name)[1])];
  const lux = irradianceAt(page, uv), colour = material.color.toArray();
  return { lux, largest: page.largest, radiance: lux.map((value, k) => colour[k] / Math.PI * value) };
}

/**
 * Per compared pixel: lux (of the float page), largest (of that page), expected (reflectance / pi * lux), linear (drawn, not tone
 * mapped), exposed (bytes of the canvas). Only pixels whose neighbours show the same object, and surfaces that do not emit.
 */
async function compare({ model, pages, camera: view, options, exposure }) {
  useRenderer(SIZE, SIZE, false);
  const [{ scene }, exrs] = await Promise.all([load(model, options), loadPages(pages)]);
  const camera = cameraOf(view, 1);
  scene.updateMatrixWorld(true);
  const linear = drawLinear(scene, camera), exposed = drawExposed(scene, camera, exposure);
  const meshes = [];
  scene.traverse(object => object.isMesh && object.material.lightMap && meshes.push(object));
  const raycaster = new THREE.Raycaster(), found = [];
  for (let row = STEP; row < SIZE - STEP; row += STEP)
    for (let column = STEP; column < SIZE - STEP; column += STEP) {
      const hit = hitAt(raycaster, camera, meshes, column, row);
      if (!hit || (hit.object.material.emissive?.getHex() ?? 0) !== 0) continue;
      const around = [[1, 1], [-1, 1], [1, -1], [-1, -1]].map(([x, y]) => hitAt(raycaster, camera, meshes, column + x, row + y));
      if (around.some(other => other?.object !== hit.object || other.face.normal.dot(hit.face.normal) < 0.999)) continue;
      const at = (row * SIZE + column) * 4, { lux, largest, radiance } = expectedAt(hit, exrs);
      found.push({ column, row, object: hit.object.name, lux, largest, expected: radiance, linear: Array.from(linear.subarray(at, at + 3)),
        exposed: Array.from(exposed.subarray(at, at + 3)) });
    }
  return found;
}

/** Draws a picture for a person; returns nothing, the driver takes it from the page. */
async function picture({ model, camera: view, options, exposure, width, height }) {
  useRenderer(width, height, true);
  const { scene } = await load(model, options);
  renderer.toneMapping = THREE.AgXToneMapping;
  renderer.toneMappingExposure = exposure;
  renderer.render(scene, cameraOf(view, width / height));
}

window.check = { compare, picture };
