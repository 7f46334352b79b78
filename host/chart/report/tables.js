// SPDX-License-Identifier: MIT
// The tables of settings and of ratios.
"use strict";

function fillTable(id, heads, rows) {
  element(id).replaceChildren(
    make("thead", {}, make("tr", {}, ...heads.map((h) => make("th", { scope: "col", textContent: h })))),
    make("tbody", {}, ...rows.map(([first, ...cells]) => make("tr", {}, make("th", { scope: "row", textContent: first }),
      ...cells.map((cell) => {
        const [value, aside] = [].concat(cell);
        return make("td", {}, value, ...(aside ? [" ", make("small", { textContent: aside })] : []));
      })))));
}

const quartileCell = (q) => [number(q.median), `${number(q.lower)} to ${number(q.upper)}`];
const zCell = (s) => (s.z === null ? "–" : [s.z.toFixed(1), Math.abs(s.z) > s.z_limit ? "beyond chance" : ""]);

fillTable("settings-table",
  ["sampler", "light samples", "spp", "runs", "seconds", "relMSE", "MAPE", "bias", "z", "in worst 1%", "in worst 0.1%"],
  chart.settings.map((s) => [s.sampler, String(s.light_samples), String(s.spp), String(s.runs), quartileCell(s.seconds),
    quartileCell(s.relmse), quartileCell(s.mape), percent(s.bias, 3), zCell(s),
    percent(s.worst_1_percent.median), percent(s["worst_0.1_percent"].median)]));

// A method of which nothing was measured, or some settings of one, with the reason.
for (const method of methods) {
  const left = chart.left_out.filter((l) => l.sampler === method.name);
  if (!left.length) continue;
  const which = method.settings.length ? left.map(inWords).join(", ") : "all settings";
  element("left-out").append(make("li", { textContent: `${method.name}: ${which} left out: ${left[0].reason}.` }));
}

const baselineSettings = chart.settings.filter((s) => s.sampler === chart.baseline);

function ratioCell(ratio) {
  if (!ratio) return "–";
  return ratio.lower === null ? number(ratio.ratio) : [number(ratio.ratio), `${number(ratio.lower)} to ${number(ratio.upper)}`];
}

function drawRatios() {
  const base = baselineSettings[element("baseline-setting").value];
  const key = metric();
  const rows = [[base.sampler, [number(base[key].median)], [number(base.seconds.median)], "1", "1", percent(base.bias, 3), zCell(base),
    percent(base.worst_1_percent.median), percent(base["worst_0.1_percent"].median)]];
  for (const method of methods) {
    if (method.name === chart.baseline) continue;
    const ratio = chart.ratios.find((r) => r.sampler === method.name && sameSamples(r, base));
    const same = method.settings.find((s) => sameSamples(s, base)) ?? (method.all_lights ? method.settings[0] : undefined);
    const alone = same ? [[number(same[key].median)], [number(same.seconds.median)]] : ["–", "–"];
    rows.push([method.name, ...alone, ratioCell(ratio?.equal_samples[key]), ratioCell(ratio?.equal_time[key]),
      ...(same ? [percent(same.bias, 3), zCell(same), percent(same.worst_1_percent.median), percent(same["worst_0.1_percent"].median)]
        : ["–", "–", "–", "–"])]);
  }
  fillTable("ratios-table", ["sampler", metricName[key], "seconds", "ratio at equal samples", "ratio at equal time",
    "bias", "z", "in worst 1%", "in worst 0.1%"], rows);
}

element("baseline-label").textContent = `${metricName.relmse} or MAPE over that of ${chart.baseline} with`;
element("ratios-note").textContent = `Above 1: more error than ${chart.baseline}. Ratios are made seed by seed: their geometric mean, and ` +
  "Student's interval of 95%. At equal time, a method's error is read between its own settings (log-log); – where they do not " +
  "reach that time, where there is no error, or no such setting. Bias: of the mean luminance; z: over its standard error, the reference's " +
  "included; beyond chance: of unbiased samplers, one of 20 is. In worst 1%: share of the relMSE in the worst 1% of pixels.";
baselineSettings.forEach((s, i) => element("baseline-setting").append(
  make("option", { value: i, textContent: inWords(s), selected: sameSamples(s, chart.start) })));
element("baseline-setting").addEventListener("change", drawRatios);
onChoice("metric", drawRatios);
drawRatios();
