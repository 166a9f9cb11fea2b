"""What SECURITY.md and docs/threats.md claim: each test that they name is one that ctest knows, each row names one; and no
program of ours looks for libraries in a relative folder. Called with the build folder."""

import json
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ("SECURITY.md", "docs/threats.md")
BUILD = pathlib.Path(sys.argv.pop())
# Where a test's name may stand outside of a table: behind these words.
IN_TEXT = re.compile(r"[Ss]hown by ((?:`[^`]+`(?:, | and )?)+)")


def claims_of(text):
    """(what is claimed, the names of the tests that show it) of each row of the tables with a column 'shown by'."""
    rows, column = [], None
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else None
        if cells is None:
            column = None
        elif "shown by" in cells:
            column = cells.index("shown by")
        elif column is not None and not set(line) <= set("|- "):
            rows.append((cells[0], re.findall(r"`([^`]+)`", cells[column]) if len(cells) > column else []))
    rows += [(found[0], re.findall(r"`([^`]+)`", found[1])) for found in IN_TEXT.finditer(text)]
    return rows


def known_tests():
    listed = subprocess.run(["ctest", "--test-dir", BUILD, "--show-only=json-v1"], capture_output=True, text=True, check=True)
    return {test["name"] for test in json.loads(listed.stdout)["tests"]}


def faults_of(text, known):
    """What is wrong with the claims of a page."""
    rows = claims_of(text)
    faults = [f"nothing shows {what!r}" for what, names in rows if not names]
    return faults + [f"{name} is no test" for _, names in rows for name in names if name not in known]


class Claims(unittest.TestCase):
    def test_a_row_without_a_test_and_a_name_of_none_are_found(self):
        page = "| what | shown by |\n|---|---|\n| a | `A.b`, `A.c` |\n| b | |\n\n| x | y |\n|---|---|\n| c | `no` |\n\nIt is shown by `Z.z`.\n"
        self.assertEqual(faults_of(page, {"A.b"}), ["nothing shows 'b'", "A.c is no test", "Z.z is no test"])
        self.assertEqual(faults_of("| a | `A.b` |\n", {"A.b"}), [])

    def test_each_named_test_is_there(self):
        known = known_tests()
        self.assertGreater(len(known), 1000, "this is no full build")
        for page in PAGES:
            text = (ROOT / page).read_text(encoding="utf-8")
            self.assertGreater(len(claims_of(text)), 15, f"{page} claims too little")
            self.assertEqual(faults_of(text, known), [], page)


class Libraries(unittest.TestCase):
    """Where the loader looks for the libraries of programs and libraries of ours."""

    def search_paths(self, file):
        said = subprocess.run(["readelf", "-d", file], capture_output=True, text=True, check=True).stdout
        return [entry for found in re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", said) for entry in found.split(":")]

    def test_no_search_path_is_relative(self):
        files = [BUILD / "bin/gdtslam", *BUILD.glob("lib/**/*.so")]
        self.assertGreater(len(files), 1)
        for file in files:
            for entry in self.search_paths(file):
                self.assertTrue(entry.startswith(("/", "$ORIGIN")), f"{file} looks for libraries in {entry!r}")

    def test_a_relative_search_path_is_seen(self):
        folder = BUILD / "tests/scripts/relative"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "a.c").write_text("int a(void) { return 1; }\n")
        subprocess.run(["cc", "-shared", "-fPIC", "-Wl,-rpath,.:", "-o", folder / "a.so", folder / "a.c"], check=True)
        self.assertEqual(self.search_paths(folder / "a.so"), [".", ""])


if __name__ == "__main__":
    unittest.main(verbosity=2)
