"""Tests of what checks the site (tools/site/check_site.py) and of its navigation, on sites of a few lines; and that the page
"coming from" names options that there are. The site itself is built and checked by tools/test.sh."""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "site"))
import navigation  # noqa: E402

FIRST = '<div class="sidebar-tree"><div><a href="#">first</a></div><a href="howto/a.html">a</a></div>{}'


class CheckSite(unittest.TestCase):
    """A site of two pages, and one fault at a time."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        for path in ("site/howto", "site/_static", "root/docs/howto"):
            (self.work / path).mkdir(parents=True)
        for path in ("README.md", "howto/a.md"):
            (self.work / "root/docs" / path).write_text("# Page\n")
        self.page("index.html", FIRST.format('<img src="_static/p.png"><a href="howto/a.html#part">'))
        self.page("howto/a.html", '<h2 id="part">Part</h2><a href="../index.html"><a href="https://example.org/x">')
        (self.work / "site/_static/p.png").touch()

    def page(self, name, body):
        (self.work / "site" / name).write_text(body)

    def check(self):
        done = subprocess.run([sys.executable, str(ROOT / "tools/site/check_site.py"), self.work / "site", self.work / "root"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1 if done.stderr else 0, done.stderr)
        return done.stdout, done.stderr.splitlines()

    def test_a_whole_site(self):
        printed, faults = self.check()
        self.assertEqual(faults, [])
        self.assertIn("external, not fetched: https://example.org/x", printed)
        self.assertIn("2 pages, 5 links inside, 1 to the web, 0 faults", printed)

    def test_a_link_to_nothing(self):
        self.page("howto/a.html", '<h2 id="part"><a href="b.html"><a href="../../outside.html"><a href="/index.html">')
        _, faults = self.check()
        self.assertEqual(faults, ["check_site: howto/a.html: b.html is not in the site",
                                  "check_site: howto/a.html: ../../outside.html is not in the site",
                                  "check_site: howto/a.html: /index.html begins at the root of a server"])

    def test_an_anchor_that_is_not_there(self):
        self.page("howto/a.html", '<h2 id="other">')
        self.assertEqual(self.check()[1], ["check_site: index.html: howto/a.html#part: no such anchor"])

    def test_a_picture_that_is_not_there(self):
        (self.work / "site/_static/p.png").unlink()
        self.assertEqual(self.check()[1], ["check_site: index.html: _static/p.png is not in the site"])

    def test_what_is_loaded_from_outside(self):
        self.page("howto/a.html", '<h2 id="part"><script src="https://cdn.example/x.js"></script>'
                                  '<link rel="stylesheet" href="https://cdn.example/x.css">')
        (self.work / "site/_static/x.css").write_text('@import url(/javascript/n.css); p { background: url("no.png") }')
        faults = self.check()[1]
        self.assertEqual(len(faults), 4, faults)

    def test_a_page_of_docs_without_a_page(self):
        (self.work / "root/docs/b.md").write_text("# B\n")
        self.assertEqual(self.check()[1], ["check_site: docs/b.md: no page in the site"])

    def test_a_page_that_the_navigation_does_not_reach(self):
        (self.work / "root/docs/b.md").write_text("# B\n")
        self.page("b.html", "")
        self.page("howto/a.html", '<h2 id="part"><a href="../b.html">')  # a link in a text is not enough
        self.assertEqual(self.check()[1],
                         ["check_site: docs/b.md: not in the navigation; docs/README.md lists the pages"])


class Navigation(unittest.TestCase):
    def test_parts_are_headings_and_entries_links_to_pages(self):
        text = "# T\n[no](no.md)\n\n## One\n\n* [A\n  b](a.md), [web](https://x.org/y.md) [a again](a.md)\n## None\n\nx\n\n## Two\n[c](../C.md)\n"
        parts = list(navigation.parts_of(text))
        self.assertEqual(parts, [("One", [("A b", "a.md")]), ("Two", [("c", "../C.md")])])

    def test_each_page_of_docs_is_listed(self):
        listed = {path for _, entries in navigation.parts_of((ROOT / "docs/README.md").read_text(encoding="utf-8"))
                  for _, path in entries}
        pages = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")} - {"README.md"}
        self.assertEqual(pages - listed, set(), "docs/README.md lists the pages")


class ComingFrom(unittest.TestCase):
    @staticmethod
    def pages_of_options():
        return "".join((ROOT / f"docs/reference/{name}.md").read_text(encoding="utf-8") for name in ("options", "advanced"))

    def test_our_options_exist(self):
        options = set(re.findall(r"^\| `([\w.]+)` \|", self.pages_of_options(), re.MULTILINE))
        flags = set(re.findall(r"--[a-z][a-z-]+", (ROOT / "docs/reference/commands.md").read_text(encoding="utf-8")))
        rows = [line.split("|")[4] for line in (ROOT / "docs/howto/coming-from.md").read_text(encoding="utf-8").split("\n")
                if line.startswith("| ") and line.count("|") == 5]
        self.assertGreater(len(rows), 40)
        named = {name for row in rows for name in re.findall(r"`([\w.]+)`", row) if "." in name}
        self.assertGreater(len(named), 20)
        self.assertEqual(named - options, set())
        self.assertEqual({name for row in rows for name in re.findall(r"--[a-z][a-z-]+", row)} - flags, set())

    def test_our_defaults_are_those_of_the_reference(self):
        defaults = dict(re.findall(r"^\| `([\w.]+)` \| ([\d.]+)[^|]*\|",
                                   self.pages_of_options(), re.MULTILINE))
        text = (ROOT / "docs/howto/coming-from.md").read_text(encoding="utf-8")
        said = re.findall(r"`(\w+\.\w+)`, ([\d.]*\d)", text)
        self.assertGreater(len(said), 15)
        for name, value in said:
            if name in defaults:
                self.assertAlmostEqual(float(value), float(defaults[name]), delta=0.0005, msg=name)


if __name__ == "__main__":
    unittest.main()
