"""Lists agree: debian/control with what CMake looks for, pages with what is not in the bundle, test.sh with what packages hold."""

import os
import re
import shutil
import subprocess
import time
import unittest

from scripts_test import ROOT, ScriptTest

# The Debian package of each that gdtslamConfig.cmake looks for; of Threads it is the C library's.
DEBIAN = {"Eigen3": "libeigen3-dev", "yaml-cpp": "libyaml-cpp-dev", "nlohmann_json": "nlohmann-json3-dev", "ZLIB": "zlib1g-dev",
          "BZip2": "libbz2-dev", "PkgConfig": "pkg-config", "liblz4": "liblz4-dev", "libzstd": "libzstd-dev",
          "SQLite3": "libsqlite3-dev", "LibLZMA": "liblzma-dev", "PNG": "libpng-dev", "OpenSSL": "libssl-dev", "fmt": "libfmt-dev",
          "Ceres": "libceres-dev", "VTK": "libvtk9-dev", "OpenGL": "libegl-dev", "GLEW": "libglew-dev", "cairo": "libcairo2-dev",
          "embree": "libembree-dev"}
SUGGESTED = {"VTK", "OpenGL", "GLEW", "embree"}  # of viewer and sim, which find_package(COMPONENTS runs) does not ask for
# In every build of a Debian package, and a program that is called.
NOT_NAMED = {"g++", "ffmpeg"}


def control(package, field):
    """The names in a field of debian/control; of the source where package is ''."""
    stanza = next(text for text in (ROOT / "debian/control").read_text().split("\n\n")
                  if (f"\nPackage: {package}\n" in "\n" + text if package else text.startswith("Source:")))
    found = re.search(rf"^{field}:((?:.*\n[ \t])*.*)", stanza, re.MULTILINE)
    return {re.split(r"[\s(:\[}]", name.split("}")[-1].strip(), maxsplit=1)[0] for name in found.group(1).split(",")} - {""}


class DebianControl(unittest.TestCase):
    def test_what_a_build_needs_is_what_install_packages_installs(self):
        script = (ROOT / "tools/install-packages.sh").read_text()
        wanted = set(re.search(r"^build_packages=\((.*?)^\)", script, re.DOTALL | re.MULTILINE).group(1).split())
        self.assertLessEqual(NOT_NAMED, wanted)
        self.assertEqual(wanted - NOT_NAMED - control("", "Build-Depends"), set())

    def test_the_development_package_names_what_find_package_looks_for(self):
        config = (ROOT / "cmake/gdtslamConfig.cmake.in").read_text()
        asked = set(re.findall(r"^ *find_dependency\(([\w-]+)", config, re.MULTILINE)) - {"Threads"}
        asked |= set(re.findall(r"^ *_gdtslam_find_module\(\w+ ([\w-]+)\)", config, re.MULTILINE))
        self.assertEqual(asked, set(DEBIAN))
        installed = control("libgdtslam-dev", "Depends") | control("libgdtslam-dev", "Recommends")
        self.assertEqual({name for name in asked - SUGGESTED if DEBIAN[name] not in installed}, set())
        suggested = control("libgdtslam-dev", "Suggests")
        self.assertEqual({DEBIAN[name] for name in SUGGESTED} - suggested, set())


class Bundle(unittest.TestCase):
    def test_the_pages_name_the_commands_that_are_not_in_it(self):
        static = (ROOT / "cmake/GdtslamStatic.cmake").read_text()
        off = set(re.findall(r"^set\((GDTSLAM_BUILD_\w+) OFF\)", static, re.MULTILINE)) | {"GDTSLAM_BUILD_SIM"}
        commands = re.findall(r'\{"(\w+)", \w+, nullptr, "(\w+)"\}', (ROOT / "tools/gdtslam/main.cpp").read_text())
        lacking = {name for name, option in commands if option in off}
        self.assertEqual(lacking, {"render", "calibrate", "simulate"})
        self.assertIn("GDTSLAM_BUILD_LIVE_PAGE", off)
        for page in ("docs/howto/install.md", "tools/scripts/bundle_readme.md"):
            text = " ".join((ROOT / page).read_text().split())
            sentences = [words for words in re.findall(r"[^.|]*`render`[^.|]*", text) if "`live --page`" in words]
            self.assertTrue(sentences, page)
            for words in sentences:
                self.assertLessEqual({f"`{name}`" for name in lacking}, set(re.findall(r"`\w+`", words)), page)


class LeftOut(ScriptTest):
    """Which tests of packaging test.sh leaves out, in a copy of tools/ where nothing is built and it ends with the first ctest."""

    def setUp(self):
        super().setUp()
        self.tree = self.work / "somebody/tree"
        shutil.copytree(ROOT / "tools", self.tree / "tools", ignore=shutil.ignore_patterns("__pycache__"))
        (self.tree / "docs").mkdir()
        (self.tree / "docs/page.md").write_text("a page\n")
        for name, script in (("dpkg-query", "echo installed"), ("cmake", "exit 0"), ("shellcheck", "exit 0"),
                             ("ctest", f'echo "$*" >>{self.work}/calls')):
            self.stand_in(name, script)

    def git(self, folder, *words, days_ago=2):
        environment = {**os.environ, "GIT_COMMITTER_DATE": f"@{int(time.time()) - days_ago * 86400} +0000", "HOME": str(self.work)}
        subprocess.run(["git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b", *words], check=True, capture_output=True,
                       env=environment)

    def commit(self, folder, **options):
        self.git(folder, "init")
        self.git(folder, "add", ".")
        self.git(folder, "commit", "-m", "a", **options)

    def left_out(self):
        """The names behind install. in the first call of ctest, that of all tests."""
        done = self.run_script("/bin/bash", self.tree / "tools/test.sh", "--quick")
        self.assertTrue((self.work / "calls").exists(), done.stdout + done.stderr)
        return re.findall(r"install\\\.(\w+)", (self.work / "calls").read_text())

    def test_nothing_in_an_archive_that_lies_in_a_clone_of_something_else(self):
        self.commit(self.work / "somebody")
        self.assertEqual(self.left_out(), [])

    def test_nothing_in_a_clone_younger_than_six_hours(self):
        self.commit(self.tree, days_ago=0)
        self.assertEqual(self.left_out(), [])

    def test_all_where_nothing_has_changed(self):
        self.commit(self.tree)
        self.assertEqual(self.left_out(), ["bundle", "as_a_folder", "debian_packages"])

    def test_a_page_is_in_the_packages_alone(self):
        self.commit(self.tree)
        (self.tree / "docs/page.md").write_text("another page\n")
        self.assertEqual(self.left_out(), ["bundle", "as_a_folder"])

    def test_what_the_bundle_copies_is_in_it(self):
        self.commit(self.tree)
        with open(self.tree / "tools/scripts/gpu_server.sh", "a", encoding="utf-8") as script:
            script.write("# changed\n")
        self.assertEqual(self.left_out(), ["as_a_folder", "debian_packages"])


if __name__ == "__main__":
    unittest.main()
