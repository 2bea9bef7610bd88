// Serves files to a page of our own in headless Chromium, from loopback only.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';

const KINDS = { '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json', '.wasm': 'application/wasm' };

/// `folders` maps the first part of a path to a folder; `page` is what "/" gives. Returns { url, close }.
export async function serve(folders, page) {
  const server = http.createServer((request, response) => {
    const { pathname } = new URL(request.url, 'http://localhost');
    if (pathname === '/') {
      response.writeHead(200, { 'Content-Type': 'text/html' }).end(page);
      return;
    }
    if (pathname === '/favicon.ico') {  // browsers ask by themselves
      response.writeHead(204).end();
      return;
    }
    const [, first, ...rest] = decodeURIComponent(pathname).split('/');
    const folder = folders[first] && path.resolve(folders[first]);
    const file = folder && path.resolve(folder, ...rest);
    if (!file || !file.startsWith(folder + path.sep) || !fs.existsSync(file) || !fs.statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'Content-Type': KINDS[path.extname(file)] ?? 'application/octet-stream' });
    fs.createReadStream(file).pipe(response);
  });
  await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}
