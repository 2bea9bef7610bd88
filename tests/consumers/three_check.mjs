// Runs the functions of three_page.js in headless Chromium.
// usage: node --import ./modules.mjs three_check.mjs FOLDER < JOB
//   FOLDER  what the page may load as /baked/...
//   JOB     JSON: { "call": "compare", "arguments": {...} }, or { "call": "picture", "arguments": {...}, "file": OUT.png }
// Prints the result as JSON. Chromium: LUXEL_CHROMIUM, else `chromium` of the path. Graphics are computed by SwiftShader.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { execFileSync } from 'node:child_process';
import { chromium } from 'playwright-core';
import { serve } from './page_server.mjs';

const [folder] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const PAGE = `<!doctype html><meta charset="utf-8">
<script type="importmap">{ "imports": { "three": "/modules/three/build/three.module.js", "three/addons/": "/modules/three/examples/jsm/" } }</script>
<body style="margin:0"><script type="module" src="/check/three_page.js"></script>`;

const job = JSON.parse(fs.readFileSync(0, 'utf8'));
const executablePath = process.env.LUXEL_CHROMIUM ?? execFileSync('which', ['chromium'], { encoding: 'utf8' }).trim();
const server = await serve({ modules: path.join(process.env.LUXEL_MODULES, 'node_modules'), check: here,
  tools: path.join(here, '../../tools/three'), baked: folder }, PAGE);
const browser = await chromium.launch({ executablePath, args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
try {
  const page = await browser.newPage({ viewport: { width: job.arguments.width ?? 512, height: job.arguments.height ?? 512 } });
  const complaints = [];
  page.on('console', message => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
  page.on('pageerror', error => complaints.push(String(error)));
  await page.goto(server.url);
  await page.waitForFunction(() => window.check, undefined, { timeout: 30000 }).catch(() => { throw new Error(complaints.join('\n')); });
  const result = await page.evaluate(({ call, arguments: given }) => window.check[call](given), job);
  if (job.file) await page.locator('canvas').screenshot({ path: job.file });
  console.log(JSON.stringify({ result, complaints }));
} finally {
  await browser.close();
  server.close();
}
