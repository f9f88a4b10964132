// Reads the OpenAPI document and makes a form of every operation.

// Everything is asked relative to this page, so that a prefix of a reverse proxy stays in place.
const ROOT = new URL("../", document.baseURI).href;

const EXAMPLES = { scene: "demo", layer: "radiance", z: "6", x: "38", y: "32", kind: "out-of-range" };

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function field(parameter, scene) {
  const schema = parameter.schema ?? {};
  if (schema.enum) {
    const options = ["", ...schema.enum].map((value) => element("option", { value, textContent: value }));
    return element("select", {}, ...options);
  }
  const preset = parameter.in === "path" ? (EXAMPLES[parameter.name] ?? "") : "";
  const input = element("input", { value: parameter.name === "scene" ? scene.id : preset });
  if (parameter.required && parameter.name === "lat") input.value = scene.latitude;
  if (parameter.required && parameter.name === "lon") input.value = scene.longitude;
  if (schema.default !== undefined) input.placeholder = String(schema.default);
  return input;
}

async function show(response, output) {
  const type = response.headers.get("content-type") ?? "";
  const lines = [`${response.status} ${response.statusText}`];
  for (const [name, value] of response.headers) lines.push(`${name}: ${value}`);
  const head = element("pre", { textContent: lines.join("\n") });
  if (type.startsWith("image/png") || type.startsWith("image/webp")) {
    const url = URL.createObjectURL(await response.blob());
    const image = element("img", { src: url, alt: "The picture answered" });
    image.addEventListener("load", () => URL.revokeObjectURL(url));
    output.replaceChildren(head, image);
  } else if (type.includes("json") || type.startsWith("text/") || type.includes("openmetrics")) {
    let text = await response.text();
    if (type.includes("json") && text.length < 200_000) text = JSON.stringify(JSON.parse(text), null, 2);
    if (text.length > 50_000) text = `${text.slice(0, 50_000)}\n… ${text.length} characters in all`;
    output.replaceChildren(head, element("pre", { textContent: text }));
  } else {
    const size = (await response.arrayBuffer()).byteLength;
    output.replaceChildren(head, element("p", { textContent: `${size} bytes of ${type}` }));
  }
}

function operation(path, method, description, scene) {
  const fields = (description.parameters ?? []).map((parameter) => [parameter, field(parameter, scene)]);
  const rows = fields.map(([parameter, input]) => {
    input.setAttribute("aria-label", parameter.name);
    const name = element("td", {}, element("code", { textContent: parameter.name + (parameter.required ? " *" : "") }));
    return element("tr", {}, name, element("td", {}, input), element("td", { textContent: parameter.description ?? "" }));
  });
  const answers = Object.entries(description.responses ?? {}).map(([status, answer]) =>
    element("li", { textContent: `${status}: ${answer.description ?? ""} ${Object.keys(answer.content ?? {}).join(", ")}` }));
  const url = element("code");
  const output = element("div");
  const build = () => {
    let target = path;
    const query = new URLSearchParams();
    for (const [parameter, input] of fields) {
      if (parameter.in === "path") target = target.replace(`{${parameter.name}}`, encodeURIComponent(input.value));
      else if (input.value !== "") query.set(parameter.name, input.value);
    }
    const text = query.toString();
    return ROOT + target.slice(1) + (text === "" ? "" : `?${text}`);
  };
  const refresh = () => { url.textContent = build(); };
  for (const [, input] of fields) input.addEventListener("input", refresh);
  refresh();
  const send = element("button", { textContent: "Try it" });
  send.addEventListener("click", async () => {
    output.replaceChildren(element("p", { textContent: "…" }));
    try {
      await show(await fetch(build(), { method: method.toUpperCase() }), output);
    } catch (error) {
      output.replaceChildren(element("p", { textContent: `No answer: ${error.message}` }));
    }
  });
  const head = element("summary", {},
    element("span", { className: "method", textContent: method.toUpperCase() }),
    element("span", { className: "path", textContent: path }),
    element("span", { className: "summary", textContent: description.summary ?? "" }));
  const parts = [head, element("p", { textContent: description.description ?? "" })];
  if (rows.length > 0) parts.push(element("table", {}, ...rows));
  parts.push(element("ul", {}, ...answers), element("p", {}, url), send, output);
  return element("details", {}, ...parts);
}

async function first_scene() {
  const scenes = await fetch(`${ROOT}api/v1/scenes`).then((answer) => (answer.ok ? answer.json() : [])).catch(() => []);
  if (scenes.length === 0) return { id: "demo", latitude: "", longitude: "" };
  const [west, south, east, north] = scenes[0].bounds;
  const width = west > east ? east + 360 - west : east - west;
  return { id: scenes[0].id, latitude: ((south + north) / 2).toFixed(3), longitude: (west + width / 2).toFixed(3) };
}

const [api, scene] = await Promise.all([fetch(`${ROOT}api/v1/openapi.json`).then((answer) => answer.json()), first_scene()]);
document.querySelector("#about").textContent = `${api.info.description ?? ""} Version ${api.info.version}.`;
const groups = new Map();
for (const [path, methods] of Object.entries(api.paths)) {
  for (const [method, description] of Object.entries(methods)) {
    if (description.responses === undefined) continue;
    const tag = description.tags?.[0] ?? "other";
    if (!groups.has(tag)) groups.set(tag, []);
    groups.get(tag).push(operation(path, method, description, scene));
  }
}
const main = document.querySelector("#operations");
main.replaceChildren();
for (const tag of ["sky", "scenes", "tiles", "atmospheres", "operation", "other"]) {
  if (groups.has(tag)) main.append(element("h2", { textContent: tag }), ...groups.get(tag));
}
