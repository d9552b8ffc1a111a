"use strict";
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const press = (buttons, chosen) => buttons.forEach((b) => b.setAttribute("aria-pressed", String(b === chosen)));

  // ---- theme
  const themes = all("[data-theme-of]");
  themes.forEach((button) => button.addEventListener("click", () => {
    press(themes, button);
    const name = button.dataset.themeOf;
    if (name === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
  }));

  // ---- orders of rows: numbers where both are, else text; ties keep the order of the file
  const compare = (a, b) => (isFinite(a) && isFinite(b) ? a - b : a.localeCompare(b));
  all("[data-sorts]").forEach((group) => {
    const rows = document.getElementById(group.dataset.sorts);
    const buttons = all("button", group);
    const initial = [...rows.children];
    buttons.forEach((button) => button.addEventListener("click", () => {
      press(buttons, button);
      const key = button.dataset.by;
      rows.append(...[...initial].sort((a, b) => compare(a.dataset[key], b.dataset[key])));
    }));
  });

  // ---- zoom of the graph
  const view = document.getElementById("graph-view");
  const drawing = view.querySelector("svg");
  const [, , wide, high] = drawing.getAttribute("viewBox").split(" ").map(Number);
  const fitting = () => Math.min(1, view.clientWidth / wide);
  const scaleGraph = (scale) => {
    drawing.dataset.scale = scale;
    drawing.setAttribute("width", wide * scale);
    drawing.setAttribute("height", high * scale);
  };
  const zooms = {
    in: () => Number(drawing.dataset.scale) * 1.25, out: () => Number(drawing.dataset.scale) / 1.25,
    full: () => 1, fit: fitting,
  };
  all("[data-zoom]").forEach((b) => b.addEventListener("click", () => scaleGraph(zooms[b.dataset.zoom]())));
  scaleGraph(Math.max(0.6, fitting())); // smaller could not be read

  // ---- filter of decisions
  const filter = document.getElementById("decision-filter");
  const groups = all("#decision-list details");
  const opened = groups.map((group) => group.open);
  filter.addEventListener("input", () => {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    groups.forEach((group, index) => {
      let here = 0;
      all("li", group).forEach((row) => {
        row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
        here += !row.hidden;
      });
      found += here;
      group.hidden = here === 0;
      group.open = words.length ? here > 0 : opened[index];
    });
    document.getElementById("decision-count").textContent = words.length ? `${found} found` : "";
  });

  // ---- viewer of targets
  const viewer = document.getElementById("viewer");
  if (!viewer) return;
  let parsed; // megabytes, and not needed until a picture is opened
  const entries = () => (parsed ??= JSON.parse(document.getElementById("targets-data").textContent));
  const part = (name) => document.getElementById(`viewer-${name}`);
  const canvas = part("canvas"), stage = part("stage"), cross = stage.querySelector(".cross");
  const plate = stage.querySelector(".plate");
  const ARRAYS = {
    u1: Uint8Array, i1: Int8Array, u2: Uint16Array, i2: Int16Array, u4: Uint32Array, i4: Int32Array, f4: Float32Array,
  };
  let target, values, shown, zoom = 1, at = null;

  // Byte planes, deflated: all first bytes, then all second bytes. Answers with channel after channel, rows from the top.
  async function unpack(entry) {
    const packed = Uint8Array.from(atob(entry.data), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const planes = new Uint8Array(await new Response(stream).arrayBuffer());
    const kind = ARRAYS[entry.type], width = kind.BYTES_PER_ELEMENT, count = planes.length / width;
    const bytes = new Uint8Array(planes.length);
    for (let b = 0; b < width; b += 1) for (let i = 0; i < count; i += 1) bytes[i * width + b] = planes[b * count + i];
    return new kind(bytes.buffer);
  }

  const encode = (x) => (x <= 0.0031308 ? x * 12.92 : 1.055 * x ** (1 / 2.4) - 0.055);

  function paint() {
    const { columns, rows, scale, srgb } = target, size = columns * rows;
    const low = Number(part("low").value), range = Number(part("high").value) - low || 1;
    const pixels = new ImageData(columns, rows);
    const planes = shown.length === 1 ? [shown[0], shown[0], shown[0]] : shown;
    for (let i = 0; i < size; i += 1) {
      let bad = false;
      for (let c = 0; c < 3; c += 1) {
        const value = planes[c] === undefined ? low : values[planes[c] * size + i] * scale;
        bad ||= Number.isNaN(value);
        const ratio = Math.min(1, Math.max(0, (value - low) / range));
        pixels.data[4 * i + c] = 255 * (srgb ? encode(ratio) : ratio) + 0.5;
      }
      if (bad) pixels.data.set([255, 0, 255], 4 * i);
      pixels.data[4 * i + 3] = 255;
    }
    canvas.getContext("2d").putImageData(pixels, 0, 0);
  }

  const number = (x) => (Number.isInteger(x) ? String(x) : String(Number(x.toPrecision(4))));

  function read() {
    cross.hidden = !at;
    if (!at) return;
    const [x, y] = at, size = target.columns * target.rows;
    const kept = (index, wanted, count) => Math.floor(((2 * index + 1) * count) / (2 * wanted));
    const [width, height] = target.samples; // reduced twice: when it was read back, and for this page
    const across = kept(kept(x, target.columns, width), width, target.width);
    const up = kept(kept(target.rows - 1 - y, target.rows, height), height, target.height);
    const layer = Math.floor(across / target.layer_width);
    const where = `texel (${across % target.layer_width}, ${up})` + (target.layers > 1 ? ` of layer ${layer}` : "");
    const texts = [...Array(Math.min(4, target.channels)).keys()].map((c) => {
      const value = values[c * size + y * target.columns + x] * target.scale;
      return `${"RGBA"[c]} ${number(value)}`;
    });
    part("value").textContent = `${where}: ${texts.join("  ")}`;
    Object.assign(cross.style, { left: `${x * zoom}px`, top: `${y * zoom}px`, width: `${zoom}px`, height: `${zoom}px` });
  }

  function resize(factor) {
    const fit = Math.min(stage.clientWidth / target.columns, stage.clientHeight / target.rows);
    zoom = factor ? Math.min(Math.max(64, 4 * fit), Math.max(fit / 4, zoom * factor)) : fit;
    canvas.style.width = `${target.columns * zoom}px`;
    canvas.style.height = `${target.rows * zoom}px`;
    read();
    if (at && factor) cross.scrollIntoView({ block: "center", inline: "center", behavior: "instant" });
  }

  function channels() {
    const count = Math.min(4, target.channels), first = [...Array(Math.min(3, count)).keys()];
    const choices = count === 1 ? [["R", first]] : [["RGB".slice(0, first.length), first]];
    if (count > 1) for (let c = 0; c < count; c += 1) choices.push(["RGBA"[c], [c]]);
    shown = first;
    const buttons = choices.map(([text, planes]) => {
      const button = document.createElement("button");
      Object.assign(button, { type: "button", textContent: text });
      button.addEventListener("click", () => { press(buttons, button); shown = planes; paint(); });
      return button;
    });
    press(buttons, buttons[0]);
    part("channels").replaceChildren(...buttons);
  }

  function range() {
    part("low").value = Number(target.low.toPrecision(4));
    part("high").value = Number(target.high.toPrecision(4));
  }

  async function open(index) {
    const targets = entries();
    target = targets[(index + targets.length) % targets.length];
    const whole = target.columns === target.width && target.rows === target.height;
    const kept = whole ? "" : `, of which ${target.columns}×${target.rows} texels are kept`;
    part("name").textContent = target.name;
    part("facts").textContent = `${target.format} · ${target.width}×${target.height}${kept}` +
      `${target.srgb ? " · shown encoded sRGB" : ""} · texel (0, 0) is the lower left`;
    part("value").textContent = "Point at the picture, or use the arrow keys, to read values.";
    at = null;
    Object.assign(canvas, { width: target.columns, height: target.rows });
    channels();
    range();
    if (!viewer.open) {
      viewer.showModal();
      stage.focus();
    }
    const mine = target, unpacked = await unpack(target);
    if (mine !== target) return;
    values = unpacked;
    paint();
    resize(0);
    viewer.dataset.ready = target.name;
  }

  const move = (x, y) => {
    at = [Math.min(target.columns - 1, Math.max(0, x)), Math.min(target.rows - 1, Math.max(0, y))];
    read();
  };
  const point = (event) => {
    const box = canvas.getBoundingClientRect();
    move(Math.floor((event.clientX - box.left) / zoom), Math.floor((event.clientY - box.top) / zoom));
  };
  canvas.addEventListener("pointermove", point);
  canvas.addEventListener("pointerdown", point);
  stage.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    resize(event.deltaY < 0 ? 1.25 : 0.8);
  }, { passive: false });
  const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  stage.addEventListener("keydown", (event) => {
    const step = STEPS[event.key];
    if (step) {
      const far = event.shiftKey ? 10 : 1;
      const [x, y] = at ?? [target.columns >> 1, target.rows >> 1];
      move(x + far * step[0], y + far * step[1]);
      cross.scrollIntoView({ block: "nearest", inline: "nearest", behavior: "instant" });
    } else if (event.key === "+" || event.key === "=") resize(1.25);
    else if (event.key === "-") resize(0.8);
    else if (event.key === "0") resize(0);
    else return;
    event.preventDefault();
  });
  all("[data-scale]").forEach((b) => b.addEventListener("click", () => resize({ in: 1.5, out: 1 / 1.5, fit: 0 }[b.dataset.scale])));
  ["low", "high"].forEach((name) => part(name).addEventListener("input", paint));
  part("reset").addEventListener("click", () => { range(); paint(); });
  viewer.querySelector("[data-close]").addEventListener("click", () => viewer.close());
  viewer.addEventListener("click", (event) => { if (event.target === viewer) viewer.close(); });
  all("[data-go]").forEach((b) => b.addEventListener("click", () => open(entries().indexOf(target) + Number(b.dataset.go))));
  all("[data-target]").forEach((b) => b.addEventListener("click", () => open(Number(b.dataset.target))));
  all("[data-open]").forEach((b) => b.addEventListener("click", () => open(entries().findIndex((t) => t.name === b.dataset.open))));
})();
