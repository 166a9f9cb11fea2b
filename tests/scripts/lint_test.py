"""Tests of tools/scripts/lint.py: checking sources together finds what checking them one by one does."""

import json
import os
import re
import shutil
import sys
import unittest

from scripts_test import ROOT, ScriptTest

# One finding each, and the check that makes it. Each kind is found in its own way: by matching the syntax, by following the
# preprocessor, by counting uses up to the end of the file, only in main files, or in a header of the project.
FINDINGS = {
    "readability-identifier-naming": "namespace {\nconst int limit = 3;\n}\nint NAME() { return limit; }",
    "clang-diagnostic-reserved-identifier": "int __NAME() { return 1; }",
    "cppcoreguidelines-init-variables": "int NAME(bool b) {\n  int i;\n  if (b) i = 2; else i = 3;\n  return i;\n}",
    "modernize-use-nullptr": "int* NAME() { return 0; }",
    "modernize-deprecated-headers": "#include <stddef.h>\nint NAME() { return 1; }",
    "performance-unnecessary-value-param":
        "struct BigNAME { ~BigNAME(); int i; };\nint NAME(BigNAME big) { return big.i; }",
    "bugprone-macro-parentheses": "#define TWICE_NAME(x) x + x\nint NAME() { return TWICE_NAME(2); }",
    "bugprone-integer-division": "double NAME(int i) { return i / 2; }",
    "misc-throw-by-value-catch-by-reference":
        "struct FaultNAME { ~FaultNAME(); };\nint NAME() {\n  try { throw FaultNAME(); } catch (FaultNAME f) { return 1; }\n}",
    "misc-unused-using-decls": "namespace far { struct ThingNAME {}; }\nusing far::ThingNAME;\nint NAME() { return 1; }",
    "misc-unused-alias-decls": "namespace farNAME {}\nnamespace nearNAME = farNAME;\nint NAME() { return 1; }",
    "google-explicit-constructor": '#include "NAME.hpp"\nint NAME() { return FromNAME(2).i; }',
}
# What is missing above must come from the header beside the source.
HEADER = "#pragma once\nstruct FromNAME {\n  FromNAME(int j) : i(j) {}\n  int i;\n};\n"


@unittest.skipIf(not shutil.which("clang-tidy") and os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") != "1", "no clang-tidy here")
class Lint(ScriptTest):
    """lint.py over a small project of its own, with the settings of this one."""

    def setUp(self):
        super().setUp()
        (self.work / "tools/scripts").mkdir(parents=True)
        (self.work / "build").mkdir()
        shutil.copy(ROOT / "tools/scripts/lint.py", self.work / "tools/scripts")
        shutil.copy(ROOT / ".clang-tidy", self.work)
        self.sources = []

    def source(self, name, text):
        path = self.work / "engine" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        self.sources.append(path)
        return path

    def target_of(self, path):
        """The arguments of two folders differ, and so they have batches of their own, unless they are of one target."""
        return "TARGET" if path.parent.name.startswith("part") else "TARGET_" + path.parent.name

    def lint(self, *files, options=()):
        commands = [{"directory": str(self.work / "build"), "file": str(path),
                     "command": f"ccache c++ -std=c++20 -D{self.target_of(path)} -Werror -o {path.stem}.o -c {path}"} for path in self.sources]
        (self.work / "build/compile_commands.json").write_text(json.dumps(commands))
        return self.run_script(sys.executable, self.work / "tools/scripts/lint.py", *options, self.work / "build", *files)

    def wrong_ones(self, done):
        return set(re.findall(r"^--- (.*)$", done.stdout, re.MULTILINE))

    def test_each_kind_of_finding_is_made_in_a_batch(self):
        for number, text in enumerate(FINDINGS.values()):
            folder = f"f{number}"
            self.source(f"{folder}/a.cpp", "int first() { return 1; }\n")
            self.source(f"{folder}/planted.cpp", text.replace("NAME", "planted") + "\n")
            if "NAME.hpp" in text:
                (self.work / "engine" / folder / "planted.hpp").write_text(HEADER.replace("NAME", "planted"))
            self.source(f"{folder}/z.cpp", "int last(int value) { return value; }\n")
        done = self.lint()
        self.assertEqual(done.returncode, 1, done.stderr)
        reports = {match[1]: match[0] for match in re.finditer(r"^--- (.*)\n(?:(?!--- ).*\n)*", done.stdout, re.MULTILINE)}
        self.assertEqual(sorted(reports), sorted(f"engine/f{n}/planted.cpp" for n in range(len(FINDINGS))), done.stdout)
        for number, check in enumerate(FINDINGS):
            self.assertIn(f"[{check},", reports[f"engine/f{number}/planted.cpp"])
        # All shared a batch with their neighbours but the alias, whose name stands in its source only once.
        self.assertIn(f", in {len(FINDINGS) + 1} batches\n", done.stdout)

    def test_a_use_elsewhere_does_not_hide_an_unused_name(self):
        header = "#pragma once\nnamespace far {\nstruct Thing { int i = 1; };\n}\n"
        self.source("a.cpp", '#include "far.hpp"\nusing far::Thing;\nint first() { return 1; }\n')
        self.source("z.cpp", '#include "far.hpp"\nint last() { return far::Thing().i; }\n')
        (self.work / "engine/far.hpp").write_text(header)
        done = self.lint()
        self.assertIn("--- engine/a.cpp", done.stdout)
        self.assertIn("[misc-unused-using-decls,", done.stdout)
        self.assertIn("1 of 2 checked sources pass", done.stdout)

    def test_sources_that_are_compiled_together_are_found_again(self):
        fine = self.source("fine.cpp", "int fine() { return 1; }\n")
        wrong = self.source("wrong.cpp", "int* wrong() { return 0; }\n")
        together = self.work / "build/engine/Unity/unity_0_cxx.cxx"
        together.parent.mkdir(parents=True)
        together.write_text(f'/* generated by CMake */\n\n#include "{fine}"\n\n#include "{wrong}"\n')
        self.sources = [together]
        done = self.lint()
        self.assertEqual(self.wrong_ones(done), {"engine/wrong.cpp"}, done.stdout + done.stderr)
        self.assertIn("1 of 2 checked sources pass", done.stdout)

    def test_names_that_clash_part_a_batch(self):
        for name in ("a", "b", "c"):
            result = "0" if name == "c" else "nullptr"
            self.source(f"{name}.cpp", f"static int* same() {{ return {result}; }}\nint* {name}() {{ return same(); }}\n")
        self.source("e.cpp", "int other() { return 1; }\n")
        done = self.lint()
        self.assertIn("3 of 4 checked sources pass", done.stdout)
        self.assertRegex(done.stdout, r"--- engine/c.cpp\n.*/engine/c.cpp:1:29: error: use nullptr")

    def test_a_source_that_does_not_compile_is_named(self):
        self.source("a.cpp", "int first() { return 1; }\n")
        self.source("broken.cpp", "int broken() { return absent; }\n")
        done = self.lint()
        self.assertRegex(done.stdout, r"--- engine/broken.cpp\n.*/engine/broken.cpp:1:23: error: use of undeclared")
        self.assertIn("1 of 2 checked sources pass", done.stdout)

    def test_what_the_time_leaves_out_is_counted_and_did_not_pass(self):
        self.source("a.cpp", "int* first() { return 0; }\n")
        done = self.lint(options=("--seconds", "0"))
        self.assertEqual(done.returncode, 77, done.stdout)
        self.assertIn("0 of 0 checked sources pass\n1 were left out", done.stdout)
        self.assertEqual(self.lint(options=("--seconds", "600")).returncode, 1)


if __name__ == "__main__":
    unittest.main()
