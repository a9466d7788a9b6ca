// Prints the Khronos validator's report on one file, as JSON. Usage: node validate.cjs FILE
const fs = require("fs");
const path = require("path");
const validator = require("gltf-validator");

const file = process.argv[2];
const beside = (uri) => path.resolve(path.dirname(file), decodeURIComponent(uri));

validator
  .validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 0, // no limit
    writeTimestamp: false,
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(beside(uri))),
  })
  .then((report) => console.log(JSON.stringify(report)))
  .catch((error) => {
    console.error(String(error));
    process.exit(1);
  });
