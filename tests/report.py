# SPDX-License-Identifier: MIT
"""Clicks through the report of a chart in headless Chromium, and looks for errors in its console.

usage: report.py MANYLIGHT SCENES CHROMEDRIVER
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
SCENES = pathlib.Path(sys.argv.pop(1)).resolve()
DRIVER = sys.argv.pop(1)
SAMPLERS = [row["name"] for row in json.loads(
    subprocess.run([PROGRAM, "samplers", "--json"], check=True, capture_output=True).stdout)]


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name) / "chart"
        subprocess.run([PROGRAM, "chart", SCENES / "glossy.glb", "--height", "48", "--seeds", "2",
                        "--light-samples", "1,4,16", "--spp", "1,2", "--cache", folder.name, "-q",
                        "-o", cls.folder], check=True, timeout=300)
        cls.chart = json.loads((cls.folder / "chart.json").read_text())
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
                         "--window-size=1280,900", f"--user-data-dir={folder.name}/profile"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        cls.driver = webdriver.Chrome(options=options, service=Service(DRIVER))
        cls.addClassCleanup(cls.driver.quit)
        cls.driver.set_script_timeout(60)

    def setUp(self):
        self.driver.get((self.folder / "report.html").as_uri())
        self.wait_for("layers.size > 0 && element('viewer-value').textContent !== ''")

    def tearDown(self):
        self.assertEqual(self.console(), [])

    def console(self):
        return [entry["message"] for entry in self.driver.get_log("browser")
                if entry["level"] in ("SEVERE", "WARNING")]

    def js(self, text, *arguments):
        return self.driver.execute_script(f"return {text}", *arguments)

    def wait_for(self, condition):
        end = time.monotonic() + 60
        while not self.js(condition):
            self.assertLess(time.monotonic(), end, condition)
            time.sleep(0.02)

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def choose(self, name, value):
        self.find(f'input[name="{name}"][value="{value}"]').click()

    def select(self, name, value):
        self.driver.execute_script(
            "const list = element(arguments[0]); list.value = arguments[1];"
            "list.dispatchEvent(new Event('change', {bubbles: true}))", name, str(value))

    def slide(self, name, value):
        self.driver.execute_script(
            "const slider = element(arguments[0]); slider.value = arguments[1];"
            "slider.dispatchEvent(new Event('input', {bubbles: true}))", name, value)

    def press(self, name, *keys):
        self.find(f"#{name}").send_keys(*keys)

    def changes(self, name, act):
        """Expects the drawing of a canvas to become another one."""
        before = self.js(f"element('{name}').toDataURL()")
        act()
        end = time.monotonic() + 60
        while self.js(f"element('{name}').toDataURL()") == before:
            self.assertLess(time.monotonic(), end, f"{name} stays as it was")
            time.sleep(0.02)

    def cells(self, table):
        return self.js("[...document.querySelectorAll(`#${arguments[0]} tbody tr`)].map("
                       "row => [...row.children].map(cell => cell.textContent))", table)

    def setting(self, sampler, samples, spp):
        return next(s for s in self.chart["settings"] if
                    (s["sampler"], s["light_samples"], s["spp"]) == (sampler, samples, spp))

    # What is there.

    def test_the_console_is_heard(self):
        self.driver.execute_script("console.error('heard')")
        self.assertIn("heard", " ".join(self.console()))

    def test_nothing_comes_from_elsewhere(self):
        entries = self.js("performance.getEntriesByType('resource').map(e => e.name)")
        self.assertEqual([e for e in entries if not e.startswith("data:")], [])
        self.assertLess((self.folder / "report.html").stat().st_size, 15e6)
        self.driver.execute_script("fetch('http://127.0.0.1:9/').catch(() => {})")
        self.assertIn("Content Security Policy", " ".join(self.console()))

    def test_tables_say_what_chart_json_says(self):
        names = self.js("methods.map(m => m.name)")
        self.assertEqual(names, SAMPLERS)
        rows = self.cells("settings-table")
        self.assertEqual(len(rows), len(self.chart["settings"]))
        for row, setting in zip(rows, self.chart["settings"]):
            self.assertEqual(row[0], setting["sampler"])
            self.assertAlmostEqual(float(row[5].split()[0]), setting["relmse"]["median"],
                                   delta=0.006 * setting["relmse"]["median"])
        for metric in ("relmse", "mape"):
            self.choose("metric", metric)
            self.assertEqual(self.js("document.querySelector('#ratios-table th:nth-child(2)')"
                                     ".textContent").lower(), metric)
            for at, base in enumerate(s for s in self.chart["settings"]
                                      if s["sampler"] == "adaptive"):
                self.select("baseline-setting", at)
                rows = {row[0]: row for row in self.cells("ratios-table")}
                self.assertEqual(sorted(rows), sorted(SAMPLERS))
                for ratio in self.chart["ratios"]:
                    if (ratio["light_samples"], ratio["spp"]) != (base["light_samples"],
                                                                  base["spp"]):
                        continue
                    for column, kind in ((3, "equal_samples"), (4, "equal_time")):
                        found = rows[ratio["sampler"]][column]
                        value = ratio[kind][metric]
                        if value is None:
                            self.assertEqual(found, "–")
                        else:
                            self.assertAlmostEqual(float(found.split()[0]) / value["ratio"], 1,
                                                   delta=0.006)

    def test_images_have_the_errors_that_were_measured(self):
        for at, image in enumerate(self.chart["images"]):
            found = self.driver.execute_async_script(
                "const done = arguments[1];"
                "Promise.all([pixelsOf(arguments[0] + 1), pixelsOf(0)]).then(([p, r]) =>"
                "done(errorsOf(p, r).reduce((a, b) => a + b, 0) / pixelCount))", at)
            self.assertAlmostEqual(found, image["relmse"], delta=0.01 * image["relmse"] + 2e-5)
        for kind in ("equal_samples", "equal_time"):
            shown = [i["sampler"] for i in self.chart["images"] if i[kind]]
            self.assertEqual(shown, SAMPLERS)

    def test_text_alternatives(self):
        nameless = self.js(
            "[...document.querySelectorAll('input, select, button')].filter(c =>"
            "!(c.labels?.length && c.labels[0].textContent.trim()) && !c.textContent.trim())"
            ".map(c => c.outerHTML)")
        self.assertEqual(nameless, [])
        for name in ("time-plot", "samples-plot", "stages-plot", "viewer"):
            self.assertGreater(len(self.js(f"element('{name}').getAttribute('aria-label')")), 20)

    # Every control.

    def test_plots(self):
        for plot in ("time", "samples"):
            for name in SAMPLERS:
                visible = (f"errorPlots.{plot}.data.datasets.filter((d, i) => d.method.name ==="
                           f"'{name}' && errorPlots.{plot}.isDatasetVisible(i)).length")
                self.assertGreater(self.js(visible), 0)
                self.changes(f"{plot}-plot", lambda n=name: self.choose("method", n))
                self.assertEqual(self.js(visible), 0)
                self.choose("method", name)
                self.assertGreater(self.js(visible), 0)
            for metric, title in (("mape", "MAPE"), ("relmse", "relMSE")):
                self.changes(f"{plot}-plot", lambda m=metric: self.choose("metric", m))
                self.assertEqual(self.js(f"errorPlots.{plot}.options.scales.y.title.text"), title)
        point = self.js("errorPlots.samples.data.datasets.find(d => d.method.name === 'adaptive')"
                        ".data")
        self.assertEqual([p["x"] for p in point], [1, 4, 16])
        self.assertEqual([p["y"] for p in point], [
            self.setting("adaptive", n, 1)["relmse"]["median"] for n in (1, 4, 16)])

    def test_plots_by_keyboard_and_pointer(self):
        seen = set()
        for _ in range(len(self.chart["settings"])):
            self.press("time-plot", Keys.ARROW_RIGHT)
            seen.add(self.js("element('plot-value').textContent"))
        self.assertEqual(len(seen), len(self.chart["settings"]))
        for words in ("adaptive, 4 light samples × 2 spp: relMSE", "quartiles", "without error"):
            self.assertIn(words, " ".join(seen))
        self.press("samples-plot", Keys.ARROW_LEFT)
        self.assertIn(SAMPLERS[-1] + ", ", self.js("element('plot-value').textContent"))
        webdriver.ActionChains(self.driver).move_to_element(self.find("#samples-plot")).perform()
        self.wait_for("errorPlots.samples.tooltip.opacity > 0")
        self.assertIn("s", self.js("errorPlots.samples.tooltip.title[0]"))

    def test_stages(self):
        for at in range(6):
            self.select("stages-setting", at)
            self.assertEqual([row[0] for row in self.cells("stages-table")], SAMPLERS)
        self.select("stages-setting", 0)
        before = self.js("stagesPlot.data.datasets.map(d => d.label)")
        self.changes("stages-plot", lambda: self.find("#apart").click())
        after = self.js("stagesPlot.data.datasets.map(d => d.label)")
        self.assertEqual(set(after) - set(before), {"BVH", "compiling"})
        rows = {row[0]: row for row in self.cells("stages-table")}
        setting = self.setting("power", 1, 1)
        self.assertAlmostEqual(float(rows["power"][-1]), setting["seconds"]["median"],
                               delta=0.006 * setting["seconds"]["median"])

    def test_wipe_and_flip(self):
        self.select("image-a", 0)
        uniform = 1 + next(i for i, image in enumerate(self.chart["images"])
                           if image["sampler"] == "uniform" and image["equal_samples"])
        self.changes("viewer", lambda: self.select("image-b", uniform))
        for position in (0, 100, 30):
            self.changes("viewer", lambda p=position: self.slide("wipe", p))
        for key in (">", "<"):
            self.changes("viewer", lambda k=key: self.press("viewer", k))
        width = self.js("viewer.clientWidth")
        drag = webdriver.ActionChains(self.driver)
        drag.move_to_element_with_offset(self.find("#viewer"), int(-0.2 * width), 0)
        drag.click_and_hold().move_by_offset(int(0.3 * width), 5).release().perform()
        self.assertAlmostEqual(self.js("Number(element('wipe').value)"), 60, delta=3)
        self.changes("viewer", lambda: self.choose("mode", "flip"))
        self.assertFalse(self.find("#wipe").is_displayed())
        label = "viewer.getAttribute('aria-label')"
        self.wait_for(f"{label} === 'reference'")
        self.changes("viewer", lambda: self.find("#flip").click())
        self.assertEqual(self.js(label), "uniform")
        self.assertEqual(self.find("#flip").text, "Flip to A")
        self.changes("viewer", lambda: self.press("viewer", " "))
        self.assertEqual(self.js(label), "reference")
        self.changes("viewer", lambda: self.choose("mode", "wipe"))

    def test_views(self):
        for value in (-3, 2.5):
            self.changes("viewer", lambda v=value: self.slide("exposure", v))
        self.assertEqual(self.find("#exposure-value").text, "2.5 stops")
        self.assertFalse(self.find("#scale").is_displayed())
        self.changes("viewer", lambda: self.choose("what", "error"))
        self.assertTrue(self.find("#scale").is_displayed())
        self.changes("viewer", lambda: self.choose("what", "image"))
        for zoom in (2, 4, 8, 16, 1):
            self.changes("viewer", lambda z=zoom: self.select("zoom", z))
        self.changes("viewer", lambda: self.press("viewer", "+"))
        self.assertEqual(self.js("zoom()"), 2)
        self.changes("viewer", lambda: self.press("viewer", "-"))
        for size in (16, 64, 32):
            self.changes("viewer", lambda s=size: self.select("crop", s))

    def test_crops(self):
        self.select("crop", 16)
        crop = "document.querySelectorAll('#crops canvas')[2].toDataURL()"
        value = "element('viewer-value').textContent"
        for keys in (Keys.ARROW_LEFT, Keys.ARROW_UP, Keys.SHIFT + Keys.ARROW_RIGHT,
                     Keys.SHIFT + Keys.ARROW_DOWN):
            before = self.js(f"[{crop}, {value}]")
            self.press("viewer", keys)
            self.wait_for(f"{crop} !== {json.dumps(before[0])} && {value} !== "
                          f"{json.dumps(before[1])}")
        before = self.js(value)
        webdriver.ActionChains(self.driver).move_to_element_with_offset(
            self.find("#viewer"), -300, 60).click().perform()
        self.wait_for(f"{value} !== {json.dumps(before)}")
        self.assertLess(self.js("view.x"), 30)
        for kind in ("equal_time", "equal_samples"):
            self.choose("set", kind)
            buttons = self.driver.find_elements(By.CSS_SELECTOR, "#crops button")
            self.assertEqual(len(buttons), len(SAMPLERS) + 1)
            for button in buttons:
                button.click()
                self.wait_for(f"element('image-b').value === '{button.get_attribute('value')}' && "
                              "document.querySelector('#crops [aria-pressed=true]')?.value === "
                              "element('image-b').value")

    def test_themes_and_phones(self):
        back = "getComputedStyle(document.body).backgroundColor"
        self.assertEqual(self.js(back), "rgb(255, 255, 255)")
        self.changes("time-plot", lambda: self.select("theme", "dark"))
        dark = self.js(back)
        self.assertEqual(dark, "rgb(21, 23, 26)")
        self.changes("time-plot", lambda: self.select("theme", "light"))
        swatches = "[...document.querySelectorAll('.swatch')].map(s => s.style.background)"
        light = self.js(swatches)
        self.assertEqual(len(set(light)), len(SAMPLERS))
        self.assertIn("rgb(214, 39, 40)", light[SAMPLERS.index("adaptive")])  # as its row says
        self.select("theme", "dark")
        self.assertEqual(len(set(self.js(swatches)) - set(light)), len(SAMPLERS))
        self.select("theme", "")
        emulate = self.driver.execute_cdp_cmd
        feature = {"name": "prefers-color-scheme", "value": "dark"}
        self.changes("time-plot", lambda: emulate("Emulation.setEmulatedMedia",
                                                  {"features": [feature]}))
        self.assertEqual(self.js(back), dark)
        emulate("Emulation.setDeviceMetricsOverride",
                {"width": 360, "height": 700, "deviceScaleFactor": 2, "mobile": True})
        self.wait_for("viewer.clientWidth < 360")
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 360)
        emulate("Emulation.clearDeviceMetricsOverride", {})
        emulate("Emulation.setEmulatedMedia", {"features": []})

    def test_the_tabulator_reaches_every_control(self):
        wanted = self.js("[...document.querySelectorAll('input:not([type=radio]), select, button,"
                         "canvas[tabindex], summary, pre')].filter(c => c.checkVisibility()"
                         "&& !c.disabled).length")
        reached = set()
        for _ in range(wanted + 20):
            webdriver.ActionChains(self.driver).send_keys(Keys.TAB).perform()
            active = self.driver.switch_to.active_element
            if active.get_attribute("type") != "radio" and active.tag_name != "body":
                reached.add(active.id)
        self.assertGreaterEqual(len(reached), wanted)


if __name__ == "__main__":
    unittest.main()
