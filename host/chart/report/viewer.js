// SPDX-License-Identifier: MIT
// The comparer: two images by wipe or flip, and crops of all at one place.
"use strict";

const viewer = element("viewer");
const view = { x: pictures.width >> 1, y: pictures.height >> 1, flipped: false };
const layers = new Map();  // by image, kind and exposure

const nameOf = (index) => (index === 0 ? "reference" : chart.images[index - 1].sampler);
const zoom = () => Number(element("zoom").value);
const exposure = () => pictures.exposure * 2 ** Number(element("exposure").value);
const shownImages = () => [0, ...chart.images.flatMap((image, i) => (image[chosen("set")] ? [i + 1] : []))];
const selected = (id) => Number(element(id).value);

async function layerOf(index) {
  const what = chosen("what");
  const key = `${index} ${what} ${what === "image" ? exposure() : ""}`;
  if (!layers.has(key)) {
    if (layers.size > 60) layers.clear();
    layers.set(key, drawPicture(index, what, exposure()));
  }
  return layers.get(key);
}

// Where the image is in the viewer: device pixels per image pixel, and the image's corner.
function placement() {
  const scale = (viewer.width / pictures.width) * zoom();
  const clampTo = (centre, size, room) => Math.min(0, Math.max(room - size * scale, room / 2 - (centre + 0.5) * scale));
  return { scale, left: clampTo(view.x, pictures.width, viewer.width), top: clampTo(view.y, pictures.height, viewer.height) };
}

function resize() {
  const ratio = window.devicePixelRatio || 1;
  viewer.width = Math.max(1, Math.round(viewer.clientWidth * ratio));
  viewer.height = Math.max(1, Math.round((viewer.width * pictures.height) / pictures.width));
  viewer.style.aspectRatio = `${pictures.width} / ${pictures.height}`;
}

const cropSize = () => Math.min(Number(element("crop").value), pictures.width, pictures.height);
function cropCorner() {
  const clampTo = (centre, size) => Math.min(size - cropSize(), Math.max(0, centre - (cropSize() >> 1)));
  return [clampTo(view.x, pictures.width), clampTo(view.y, pictures.height)];
}

let drawing = 0;
async function drawViewer() {
  const turn = ++drawing;
  const [a, b] = [selected("image-a"), selected("image-b")];
  const [layerA, layerB] = await Promise.all([layerOf(a), layerOf(b)]);
  if (turn !== drawing) return;
  const wipes = chosen("mode") === "wipe";
  const context = viewer.getContext("2d");
  const { scale, left, top } = placement();
  context.imageSmoothingEnabled = false;
  context.fillStyle = "#000";
  context.fillRect(0, 0, viewer.width, viewer.height);
  const paint = (layer) => context.drawImage(layer, left, top, pictures.width * scale, pictures.height * scale);
  paint(!wipes && view.flipped ? layerB : layerA);
  if (wipes) {
    const edge = Math.round((viewer.width * element("wipe").value) / 100);
    context.save();
    context.beginPath();
    context.rect(edge, 0, viewer.width - edge, viewer.height);
    context.clip();
    paint(layerB);
    context.restore();
    context.fillStyle = "#fff";
    context.fillRect(edge - 1, 0, 2, viewer.height);
  }
  const [x, y] = cropCorner();
  context.strokeStyle = "#ffd500";
  context.lineWidth = 2;
  context.strokeRect(left + x * scale, top + y * scale, cropSize() * scale, cropSize() * scale);
  const label = (text, at, align) => {
    context.font = `${Math.round(13 * (window.devicePixelRatio || 1))}px sans-serif`;
    context.textAlign = align;
    context.lineWidth = 4;
    context.strokeStyle = "#000";
    context.strokeText(text, at, viewer.height - 10);
    context.fillStyle = "#fff";
    context.fillText(text, at, viewer.height - 10);
  };
  if (wipes || !view.flipped) label(`A: ${nameOf(a)}`, 10, "left");
  if (wipes || view.flipped) label(`B: ${nameOf(b)}`, viewer.width - 10, "right");
  viewer.setAttribute("aria-label", (chosen("what") === "image" ? "" : "Error maps: ") + (wipes
    ? `${nameOf(a)} on the left of ${element("wipe").value}% of the width, ${nameOf(b)} on the right`
    : nameOf(view.flipped ? b : a)));
  await describePixel(a, b);
}

// The values of both images at the place of the crops.
async function describePixel(a, b) {
  const [pixelsA, pixelsB, truth] = await Promise.all([pixelsOf(a), pixelsOf(b), pixelsOf(0)]);
  const at = 3 * (view.y * pictures.width + view.x);
  const values = (pixels) => [0, 1, 2].map((c) => number(pixels[at + c])).join(" ");
  element("viewer-value").textContent = `pixel ${view.x}, ${view.y}: A ${values(pixelsA)}; B ${values(pixelsB)}; reference ${values(truth)} cd/m²`;
}

let cropTurn = 0;
async function drawCrops() {
  const turn = ++cropTurn;
  const size = cropSize();
  const [x, y] = cropCorner();
  for (const button of element("crops").children) {
    const index = Number(button.value);
    const [layer, pixels, truth] = await Promise.all([layerOf(index), pixelsOf(index), pixelsOf(0)]);
    if (turn !== cropTurn) return;
    const canvas = button.querySelector("canvas");
    canvas.width = canvas.height = size;
    canvas.getContext("2d").drawImage(layer, x, y, size, size, 0, 0, size, size);
    button.setAttribute("aria-pressed", String(index === selected("image-b")));
    if (index === 0) continue;
    const errors = errorsOf(pixels, truth);
    let sum = 0;
    for (let row = y; row < y + size; ++row)
      for (let column = x; column < x + size; ++column) sum += errors[row * pictures.width + column];
    button.querySelector(".here").textContent = `relMSE here ${number(sum / size ** 2)}`;
  }
}

function draw() {
  drawViewer();
  drawCrops();
}

function makeCrop(index) {
  const lines = [make("strong", { textContent: nameOf(index) })];
  if (index > 0) {
    const image = chart.images[index - 1];
    for (const text of [inWords(image), `${number(image.seconds)} s`, `relMSE ${number(image.relmse)}`])
      lines.push(make("br"), text);
    lines.push(make("br"), make("span", { className: "here" }));
  }
  const button = make("button", { type: "button", value: index }, make("canvas"), make("span", {}, ...lines));
  button.querySelector("canvas").setAttribute("aria-hidden", "true");
  button.addEventListener("click", () => { element("image-b").value = index; draw(); });
  return button;
}

// The images of the chosen set; the same methods stay chosen.
function listImages() {
  const names = ["image-a", "image-b"].map((id) => (element(id).value === "" ? null : nameOf(selected(id))));
  const indices = shownImages();
  const wanted = [names[0] ?? "reference", names[1] ?? chart.baseline];
  ["image-a", "image-b"].forEach((id, i) => {
    element(id).replaceChildren(...indices.map((index) => make("option", { value: index, textContent:
      index === 0 ? "reference" : `${nameOf(index)}, ${inWords(chart.images[index - 1])}` })));
    element(id).value = indices.find((index) => nameOf(index) === wanted[i]) ?? indices[indices.length - 1];
  });
  element("crops").replaceChildren(...indices.map(makeCrop));
  draw();
}

function flip() {
  view.flipped = !view.flipped;
  element("flip").textContent = view.flipped ? "Flip to A" : "Flip to B";
  drawViewer();
}

function moveTo(x, y) {
  view.x = Math.round(Math.min(pictures.width - 1, Math.max(0, x)));
  view.y = Math.round(Math.min(pictures.height - 1, Math.max(0, y)));
  draw();
}

function setWipe(share) {
  element("wipe").value = Math.round(Math.min(100, Math.max(0, 100 * share)));
  drawViewer();
}

function zoomBy(step) {
  const list = element("zoom");
  list.selectedIndex = Math.min(list.options.length - 1, Math.max(0, list.selectedIndex + step));
  draw();
}

let drag = null;
viewer.addEventListener("pointerdown", (event) => {
  const share = event.offsetX / viewer.clientWidth;
  const wipes = chosen("mode") === "wipe" && Math.abs(share - element("wipe").value / 100) * viewer.clientWidth < 14;
  drag = { wipes, x: event.offsetX, y: event.offsetY, from: { x: view.x, y: view.y }, moved: false };
  viewer.setPointerCapture(event.pointerId);
});
viewer.addEventListener("pointermove", (event) => {
  if (!drag) return;
  if (drag.wipes) { setWipe(event.offsetX / viewer.clientWidth); return; }
  const [dx, dy] = [event.offsetX - drag.x, event.offsetY - drag.y];
  drag.moved ||= Math.hypot(dx, dy) > 4;
  if (!drag.moved) return;
  const perPixel = viewer.width / viewer.clientWidth / placement().scale;
  const sign = zoom() > 1 ? -1 : 1;  // pans what is magnified
  moveTo(drag.from.x + sign * dx * perPixel, drag.from.y + sign * dy * perPixel);
});
viewer.addEventListener("pointerup", (event) => {
  if (drag && !drag.moved && !drag.wipes) {
    const { scale, left, top } = placement();
    const ratio = viewer.width / viewer.clientWidth;
    moveTo(Math.floor((event.offsetX * ratio - left) / scale), Math.floor((event.offsetY * ratio - top) / scale));
  }
  drag = null;
});
viewer.addEventListener("pointercancel", () => { drag = null; });
viewer.addEventListener("keydown", (event) => {
  const far = event.shiftKey ? 8 : 1;
  const act = {
    ArrowLeft: () => moveTo(view.x - far, view.y), ArrowRight: () => moveTo(view.x + far, view.y),
    ArrowUp: () => moveTo(view.x, view.y - far), ArrowDown: () => moveTo(view.x, view.y + far),
    "+": () => zoomBy(1), "=": () => zoomBy(1), "-": () => zoomBy(-1), " ": () => { if (chosen("mode") === "flip") flip(); },
    "<": () => setWipe(element("wipe").value / 100 - 0.05), ">": () => setWipe(element("wipe").value / 100 + 0.05),
  }[event.key];
  if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  act();
});

onChoice("set", listImages);
onChoice("what", () => { element("scale").hidden = chosen("what") === "image"; draw(); });
onChoice("mode", () => {
  const wipes = chosen("mode") === "wipe";
  element("wipe-label").hidden = !wipes;
  element("flip").hidden = wipes;
  drawViewer();
});
for (const id of ["image-a", "image-b", "zoom", "crop"]) element(id).addEventListener("change", draw);
element("wipe").addEventListener("input", drawViewer);
element("flip").addEventListener("click", flip);
element("exposure").addEventListener("input", () => {
  element("exposure-value").textContent = `${element("exposure").value} stops`;
  draw();
});
new ResizeObserver(() => { resize(); drawViewer(); }).observe(viewer);

element("scale-low").textContent = `≤ ${number(leastError)}`;
element("scale-high").textContent = `≥ ${number(largestError)}`;
pictures.colors.forEach((color, i) => {
  const context = element("scale-bar").getContext("2d");
  context.fillStyle = `rgb(${color})`;
  context.fillRect(i, 0, 1, 1);
});
if (pictures.smaller_by > 1)
  element("smaller-note").textContent = `Shown ${pictures.smaller_by} times smaller than measured, each pixel a mean: noise looks weaker, and errors here are smaller than the measured ones.`;
resize();
listImages();
