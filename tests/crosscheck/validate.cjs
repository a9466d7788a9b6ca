// Prints the Khronos validator's reports on files, as a JSON list. Usage: node validate.cjs FILE...
const fs = require("fs");
const path = require("path");
const validator = require("gltf-validator");

const report = (file) => {
  const beside = (uri) => path.resolve(path.dirname(file), decodeURIComponent(uri));
  return validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 0, // no limit
    writeTimestamp: false,
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(beside(uri))),
  });
};

Promise.all(process.argv.slice(2).map(report))
  .then((reports) => console.log(JSON.stringify(reports)))
  .catch((error) => {
    console.error(String(error));
    process.exit(1);
  });
