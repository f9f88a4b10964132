// A map of a scene beside the sky of a place of it (widget.py). Python makes all pictures and numbers and sends them; nothing is
// asked of any server here.

/** How far a pointer may move during a click, pixels. */
const CLICK_PX = 5;
/** Degrees of latitude across the map at least, and how much one step of zooming is. */
const LEAST_SPAN_DEG = 0.02;
const ZOOM_STEP = 2;
/** The map's picture is asked for when it has been still for so long, milliseconds. */
const STILL_MS = 150;
/** Arrow keys move the place by so much of the map's height; with Shift, by a fifth of it. */
const KEY_STEP = 0.05;
/** After the last key the sky is asked for, milliseconds. */
const KEY_STILL_MS = 400;
const KM_PER_DEG = 111.195;

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const turned = (longitudeDeg) => ((((longitudeDeg + 180) % 360) + 360) % 360) - 180;

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

function url(view) {
  return URL.createObjectURL(new Blob([view], { type: "image/png" }));
}

/** Puts a picture into an image, and lets go of the one before. */
function putPicture(image, view) {
  const before = image.src;
  if (view?.byteLength) image.src = url(view);
  else image.removeAttribute("src");
  if (before.startsWith("blob:")) URL.revokeObjectURL(before);
}

function placeText(lat, lon) {
  const north = `${Math.abs(lat).toFixed(4)}° ${lat < 0 ? "S" : "N"}`;
  return `${north}, ${Math.abs(lon).toFixed(4)}° ${lon < 0 ? "W" : "E"}`;
}

/** Three digits that count, in a unit that suits. */
function amount(value, unit) {
  if (!(value > 0)) return `0 ${unit}`;
  const [factor, prefix] = value < 1e-3 ? [1e6, "µ"] : value < 1 ? [1e3, "m"] : [1, ""];
  return `${Number((value * factor).toPrecision(3))} ${prefix}${unit}`;
}

/** The numbers that a sky begins with: a name, a text, and what it means. */
function headline({ sky }) {
  const magnitude = (value) => (value == null ? "–" : `${value.toFixed(2)} mag/arcsec²`);
  const rows = [
    ["Zenith", magnitude(sky.zenith_total_brightness_mag_arcsec2), "brightness with the natural sky; more is darker"],
    ["Artificial over natural", `${Number(sky.ratio_to_natural.toPrecision(2))} ×`, "light at the zenith"],
    ["Sky Quality Meter", magnitude(sky.sqm_total_brightness_mag_arcsec2), "what it would read"],
    ["Bortle class", sky.bortle_class ?? "–", "1 is the darkest, 9 the brightest"],
    ["Faintest star", sky.naked_eye_limit_mag == null ? "–" : `${sky.naked_eye_limit_mag.toFixed(1)} mag`, "by the naked eye"],
    ["On level ground", amount(sky.horizontal_illuminance_lx, "lx"), "illuminance by artificial light"],
  ];
  return rows.map(([name, text, meaning]) => make("div", { title: meaning }, make("dt", {}, name), make("dd", {}, String(text))));
}

/** A round length for a scale bar of at most so many kilometres. */
function roundLength(atMost) {
  const power = 10 ** Math.floor(Math.log10(atMost));
  return [5, 2, 1].map((digit) => digit * power).find((length) => length <= atMost) ?? power;
}

/** The map: what part of the ground it shows, and everything that lies on it. */
class SkyMap {
  constructor(model, choose) {
    this.model = model;
    this.choose = choose;
    this.pointers = new Map();
    const [west, south, east, north] = model.get("bounds");
    this.scene = { west, south, east: east < west ? east + 360 : east, north };
    this.centre = { lat: (south + north) / 2, lon: (west + this.scene.east) / 2 };
    this.spanDeg = 0;
    this.chart = make("img", { class: "chart", alt: "", draggable: "false" });
    this.edge = make("div", { class: "edge" });
    this.names = make("div", { class: "names", "aria-hidden": "true" });
    this.marker = make("div", { class: "marker", hidden: "" });
    this.bar = make("div", { class: "bar", "aria-hidden": "true" });
    this.note = make("p", { class: "note", role: "status" }, "The map is being made …");
    const button = (sign, label, factor) =>
      make("button", { type: "button", "aria-label": label, title: label, onclick: () => this.zoom(factor) }, sign);
    this.area = make(
      "div",
      {
        class: "area",
        tabindex: "0",
        role: "application",
        "aria-label": `Map of ${model.get("title")}. Arrow keys move the place, with Shift in small steps; plus and minus zoom.`,
        onpointerdown: (event) => this.press(event),
        onpointermove: (event) => this.drag(event),
        onpointerup: (event) => this.release(event),
        onpointercancel: (event) => this.pointers.delete(event.pointerId),
        onwheel: (event) => this.wheel(event),
        onkeydown: (event) => this.key(event),
      },
      this.chart,
      this.edge,
      this.names,
      this.marker,
      this.bar,
    );
    const zoom = make(
      "div",
      { class: "zoom" },
      button("+", "Zoom in", 1 / ZOOM_STEP),
      button("−", "Zoom out", ZOOM_STEP),
      make("button", { type: "button", "aria-label": "The whole scene", title: "The whole scene", onclick: () => this.fit() }, "□"),
    );
    this.element = make("div", { class: "map" }, this.area, zoom, this.note);
    this.sizes = new ResizeObserver(() => this.resized());
    this.sizes.observe(this.area);
  }

  get size() {
    return { width: this.area.clientWidth, height: this.area.clientHeight };
  }

  /** Degrees of longitude and latitude for a pixel. */
  get perPixel() {
    const lat = this.spanDeg / this.size.height;
    return { lat, lon: lat / Math.max(Math.cos((this.centre.lat * Math.PI) / 180), 0.05) };
  }

  toPixel(lat, lon) {
    const { perPixel, centre, size } = this;
    const east = turned(lon - centre.lon);
    return [size.width / 2 + east / perPixel.lon, size.height / 2 - (lat - centre.lat) / perPixel.lat];
  }

  toPlace(x, y) {
    const { perPixel, centre, size } = this;
    const lat = clamp(centre.lat - (y - size.height / 2) * perPixel.lat, -90, 90);
    return { lat: +lat.toFixed(6), lon: +turned(centre.lon + (x - size.width / 2) * perPixel.lon).toFixed(6) };
  }

  /** Shows the whole scene. */
  fit() {
    const { west, south, east, north } = this.scene;
    const { width, height } = this.size;
    this.centre = { lat: (south + north) / 2, lon: (west + east) / 2 };
    const shrunk = Math.max(Math.cos((this.centre.lat * Math.PI) / 180), 0.05);
    this.spanDeg = Math.max(north - south, ((east - west) * shrunk * height) / width);
    this.moved();
  }

  resized() {
    if (this.size.width === 0) return;
    if (this.spanDeg === 0) this.fit();
    else this.moved();
  }

  zoom(factor, at = null) {
    const { width, height } = this.size;
    const [x, y] = at ?? [width / 2, height / 2];
    const before = this.toPlace(x, y);
    this.spanDeg = clamp(this.spanDeg * factor, LEAST_SPAN_DEG, 180);
    const after = this.toPlace(x, y);
    this.pan(before.lat - after.lat, turned(before.lon - after.lon));
  }

  pan(lat, lon) {
    this.centre = { lat: clamp(this.centre.lat + lat, -90, 90), lon: turned(this.centre.lon + lon) };
    this.moved();
  }

  at(event) {
    const box = this.area.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  press(event) {
    if (event.button !== 0) return;
    this.area.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.at(event));
    this.click = this.pointers.size === 1 ? this.at(event) : null;
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) return;
    const now = this.at(event);
    if (this.click && Math.hypot(now[0] - this.click[0], now[1] - this.click[1]) <= CLICK_PX) return;
    this.click = null;
    if (this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
      const apart = ([x, y]) => Math.max(Math.hypot(x - other[0], y - other[1]), 10);
      this.zoom(apart(before) / apart(now), other);
    } else {
      const { lat, lon } = this.perPixel;
      this.pan((now[1] - before[1]) * lat, (before[0] - now[0]) * lon);
    }
    this.pointers.set(event.pointerId, now);
  }

  release(event) {
    const wasDown = this.pointers.delete(event.pointerId);
    if (!wasDown || !this.click) return;
    const { lat, lon } = this.toPlace(...this.at(event));
    this.click = null;
    this.choose(lat, lon);
  }

  /** With Ctrl alone, and by pinching a touchpad: a notebook scrolls. */
  wheel(event) {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    this.zoom(2 ** clamp(event.deltaY / 100, -1, 1), this.at(event));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = KEY_STEP * (event.shiftKey ? 0.2 : 1) * this.size.height;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    if (event.key in moves) this.movePlace(moves[event.key]);
    else if (event.key === "+" || event.key === "=") this.zoom(1 / ZOOM_STEP);
    else if (event.key === "-") this.zoom(ZOOM_STEP);
    else return;
    // Neither the page nor the notebook, which has keys of its own, is to move.
    event.preventDefault();
    event.stopPropagation();
  }

  movePlace([right, down]) {
    const { width, height } = this.size;
    const [x, y] = this.place ? this.toPixel(this.place.lat, this.place.lon) : [width / 2, height / 2];
    const moved = this.place ? this.toPlace(x + right, y + down) : this.toPlace(x, y);
    this.mark(moved.lat, moved.lon);
    const [nowX, nowY] = this.toPixel(moved.lat, moved.lon);
    if (nowX < 0 || nowY < 0 || nowX > width || nowY > height) {
      this.pan(moved.lat - this.centre.lat, turned(moved.lon - this.centre.lon));
    }
    clearTimeout(this.keyTimer);
    this.keyTimer = setTimeout(() => this.choose(moved.lat, moved.lon), KEY_STILL_MS);
  }

  /** Marks a place; none without a latitude. */
  mark(lat, lon) {
    this.place = lat == null || lon == null ? null : { lat, lon };
    this.marker.hidden = this.place === null;
    this.layOut();
  }

  /** What is on the map follows at once; a picture of it when it is still. */
  moved() {
    this.layOut();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.ask(), STILL_MS);
  }

  ask() {
    const { size, centre, perPixel, spanDeg } = this;
    if (size.width === 0) return;
    const acrossDeg = Math.min(size.width * perPixel.lon, 360);
    const [south, north] = [Math.max(centre.lat - spanDeg / 2, -90), Math.min(centre.lat + spanDeg / 2, 90)];
    const sharp = Math.min(window.devicePixelRatio || 1, 2);
    const bounds = [centre.lon - acrossDeg / 2, south, centre.lon + acrossDeg / 2, north];
    const sizePx = [(acrossDeg / perPixel.lon) * sharp, ((north - south) / perPixel.lat) * sharp].map((side) =>
      Math.max(Math.round(side), 1),
    );
    this.area.setAttribute("aria-busy", "true");
    this.model.send({ kind: "map", bounds, size_px: sizePx });
  }

  /** What Python sent. */
  take(message, buffers) {
    if (message.kind === "map-changed") this.ask();
    if (message.kind !== "map" && message.kind !== "map-problem") return;
    this.area.removeAttribute("aria-busy");
    this.note.textContent = message.kind === "map-problem" ? message.text : "";
    if (message.kind === "map-problem") return;
    this.shown = message.bounds;
    putPicture(this.chart, buffers[0]);
    this.names.replaceChildren(
      ...message.places.map(({ name, lat, lon }) => {
        const label = make("span", {}, name);
        label.place = { lat, lon };
        return label;
      }),
    );
    this.layOut();
  }

  layOut() {
    if (this.spanDeg === 0) return;
    const { west, south, east, north } = this.scene;
    this.stretch(this.edge, [west, south, east, north]);
    if (this.shown) this.stretch(this.chart, this.shown);
    if (this.place) {
      const [x, y] = this.toPixel(this.place.lat, this.place.lon);
      Object.assign(this.marker.style, { left: `${x}px`, top: `${y}px` });
    }
    this.layOutNames();
    const { width, height } = this.size;
    const kmPerPixel = (this.spanDeg * KM_PER_DEG) / height;
    const length = roundLength(0.25 * width * kmPerPixel);
    this.bar.style.width = `${length / kmPerPixel}px`;
    this.bar.textContent = length < 1 ? `${Math.round(length * 1000)} m` : `${length} km`;
  }

  /** Lays an element over a part of the ground. */
  stretch(element, [west, south, east, north]) {
    const { perPixel } = this;
    const [x, y] = this.toPixel((south + north) / 2, (west + east) / 2);
    const [width, height] = [(east - west) / perPixel.lon, (north - south) / perPixel.lat];
    const [left, top] = [x - width / 2, y - height / 2];
    Object.assign(element.style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
  }

  /** The largest places first; a name that would lie on another one is left out. */
  layOutNames() {
    const taken = [];
    const { width, height } = this.size;
    for (const label of this.names.children) {
      const [x, y] = this.toPixel(label.place.lat, label.place.lon);
      const [w, h] = [8 * label.textContent.length + 14, 20];
      const isLeft = x + w > width;
      const left = isLeft ? x - w : x;
      const box = [left, y - h / 2, left + w, y + h / 2];
      const isFree = taken.every(([west, top, east, bottom]) => box[2] < west || box[0] > east || box[3] < top || box[1] > bottom);
      label.hidden = !isFree || left < 0 || y < 8 || y > height - 8;
      if (label.hidden) continue;
      taken.push(box);
      label.className = isLeft ? "left" : "";
      Object.assign(label.style, { left: `${x}px`, top: `${y}px` });
    }
  }

  end() {
    this.sizes.disconnect();
    clearTimeout(this.timer);
    clearTimeout(this.keyTimer);
    putPicture(this.chart, null);
  }
}

/** The sky of the place: a picture, numbers, and what went wrong. */
function skyPanel(model) {
  const image = make("img", { alt: "" });
  const caption = make("figcaption", {}, "Click on the map: here will be the sky of the place.");
  const figure = make("figure", { class: "picture" }, image, caption);
  const numbers = make("dl", { class: "numbers" });
  const status = make("p", { class: "status", role: "status" });
  const put = () => {
    const [sky, problem, isBusy] = [model.get("sky"), model.get("problem"), model.get("is_busy")];
    status.textContent = problem || (isBusy ? "The sky is being made …" : "");
    status.classList.toggle("problem", problem !== "");
    figure.classList.toggle("busy", isBusy);
    if (isBusy) return;
    putPicture(image, model.get("picture"));
    numbers.replaceChildren(...(sky ? headline(sky) : []));
    if (!sky) {
      image.alt = "";
      if (model.get("lat") != null) caption.textContent = "";
      return;
    }
    const { observer, scene } = sky;
    const where = `${placeText(observer.latitude_deg, observer.longitude_deg)}, ${Math.round(observer.altitude_m)} m`;
    image.alt = `The sky at ${where}: north up, east left`;
    caption.textContent = [where, sky.time, scene.illustrative ? "illustrative light, not measured" : scene.attribution]
      .filter(Boolean)
      .join(" · ");
  };
  return { elements: [figure, numbers, status], put };
}

/** Latitude and longitude to be read, written and pasted. */
function placeForm(model, choose) {
  const field = (name, label, most) => {
    const input = make("input", { name, type: "number", step: "any", min: -most, max: most, required: "", inputmode: "decimal" });
    return { input, label: make("label", {}, label, input) };
  };
  const [lat, lon] = [field("lat", "Latitude, °N", 90), field("lon", "Longitude, °E", 180)];
  // Both at once, as people paste them.
  lat.input.addEventListener("paste", (event) => {
    const pair = /^\s*(-?[\d.]+)\s*[,;\s]\s*(-?[\d.]+)\s*$/.exec(event.clipboardData.getData("text"));
    if (!pair) return;
    event.preventDefault();
    [lat.input.value, lon.input.value] = [pair[1], pair[2]];
  });
  const submit = (event) => {
    event.preventDefault();
    choose(lat.input.valueAsNumber, lon.input.valueAsNumber);
  };
  // Keys of a field are not the notebook's.
  const keep = (event) => event.stopPropagation();
  const form = make(
    "form",
    { class: "place", onsubmit: submit, onkeydown: keep },
    lat.label,
    lon.label,
    make("button", {}, "Show the sky"),
  );
  const put = () => {
    for (const [name, { input }] of [
      ["lat", lat],
      ["lon", lon],
    ])
      input.value = model.get(name) == null ? "" : +model.get(name).toFixed(6);
  };
  return { form, put };
}

function render({ model, el }) {
  let map;
  const choose = (lat, lon) => {
    map.mark(lat, lon);
    model.send({ kind: "place", lat, lon });
  };
  map = new SkyMap(model, choose);
  const { form, put: putForm } = placeForm(model, choose);
  const { elements, put: putSky } = skyPanel(model);
  const putPlace = () => {
    map.mark(model.get("lat"), model.get("lon"));
    putForm();
  };
  const heading = make("p", { class: "title" }, `${model.get("title")}: artificial light at the zenith`);
  const [figure, numbers, status] = elements;
  el.classList.add("skyglow-widget");
  el.replaceChildren(
    make("div", { class: "left" }, heading, map.element, form),
    make("div", { class: "right" }, figure, numbers, status),
  );
  const events = [
    ["change:lat", putPlace],
    ["change:lon", putPlace],
    ["msg:custom", (message, buffers) => map.take(message, buffers)],
  ];
  for (const name of ["sky", "picture", "problem", "is_busy"]) events.push([`change:${name}`, putSky]);
  for (const [name, act] of events) model.on(name, act);
  putPlace();
  putSky();
  return () => {
    for (const [name, act] of events) model.off(name, act);
    map.end();
  };
}

export default { render };
