# The report of tools/lab/reproduce in a real browser: nothing is asked for elsewhere, nothing is cut, words are legible
# as they stand, light and dark. Needs GDTSLAM and Chromium; without Chromium it skips and says so.
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import chromium

SKIPPED = 77
# Height in pixels of the letters of every line of words in a drawing, and how far anything reaches beyond the page.
SMALLEST = """Math.min(...[...document.querySelectorAll('svg text')].filter(t => t.textContent.trim())
  .map(t => parseFloat(getComputedStyle(t).fontSize) * t.ownerSVGElement.getBoundingClientRect().width
       / (t.ownerSVGElement.viewBox.baseVal.width || t.ownerSVGElement.getBoundingClientRect().width)))"""
BEYOND = "document.documentElement.scrollWidth - document.documentElement.clientWidth"


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="gdtslam-report-")
        environment = {key: value for key, value in os.environ.items() if key != "GDTSLAM_DATA"}
        program = pathlib.Path(__file__).resolve().parents[3] / "tools/lab/reproduce/reproduce.py"
        subprocess.run([program, "--programs", pathlib.Path(os.environ["GDTSLAM"]).parent, "-o", cls.folder.name, "--only",
                        "fig3,fig11"], check=True, env=environment, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def open(self, width, scheme):
        browser = chromium.Browser(width=width, height=900)
        self.addCleanup(browser.close)
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        browser.call("Page.navigate", url=pathlib.Path(self.folder.name, "report.html").as_uri())
        browser.wait_for("document.readyState === 'complete' && document.querySelector('#times')")
        return browser

    def test_quiet_legible_and_whole(self):
        for width in (1300, 400):
            browser = self.open(width, "light")
            self.assertEqual(browser.errors, [])
            outside = [url for url in browser.requests if not url.startswith(("file://", "data:"))]
            self.assertEqual(outside, [])
            self.assertLessEqual(browser.value(BEYOND), 0, f"{width} pixels")
            broken = browser.value("[...document.images].filter(i => !i.complete || i.naturalWidth < 100).length")
            self.assertEqual(broken, 0)
            if width == 1300:
                self.assertGreaterEqual(browser.value(SMALLEST), 7.0)

    def test_pictures_come_soon(self):
        browser = self.open(1300, "light")
        self.assertLess(browser.value("document.querySelector('figure').getBoundingClientRect().top"), 1400)
        self.assertEqual(browser.value("document.querySelectorAll('#contents li a').length"),
                         browser.value("document.querySelectorAll('section').length"))
        browser.value("document.querySelector('#contents a[href=\"#verdicts\"]').click()")
        browser.wait_for("document.querySelector('#verdicts details').open")

    def test_light_and_dark(self):
        def brightness(browser):
            return browser.value("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number).reduce((a, b) => a + b)")
        light, dark = self.open(1300, "light"), self.open(1300, "dark")
        self.assertGreater(brightness(light), 600)
        self.assertLess(brightness(dark), 150)
        self.assertNotEqual(light.screenshot(), dark.screenshot())

    def test_commands_are_copied(self):
        browser = self.open(1300, "light")
        self.assertEqual(browser.value("document.querySelectorAll('.command').length"),
                         browser.value("document.querySelectorAll('.command > button').length"))
        self.assertEqual(browser.value("document.querySelector('#fig3 .command pre').textContent"),
                         "tools/lab/reproduce/reproduce.py -o report --only fig3")

    def test_every_link_leads_somewhere(self):
        browser = self.open(1300, "light")
        self.assertEqual(browser.value("[...document.links].filter(a => !document.querySelector(a.hash)).length"), 0)
        self.assertGreater(browser.value("document.links.length"), 5)


def main():
    if chromium.find_program() is None:
        reason = "chromium is not installed, so the report was NOT tested in a browser"
        print(f"SKIPPED: {reason}; GDTSLAM_REQUIRE_BROWSER=1 makes this a failure", flush=True)
        return 1 if os.environ.get("GDTSLAM_REQUIRE_BROWSER") == "1" else SKIPPED
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(ReportTest)
    return 0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
