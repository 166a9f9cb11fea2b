"""Puts the shared library and its header into the wheel of gdtslam.

Environment:
    GDTSLAM_LIBRARY: the file libgdtslam.so, from this folder or the project's if the name is relative; without it the
        project is built by CMake beside this folder.
    GDTSLAM_BUNDLE=1: put the libraries that it needs into the wheel, but for those that every Linux has.

One wheel serves every Python 3, for nothing is compiled against Python.
"""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

HERE = pathlib.Path(__file__).resolve().parent
PROJECT = HERE.parent
EVERYWHERE = re.compile(r"^(lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+)\.so\.\d+|ld-linux.*\.so\.\d+|linux-vdso\.so\.1)$")


def output(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def version():
    return re.search(r"^project\(gdtslam VERSION ([0-9.]+)", (PROJECT / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)


def built_library():
    build = PROJECT / "build" / "wheel"
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    parts = [f"-DGDTSLAM_BUILD_{part}=OFF" for part in ("TESTS", "EXAMPLES", "LAB", "SIM", "CALIBRATION")]
    options = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON", "-DGDTSLAM_WERROR=OFF"]
    subprocess.run(["cmake", "-S", PROJECT, "-B", build, *generator, *options, *parts], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "gdtslam_c", "--parallel", str(os.cpu_count() or 1)], check=True)
    return next(build.glob("lib*/**/libgdtslam.so.0"))


def named_library(name):
    """pip calls this in the folder of pyproject.toml, and whoever calls pip stands in the project's."""
    for folder in (HERE, PROJECT):
        if (folder / name).is_file():
            return folder / name
    raise SystemExit(f"gdtslam: there is no library {name}" + ("" if os.path.isabs(name) else f", in {HERE} or in {PROJECT}"))


def needed(library):
    """The libraries that it needs, and those that they need, where the loader finds them; not what is everywhere."""
    found = []
    for line in output("ldd", library).splitlines():
        if EVERYWHERE.match(pathlib.Path(line.split()[0]).name):
            continue
        if "=>" not in line or "not found" in line:
            raise SystemExit(f"gdtslam: {library} is incomplete on this machine: {line.strip()}")
        found.append(pathlib.Path(line.split("=>")[1].split()[0]))
    return found


class BuildPackage(build_py):
    def run(self):
        super().run()
        package = pathlib.Path(self.build_lib, "gdtslam")
        for file in (PROJECT / "LICENSE", PROJECT / "engine/c/include/gdtslam.h"):
            shutil.copyfile(file, package / file.name)
        named = os.environ.get("GDTSLAM_LIBRARY")
        library = named_library(named) if named else built_library()
        others = needed(library) if os.environ.get("GDTSLAM_BUNDLE", "0") not in ("", "0") else []
        (package / "lib").mkdir(exist_ok=True)
        for name, file in {"libgdtslam.so.0": library, **{other.name: other for other in others}}.items():
            target = package / "lib" / name
            shutil.copyfile(file, target)
            target.chmod(0o755)
            output("strip", "--strip-unneeded", target)
            if others:  # each is found from where it lies
                output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN", target)
        for other in others:  # the licence of the Debian package that it comes from, known by /lib or by /usr/lib
            owner = output("dpkg-query", "--search", f"*/{other.resolve().name}").split(":")[0]
            (package / "licences").mkdir(exist_ok=True)
            shutil.copyfile(pathlib.Path("/usr/share/doc", owner, "copyright"), package / "licences" / f"{owner}.txt")


class WithLibrary(Distribution):
    def has_ext_modules(self):
        """Also means that the package goes where those of this processor are."""
        return True


class LinuxWheel(bdist_wheel):
    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


os.environ.setdefault("SOURCE_DATE_EPOCH", "315532800")  # the same inputs give the same wheel
with tempfile.TemporaryDirectory() as work:  # nothing is left in the sources
    setup(
        version=version(),
        packages=["gdtslam"],
        package_data={"gdtslam": ["py.typed"]},
        distclass=WithLibrary,
        cmdclass={"build_py": BuildPackage, "bdist_wheel": LinuxWheel},
        options={"build": {"build_base": work}, "egg_info": {"egg_base": work}},
    )
