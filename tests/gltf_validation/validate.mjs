// Validates .glb files: node validate.mjs NODE_MODULES FILE... ; exit code 1 when any has an error or a warning.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const [modules, ...files] = process.argv.slice(2);
const { validateBytes } = createRequire(`${modules}/`)('gltf-validator');

let failures = 0;
for (const file of files) {
  const report = await validateBytes(new Uint8Array(readFileSync(file)), { uri: file, maxIssues: 20 });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints`);
  for (const { severity, code, message, pointer } of messages) {
    if (severity <= 1 || process.env.VERBOSE) console.log(`  ${code} ${pointer ?? ''}: ${message}`);
  }
  failures += numErrors + numWarnings;
}
if (files.length === 0) {
  console.log('no files to validate');
  failures = 1;
}
process.exit(failures === 0 ? 0 : 1);
