"""Tests that the sources of a library can be compiled as one, whichever of them a build has."""

import collections
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/scripts"))
import lint  # noqa: E402  (its folder is no package)

LIBRARY = re.compile(r"gdtslam(?:_tools)?_library\(")


def libraries():
    """The folders whose sources make one target: a library each, and each layer and part of the tests."""
    for folder in ("engine", "calib", "viewer", "tools"):
        for file in (ROOT / folder).rglob("CMakeLists.txt"):
            if file.parent != ROOT / "tools" and LIBRARY.search(file.read_text()):
                yield file.parent
    for layer in ("unit", "property", "oracle", "golden", "equivalence"):
        yield from (ROOT / "tests" / layer).iterdir()


def clashes(sources):
    """The constants, types and aliases that more than one anonymous namespace defines, if not in the same words.

    Functions of one name differ in what they take, or the build of everything finds them."""
    lines = collections.defaultdict(dict)
    for path in sources:
        text = path.read_text()
        for name in lint.hidden_names(text):
            defined = re.search(rf"^(?:using|constexpr|const|struct|class|enum)\b[^(\n]*?\b{name}\b.*$", text, re.MULTILINE)
            if defined and re.match(r"k?[A-Z]", name):
                lines[name][path.name] = defined[0] if defined[0].startswith("using") else path.name
    return {name: sorted(found) for name, found in lines.items() if len(set(found.values())) > 1}


class Unity(unittest.TestCase):
    maxDiff = None

    def test_names_of_anonymous_namespaces_differ_within_a_library(self):
        found = {str(folder.relative_to(ROOT)): clashes(sorted(folder.rglob("*.cpp"))) for folder in libraries()}
        self.assertGreater(len(found), 40, "these are not all libraries")
        self.assertEqual({folder: names for folder, names in found.items() if names}, {})


if __name__ == "__main__":
    unittest.main()
