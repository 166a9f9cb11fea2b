"""Tests that the sources of a library can be compiled as one, whichever of them a build has."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
# What anonymous namespaces define at the beginning of a line, as clang-format leaves it: types, aliases; functions, constants.
HIDDEN = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
DEFINED = re.compile(r"^(?:struct|class|enum class) (\w+)|^using (\w+) ="
                     r"|^(?!using )\w[^(){}=;\n]*(?<!::)\b(\w+)(?:\[\w*\])*(?:\(| = |\{|;$)", re.MULTILINE)
LIBRARY = re.compile(r"gdtslam(?:_tools)?_library\(")


def libraries():
    """The folders whose sources make one target: a library each, and each layer and part of the tests."""
    for folder in ("engine", "calib", "viewer", "tools"):
        for file in (ROOT / folder).rglob("CMakeLists.txt"):
            if file.parent != ROOT / "tools" and LIBRARY.search(file.read_text()):
                yield file.parent
    for layer in ("unit", "property", "oracle", "golden", "equivalence"):
        yield from (ROOT / "tests" / layer).iterdir()


def hidden_names(text):
    """What the anonymous namespaces of a source define; macros such as TEST are in capitals."""
    found = (name for part in HIDDEN.findall(text) for names in DEFINED.findall(part) for name in names)
    return {name for name in found if name and not name.isupper()}


def code_of(text):
    """The text without comments and without what stands in quotes."""
    return re.sub(r'"(?:\\.|[^"\\\n])*"', '""', re.sub(r"//.*", "", text))


def clashes(sources):
    """The constants and types of a source's anonymous namespaces that another source mentions: in one unit it may mean the
    first one's, even where it has the name from a header. Aliases in the same words are the same.

    Functions of one name differ in what they take, or the build of everything finds them."""
    texts = {path: code_of(path.read_text()) for path in sources}
    found = {}
    for path, text in texts.items():
        for name in hidden_names(path.read_text()):
            word = re.compile(rf"(?<!\.)(?<!->)(?<!::)\b{name}\b")
            defined = re.search(rf"^(?:using|constexpr|const|struct|class|enum)\b[^(\n]*?\b{name}\b.*$", text, re.MULTILINE)
            if not defined or not re.match(r"k?[A-Z]", name):
                continue
            others = [other.name for other, there in texts.items() if other != path and name in there and word.search(there)
                      and not (defined[0].startswith("using") and defined[0] in there)]
            if others:
                found[f"{path.name}: {name}"] = sorted(others)
    return found


class Unity(unittest.TestCase):
    maxDiff = None

    def test_names_of_anonymous_namespaces_differ_within_a_library(self):
        found = {str(folder.relative_to(ROOT)): clashes(sorted(folder.rglob("*.cpp"))) for folder in libraries()}
        self.assertGreater(len(found), 40, "these are not all libraries")
        self.assertEqual({folder: names for folder, names in found.items() if names}, {})


if __name__ == "__main__":
    unittest.main()
