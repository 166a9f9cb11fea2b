"""Tests of the navigation of the site; and that the page "coming from" names options that
there are. The site itself is built by tools/test.sh."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "site"))
import navigation  # noqa: E402


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
