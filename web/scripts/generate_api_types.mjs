// Writes src/api/schema.ts from the server's OpenAPI document, so that the viewer spells no path, parameter or
// field by hand. The document is the snapshot that the server's own test holds it to. Plain Node, no packages.
//   node scripts/generate_api_types.mjs          writes
//   node scripts/generate_api_types.mjs check    fails when the written file is not what the document gives
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const web = dirname(dirname(fileURLToPath(import.meta.url)));
const document_path = join(web, "../server/http/tests/interface/snapshots/interface__document__openapi.snap");
const target_path = join(web, "src", "api", "schema.ts");

const identifier = (name) => name.replace(/[^A-Za-z0-9_]/g, "_");
const key = (name) => (/^[A-Za-z_][A-Za-z0-9_]*$/.test(name) ? name : JSON.stringify(name));
const indent = (text) => text.replace(/\n/g, "\n  ");
const comment = (text) => (text ? `/** ${text.trim().replace(/\*\//g, "* /").replace(/\s*\n\s*/g, " ")} */\n` : "");
const unique = (types) => [...new Set(types)].join(" | ");
const in_array = (type) => (/[|&]/.test(type) ? `(${type})` : type);

function type_of(schema) {
  if (schema === undefined || schema === true || Object.keys(schema).length === 0) return "unknown";
  if (schema.$ref !== undefined) return identifier(schema.$ref.split("/").pop());
  if (schema.const !== undefined) return JSON.stringify(schema.const);
  if (schema.enum !== undefined) return unique(schema.enum.map((value) => JSON.stringify(value)));
  for (const name of ["oneOf", "anyOf"]) if (schema[name] !== undefined) return unique(schema[name].map(type_of));
  if (schema.allOf !== undefined) {
    const own = schema.properties === undefined ? [] : [object_of(schema)];
    return [...schema.allOf.map(type_of), ...own].map(in_array).join(" & ");
  }
  if (Array.isArray(schema.type)) return unique(schema.type.map((type) => type_of({ ...schema, type })));
  switch (schema.type) {
    case "array": {
      if (schema.prefixItems !== undefined) return `[${schema.prefixItems.map(type_of).join(", ")}]`;
      const item = in_array(type_of(schema.items));
      const fixed = schema.minItems !== undefined && schema.minItems === schema.maxItems && schema.minItems <= 8;
      return fixed ? `[${new Array(schema.minItems).fill(item).join(", ")}]` : `${item}[]`;
    }
    case "integer":
    case "number":
      return "number";
    case "boolean":
    case "string":
    case "null":
      return schema.type;
    default:
      return object_of(schema);
  }
}

function object_of(schema) {
  const required = new Set(schema.required ?? []);
  const fields = Object.entries(schema.properties ?? {}).map(
    ([name, field]) => `${comment(field.description)}${key(name)}${required.has(name) ? "" : "?"}: ${type_of(field)};`,
  );
  if (fields.length > 0) return `{\n  ${indent(fields.join("\n"))}\n}`;
  return schema.additionalProperties ? `Record<string, ${type_of(schema.additionalProperties)}>` : "Record<string, unknown>";
}

function parameters_of(operation, place, document) {
  const parameters = (operation.parameters ?? [])
    .map((parameter) => (parameter.$ref === undefined ? parameter : document.components.parameters[parameter.$ref.split("/").pop()]))
    .filter((parameter) => parameter.in === place);
  if (parameters.length === 0) return "Record<string, never>";
  return type_of({
    type: "object",
    properties: Object.fromEntries(parameters.map(({ name, schema, description }) => [name, { ...schema, description }])),
    required: parameters.filter(({ required }) => required).map(({ name }) => name),
  });
}

function text_of(document) {
  const parts = ["// Made from the OpenAPI document by scripts/generate_api_types.mjs; do not edit."];
  for (const [name, schema] of Object.entries(document.components?.schemas ?? {}).sort(([a], [b]) => (a < b ? -1 : 1))) {
    parts.push(`${comment(schema.description)}export type ${identifier(name)} = ${type_of(schema)};`);
  }
  parts.push(`/** Everything that GET answers: by path, what it takes and what comes back. */\n${operations(document, "get", "Gets")}`);
  parts.push(`/** Everything that POST answers: by path, what it takes with which body, and what comes back. */\n${operations(document, "post", "Posts")}`);
  return `${parts.join("\n\n")}\n`;
}

function operations(document, method, name) {
  const entries = Object.entries(document.paths)
    .filter(([, item]) => item[method] !== undefined)
    .sort(([a], [b]) => (a < b ? -1 : 1))
    .map(([path, { [method]: operation }]) => {
      const content = (operation.responses?.["200"] ?? operation.responses?.["201"])?.content ?? {};
      const answer = content["application/json"] === undefined ? "Blob" : type_of(content["application/json"].schema);
      const body = operation.requestBody?.content?.["application/json"];
      const fields = [
        `path: ${parameters_of(operation, "path", document)};`,
        `query: ${parameters_of(operation, "query", document)};`,
        ...(body === undefined ? [] : [`body: ${type_of(body.schema)};`]),
        `answer: ${answer};`,
      ];
      return `${comment(operation.summary)}${JSON.stringify(path)}: {\n  ${indent(fields.join("\n"))}\n};`;
    });
  return `export interface ${name} {\n  ${indent(entries.join("\n"))}\n}`;
}

/** The snapshot is a header between two lines `---` and then the document. */
function snapshot_document() {
  const [, , ...rest] = readFileSync(document_path, "utf8").split(/^---$/m);
  return JSON.parse(rest.join("---"));
}

const made = text_of(snapshot_document());
if (process.argv[2] === "check") {
  if (readFileSync(target_path, "utf8") !== made) {
    console.error("src/api/schema.ts is not what the OpenAPI document gives. Write it again: npm run api-types");
    process.exit(1);
  }
  console.log("src/api/schema.ts is what the OpenAPI document gives");
} else {
  writeFileSync(target_path, made);
}
