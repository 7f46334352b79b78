// SPDX-License-Identifier: MIT
// The plots: error against time and light samples, time per stage.
"use strict";

const metric = () => chosen("metric");
const sppSteps = [...new Set(chart.settings.map((s) => s.spp))].sort((a, b) => a - b);
const dashes = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

// A logarithmic axis with a label for each power of ten, or for more where there are few.
function logAxis(title) {
  return {
    type: "logarithmic",
    title: { display: true, text: title },
    ticks: {
      maxRotation: 0,
      autoSkip: false,
      callback(value) {
        const digits = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
        const few = Math.log10(this.max / this.min) < 1.7;
        const labelled = Math.abs(digits - 1) < 1e-6 || (few && [2, 5].some((d) => Math.abs(digits - d) < 1e-6));
        return labelled ? number(value) : "";
      },
    },
  };
}

// What has no error cannot be on a logarithmic axis: it is drawn at this value, at the lower edge.
function errorFloor() {
  const errors = chart.settings.map((s) => s[metric()].median).filter((e) => e > 0);
  return errors.length ? Math.min(...errors) / 3 : 1e-6;
}

const points = {
  time: (s) => ({ x: s.seconds.median, bar: s.seconds }),
  samples: (s) => ({ x: drawn(s), bar: null }),
};

// One line for each method and number of pixel samples.
function errorData(kind) {
  const floor = errorFloor();
  const datasets = [];
  for (const method of methods)
    for (const spp of sppSteps) {
      const settings = method.settings.filter((s) => s.spp === spp).sort((a, b) => drawn(a) - drawn(b));
      if (!settings.length) continue;
      const color = colorOf(method);
      const hollow = settings.map((s) => s.limited_by_reference || s[metric()].median === 0);
      datasets.push({
        method, settings,
        data: settings.map((s) => ({ x: points[kind](s).x, y: s[metric()].median || floor })),
        bars: settings.map((s) => ({ x: points[kind](s).bar, y: s[metric()].median ? s[metric()] : null })),
        hidden: !method.shown,
        borderColor: color, pointBorderColor: color, borderWidth: 1.8,
        borderDash: dashes[sppSteps.indexOf(spp) % dashes.length],
        pointBackgroundColor: hollow.map((h) => (h ? cssColor("--back") : color)),
        pointStyle: method.point, pointRadius: 4.5, pointHoverRadius: 7, pointBorderWidth: 1.8,
      });
    }
  return { datasets };
}

function pointLines(s) {
  const lines = [`${metricName[metric()]} ${range(s[metric()])}`, `${range(s.seconds)} s`, `${s.runs} runs; median (quartiles)`];
  if (s[metric()].median === 0) lines.push("without error: drawn at the lower edge");
  else if (s.limited_by_reference) lines.push("the reference's own error is not 100 times smaller");
  return lines;
}

// Quartiles as thin bars behind the points.
const quartileBars = {
  id: "quartiles",
  beforeDatasetsDraw({ ctx, scales: { x, y }, data, isDatasetVisible }, _args, _options) {
    ctx.save();
    ctx.lineWidth = 1;
    data.datasets.forEach((set, i) => {
      if (!this.visible(i)) return;
      ctx.strokeStyle = set.borderColor;
      set.bars.forEach((bar, k) => {
        const [px, py] = [x.getPixelForValue(set.data[k].x), y.getPixelForValue(set.data[k].y)];
        ctx.beginPath();
        if (bar.x) { ctx.moveTo(x.getPixelForValue(bar.x.lower), py); ctx.lineTo(x.getPixelForValue(bar.x.upper), py); }
        if (bar.y) { ctx.moveTo(px, y.getPixelForValue(bar.y.lower || set.data[k].y)); ctx.lineTo(px, y.getPixelForValue(bar.y.upper)); }
        ctx.stroke();
      });
    });
    ctx.restore();
  },
  visible: (i) => errorPlots.time.isDatasetVisible(i),
};

function applyTheme(plot) {
  for (const axis of Object.values(plot.options.scales)) {
    axis.grid = { color: cssColor("--grid"), borderColor: cssColor("--line") };
    axis.ticks.color = axis.title.color = cssColor("--text");
  }
}

function errorPlot(id, kind, title) {
  const plot = new Chart(element(id), {
    type: "line",
    data: { datasets: [] },
    options: {
      animation: false, maintainAspectRatio: false, parsing: false,
      interaction: { mode: "nearest", intersect: false },
      scales: { x: logAxis(title), y: logAxis("relMSE") },
      plugins: {
        legend: { display: false },
        tooltip: {
          displayColors: false,
          filter: (_item, index) => index === 0,
          callbacks: {
            title: ([item]) => item && `${item.dataset.method.name}, ${inWords(item.dataset.settings[item.dataIndex])}`,
            label: (item) => pointLines(item.dataset.settings[item.dataIndex]),
          },
        },
      },
    },
    plugins: [quartileBars],
  });
  walkByKeys(plot);
  return plot;
}

// Arrow keys go from point to point, as a pointer would.
function walkByKeys(plot) {
  let at = -1;
  plot.canvas.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const all = plot.data.datasets.flatMap((set, datasetIndex) =>
      plot.isDatasetVisible(datasetIndex) ? set.data.map((_p, index) => ({ datasetIndex, index })) : []);
    if (!all.length) return;
    at = (at + step + all.length) % all.length;
    if (step < 0 && at < 0) at = all.length - 1;
    const active = all[at];
    const { x, y } = plot.getDatasetMeta(active.datasetIndex).data[active.index];
    plot.setActiveElements([active]);
    plot.tooltip.setActiveElements([active], { x, y });
    plot.update("none");
    const set = plot.data.datasets[active.datasetIndex];
    const setting = set.settings[active.index];
    element("plot-value").textContent = `${set.method.name}, ${inWords(setting)}: ${pointLines(setting).join("; ")}`;
  });
}

const errorPlots = {};
errorPlots.time = errorPlot("time-plot", "time", "seconds");
errorPlots.samples = errorPlot("samples-plot", "samples", "light samples per pixel");

// The axes' ends: of all methods, so that they stay where they are when some are hidden.
function setEnds(axis, values) {
  const [least, most] = [Math.min(...values), Math.max(...values)];
  Object.assign(axis, { min: least / 1.3, max: most * 1.3 });
}

function drawErrors() {
  for (const [kind, plot] of Object.entries(errorPlots)) {
    applyTheme(plot);
    plot.options.scales.y.title.text = metricName[metric()];
    plot.data = errorData(kind);
    for (const axis of ["x", "y"])
      setEnds(plot.options.scales[axis], plot.data.datasets.flatMap((set) => set.data.map((point) => point[axis])));
    plot.setActiveElements([]);
    plot.update("none");
    const shown = methods.filter((m) => m.shown && m.settings.length).map((m) => m.name).join(", ");
    plot.canvas.setAttribute("aria-label", `${metricName[metric()]} against ` +
      `${kind === "time" ? "seconds" : "light samples per pixel"}, logarithmic, of ${shown || "no method"}. Arrow keys read the points.`);
  }
}

for (const method of methods) {
  const box = make("input", { type: "checkbox", checked: true, name: "method", value: method.name, disabled: !method.settings.length });
  box.addEventListener("change", () => { method.shown = box.checked; drawErrors(); });
  const swatch = make("span", { className: "swatch" });
  const paint = () => { swatch.style.background = colorOf(method); };
  paint();
  onTheme.push(paint);
  const label = make("label", { title: method.summary }, box, swatch, method.name + (method.biased ? " (biased)" : ""));
  element("methods").append(label);
}
element("plot-help").textContent = `Medians of ${chart.seeds} seeds; thin bars are quartiles. Lines: ` +
  sppSteps.map((spp, i) => `${["solid", "dashed", "dotted", "dash-dotted"][i % 4]} ${spp} spp`).join(", ") +
  ". Hollow points have no error, at the lower edge, or one that the reference cannot tell from its own.";
onChoice("metric", drawErrors);
onTheme.push(drawErrors);
drawErrors();

// Time per stage.

const hostWork = "host: light tree, waiting";
const stageNames = [...new Set(chart.settings.flatMap((s) => Object.keys(s.stage_seconds)))].sort();
const stageSettings = chart.settings.filter((s) => s.sampler === chart.baseline);

// The setting of a method that has as many samples, or else its cheapest one.
const settingOf = (method, at) => method.settings.find((s) => sameSamples(s, at)) ?? (method.all_lights ? method.settings[0] : undefined);

function stageRows() {
  const at = stageSettings[element("stages-setting").value];
  const apart = element("apart").checked;
  return methods.map((method) => ({ method, setting: settingOf(method, at) })).filter((r) => r.setting).map(({ method, setting }) => {
    const seconds = { ...setting.stage_seconds };
    const kernels = Object.values(seconds).reduce((a, b) => a + b, 0);
    seconds[hostWork] = Math.max(0, setting.seconds.median - kernels);
    if (apart) { seconds.BVH = chart.seconds.bvh; seconds.compiling = method.compile_seconds; }
    return { name: method.name, total: setting.seconds.median, seconds };
  });
}

const stagesPlot = new Chart(element("stages-plot"), {
  type: "bar",
  data: { labels: [], datasets: [] },
  options: {
    indexAxis: "y", animation: false, maintainAspectRatio: false,
    interaction: { mode: "nearest", intersect: true },
    scales: {
      x: { stacked: true, title: { display: true, text: "seconds" }, ticks: {} },
      y: { stacked: true, title: { display: false }, ticks: { autoSkip: false } },
    },
    plugins: {
      legend: { position: "bottom", labels: { boxWidth: 14 } },
      tooltip: { callbacks: { label: (item) => `${item.dataset.label}: ${number(item.parsed.x)} s` } },
    },
  },
});

function drawStages() {
  const rows = stageRows();
  const used = [...stageNames, hostWork, "BVH", "compiling"].filter((name) => rows.some((r) => r.seconds[name] > 0));
  applyTheme(stagesPlot);
  stagesPlot.options.plugins.legend.labels.color = cssColor("--text");
  stagesPlot.data = {
    labels: rows.map((r) => r.name),
    datasets: used.map((name) => ({
      label: name,
      data: rows.map((r) => r.seconds[name] ?? 0),
      backgroundColor: name === hostWork ? cssColor("--soft") : `hsl(${(([...stageNames, "BVH", "compiling"].indexOf(name)) * 137.5) % 360} 60% 55%)`,
    })),
  };
  stagesPlot.update("none");
  element("stages-plot").setAttribute("aria-label", "Seconds per stage: " + rows.map((r) => `${r.name} ${number(r.total)}`).join(", "));
  element("stages-table").replaceChildren(
    make("thead", {}, make("tr", {}, ...["sampler", ...used, "render + prepare"].map((h) => make("th", { scope: "col", textContent: h })))),
    make("tbody", {}, ...rows.map((r) => make("tr", {}, make("th", { scope: "row", textContent: r.name }),
      ...used.map((name) => make("td", { textContent: number(r.seconds[name] ?? 0) })), make("td", { textContent: number(r.total) })))));
}

stageSettings.forEach((s, i) => element("stages-setting").append(
  make("option", { value: i, textContent: inWords(s), selected: sameSamples(s, chart.start) })));
element("stages-setting").addEventListener("change", drawStages);
element("apart").addEventListener("change", drawStages);
onTheme.push(drawStages);
drawStages();
