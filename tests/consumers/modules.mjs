// Lets the scripts of this folder, and the modules of tools/, import packages of build/deps/consumers by their names.
// usage: node --import ./modules.mjs SCRIPT; LUXEL_MODULES names the folder with node_modules
import { register } from 'node:module';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { isMainThread } from 'node:worker_threads';

const parentURL = pathToFileURL(path.resolve(process.env.LUXEL_MODULES, 'package.json')).href;

if (isMainThread) register(import.meta.url);  // the hook below runs in a thread of its own

export async function resolve(specifier, context, next) {
  const isPackage = /^[@a-z]/.test(specifier) && !/^(node|file|data):/.test(specifier);
  return next(specifier, isPackage ? { ...context, parentURL } : context);
}
