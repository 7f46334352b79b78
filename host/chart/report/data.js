// SPDX-License-Identifier: MIT
// What the report shows, and how it is written.
"use strict";

const chart = JSON.parse(document.getElementById("chart").textContent);
const element = (id) => document.getElementById(id);

// An element of a kind, with properties and children.
function make(kind, properties = {}, ...children) {
  const out = Object.assign(document.createElement(kind), properties);
  out.append(...children);
  return out;
}

const methods = chart.samplers.map((sampler, i) => ({
  ...sampler,
  point: ["circle", "rect", "triangle", "rectRot", "star", "crossRot", "cross", "rectRounded"][i % 8],
  settings: chart.settings.filter((s) => s.sampler === sampler.name),
  shown: true,
}));
const methodNamed = (name) => methods.find((m) => m.name === name);
// A method's colour, lighter on dark ground.
function colorOf(method) {
  const dark = getComputedStyle(document.documentElement).colorScheme === "dark";
  const channels = [1, 3, 5].map((at) => parseInt(method.color.slice(at, at + 2), 16));
  return `rgb(${channels.map((c) => Math.round(dark ? c + 0.4 * (255 - c) : c)).join(", ")})`;
}
const cssColor = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Three digits, with an exponent where that is shorter.
function number(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(2).replace(/\.?0*e\+?/, "e");
  return String(Number(value.toPrecision(3)));
}
const range = (q) => `${number(q.median)} (${number(q.lower)} to ${number(q.upper)})`;
const percent = (share, digits = 1) => `${(100 * share).toFixed(digits)}%`;
const metricName = { relmse: "relMSE", mape: "MAPE" };
const drawn = (s) => s.light_samples * s.spp;
const inWords = (s) => methodNamed(s.sampler)?.all_lights
  ? `all ${s.light_samples} lights × ${s.spp} spp`
  : `${s.light_samples} light sample${s.light_samples === 1 ? "" : "s"} × ${s.spp} spp`;
const sameSamples = (a, b) => a.light_samples === b.light_samples && a.spp === b.spp;

// The value of the chosen one of a group of radio buttons; calls back on changes.
const chosen = (group) => document.querySelector(`input[name="${group}"]:checked`).value;
const onChoice = (group, act) => document.querySelectorAll(`input[name="${group}"]`)
  .forEach((input) => input.addEventListener("change", act));

// What has to be drawn anew when colours change.
const onTheme = [];
function setTheme(theme) {
  if (theme) document.documentElement.dataset.theme = theme;
  else delete document.documentElement.dataset.theme;
  onTheme.forEach((draw) => draw());
}
element("theme").addEventListener("change", (event) => setTheme(event.target.value));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => onTheme.forEach((draw) => draw()));

const scene = chart.scene.file.split("/").pop();
document.title = `${scene}: speed and accuracy`;
element("title").textContent = document.title;
element("facts").textContent = `${chart.width} × ${chart.height} pixels, ${chart.scene.lights} lights, ` +
  `${chart.scene.triangles} triangles, camera “${chart.scene.camera}”; ${chart.device} (${chart.platform}); ` +
  `loading ${number(chart.seconds.load)} s, BVH ${number(chart.seconds.bvh)} s, ` +
  (chart.whole ? "in all times below. Whole pixels: anti-aliased, with the emitters in view."
    : "apart from all times below. Pixels' centres; emitters are black.");
{
  const r = chart.reference;
  const own = r.relmse === 0 ? "it is exact" :
    `its own relMSE is ${number(r.relmse)}, the smallest that it judges ${number(r.judges_relmse)}`;
  element("reference").textContent = `Reference: sampler ${r.sampler}, ${r.spp} spp of ${r.light_samples} light samples; ${own}.`;
}
element("chart-command").textContent = chart.command;
element("image-commands").textContent = chart.images.map((i) => i.command).join("\n");
element("made").textContent = `Made by manylight ${chart.version}. Every figure is in chart.json. ` +
  `Plots by Chart.js ${Chart.version} (MIT licence).`;
