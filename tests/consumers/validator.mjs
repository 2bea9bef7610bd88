// What the Khronos validator says of glTF files: one JSON object a line, { file, errors, warnings }, each a list of
// { code, pointer, message }. It knows some extensions and says of others that it does not (severity 2, not listed).
// usage: node --import ./modules.mjs validator.mjs FILE...
import fs from 'node:fs';
import path from 'node:path';
import validator from 'gltf-validator';

const files = process.argv.slice(2);
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file), maxIssues: 0,
    externalResourceFunction: uri => fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(uri))).then(b => new Uint8Array(b)),
  });
  const listed = severity => report.issues.messages.filter(issue => issue.severity === severity)
    .map(({ code, pointer, message }) => ({ code, pointer, message }));
  console.log(JSON.stringify({ file, errors: listed(0), warnings: listed(1) }));
}
