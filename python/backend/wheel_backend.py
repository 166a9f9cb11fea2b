"""Builds the wheel of gdtslam (PEP 517): the package, the shared library, and what it needs if that is wanted.

Settings, of pip's --config-settings or the environment:
    library, GDTSLAM_LIBRARY: the file libgdtslam.so, from this folder or the project's where the name is relative; without
        it the project is built by CMake beside this folder.
    bundle, GDTSLAM_BUNDLE=1: put the libraries that it needs into the wheel, but for those that every Linux has.

One wheel serves every Python 3, for nothing is compiled against Python. It is for every Linux of this processor whose C
library is new enough (manylinux) where it needs nothing else, and else for this system (linux).
"""

from __future__ import annotations

import base64
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent.parent
PROJECT = HERE.parent
# What manylinux has on every system; ld-linux by its processor.
EVERYWHERE = re.compile(r"^(lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+)\.so\.\d+|ld-linux.*\.so\.\d+|linux-vdso\.so\.1)$")
# The oldest C library of a system that has these symbols of libstdc++: RHEL 8 and 9, Debian 11, Ubuntu 22.04, 23.10 and 24.04.
STANDARD_LIBRARY = {(3, 4, 25): (2, 28), (3, 4, 28): (2, 31), (3, 4, 29): (2, 34), (3, 4, 30): (2, 35), (3, 4, 32): (2, 38), (3, 4, 33): (2, 39)}
TIME = (1980, 1, 1, 0, 0, 0)  # the same inputs give the same wheel


def _output(*command: object) -> str:
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def _setting(settings: "dict[str, str] | None", name: str) -> str:
    return (settings or {}).get(name) or os.environ.get("GDTSLAM_" + name.upper(), "")


def _version() -> str:
    text = (PROJECT / "CMakeLists.txt").read_text()
    found = re.search(r"^project\(gdtslam VERSION ([0-9.]+)", text, re.MULTILINE)
    if not found:
        raise SystemExit("gdtslam: CMakeLists.txt tells no version")
    return found.group(1)


def _built_library() -> pathlib.Path:
    build = PROJECT / "build" / "wheel"
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    parts = [f"-DGDTSLAM_BUILD_{part}=OFF" for part in ("TESTS", "EXAMPLES", "LAB", "SIM", "CALIBRATION")]
    parts.append("-DGDTSLAM_WERROR=OFF")
    subprocess.run(
        ["cmake", "-S", PROJECT, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON", *generator, *parts],
        check=True,
    )
    subprocess.run(["cmake", "--build", build, "--target", "gdtslam_c", "--parallel", str(os.cpu_count() or 1)], check=True)
    return next(build.glob("lib*/**/libgdtslam.so.0"))


def _named_library(name: str) -> pathlib.Path:
    """pip calls the backend in the folder of pyproject.toml, and whoever calls pip stands in the project's."""
    for folder in (HERE, PROJECT):
        if (folder / name).is_file():
            return folder / name
    raise SystemExit(f"gdtslam: there is no library {name}" + ("" if os.path.isabs(name) else f", in {HERE} or in {PROJECT}"))


def _needed(library: pathlib.Path) -> "list[pathlib.Path]":
    """The libraries that it needs, and those that they need, where the loader finds them; not what is everywhere."""
    found = []
    for line in _output("ldd", library).splitlines():
        name = line.split()[0]
        if EVERYWHERE.match(pathlib.Path(name).name):
            continue
        if "=>" not in line or "not found" in line:
            raise SystemExit(f"gdtslam: {library} is incomplete on this machine: {line.strip()}")
        found.append(pathlib.Path(line.split("=>")[1].split()[0]))
    return found


def _needs_nothing(library: pathlib.Path, beside: "set[str]") -> bool:
    names = re.findall(r"\(NEEDED\).*\[(.*)\]", _output("readelf", "--dynamic", "--wide", library))
    return all(EVERYWHERE.match(name) or name in beside for name in names)


def _numbers(version: str) -> "tuple[int, ...]":
    return tuple(int(number) for number in version.split("."))


def _platform_of(libraries: "list[pathlib.Path]") -> str:
    machine = platform.machine()
    names = {library.name for library in libraries}
    if not all(_needs_nothing(library, names) for library in libraries):
        return f"linux_{machine}"
    symbols = "".join(_output("readelf", "--version-info", "--wide", library) for library in libraries)
    needed = [_numbers(version) for version in re.findall(r"GLIBC_(\d+\.\d+)", symbols)]
    standard = max(map(_numbers, re.findall(r"GLIBCXX_(\d+(?:\.\d+)+)", symbols)), default=(3, 4))
    systems = [system for version, system in STANDARD_LIBRARY.items() if version >= standard]
    if not systems:  # newer than what is known here
        return f"linux_{machine}"
    major, minor = max([*needed, min(systems)])
    return f"manylinux_{major}_{minor}_{machine}"


def _library_files(settings: "dict[str, str] | None", folder: pathlib.Path) -> "tuple[list[pathlib.Path], ...]":
    """The library and what comes with it, without debug information, and each found from where it lies; and where those
    that come with it were."""
    named = _setting(settings, "library")
    source = _named_library(named) if named else _built_library()
    others = _needed(source) if _setting(settings, "bundle") not in ("", "0") else []
    sources = {"libgdtslam.so.0": source, **{library.name: library for library in others}}
    files = []
    for name, file in sources.items():
        target = folder / name
        shutil.copyfile(file, target)
        target.chmod(0o755)
        _output("strip", "--strip-unneeded", target)
        if len(sources) > 1:
            _output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN", target)
        files.append(target)
    return files, others


def _licences(others: "list[pathlib.Path]") -> "dict[str, bytes]":
    """Our text, and those of the Debian packages that other libraries in the wheel come from."""
    texts = {"LICENSE": (PROJECT / "LICENSE").read_bytes()}
    for library in others:  # known by /lib or by /usr/lib
        owner = _output("dpkg-query", "--search", f"*/{library.resolve().name}").split(":")[0]
        texts[f"licences/{owner}.txt"] = pathlib.Path("/usr/share/doc", owner, "copyright").read_bytes()
    return texts


def _metadata(version: str) -> str:
    project = (HERE / "pyproject.toml").read_text()
    summary = re.search(r'^description = "(.*)"', project, re.MULTILINE)
    needs = re.search(r'^dependencies = \["(.*)"\]', project, re.MULTILINE)
    python = re.search(r'^requires-python = "(.*)"', project, re.MULTILINE)
    if not (summary and needs and python):
        raise SystemExit("gdtslam: pyproject.toml lacks what the wheel says of itself")
    return (
        f"Metadata-Version: 2.1\nName: gdtslam\nVersion: {version}\nSummary: {summary.group(1)}\n"
        f"Requires-Python: {python.group(1)}\nRequires-Dist: {needs.group(1)}\n"
    )


def _write(archive: zipfile.ZipFile, rows: "list[str]", name: str, data: bytes, mode: int = 0o644) -> None:
    info = zipfile.ZipInfo(name, TIME)
    info.external_attr = (0o100000 | mode) << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(info, data)
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    rows.append(f"{name},sha256={digest},{len(data)}")


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """PEP 517; the library is not needed for it."""
    folder = pathlib.Path(metadata_directory, f"gdtslam-{_version()}.dist-info")
    folder.mkdir()
    (folder / "METADATA").write_text(_metadata(_version()))
    return folder.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """PEP 517."""
    version = _version()
    info = f"gdtslam-{version}.dist-info"
    rows: "list[str]" = []
    with tempfile.TemporaryDirectory() as scratch:
        libraries, others = _library_files(config_settings, pathlib.Path(scratch))
        tag = f"py3-none-{_platform_of(libraries)}"
        name = f"gdtslam-{version}-{tag}.whl"
        with zipfile.ZipFile(pathlib.Path(wheel_directory, name), "w") as archive:
            for source in sorted((HERE / "gdtslam").glob("*")):
                if source.suffix == ".py" or source.name == "py.typed":
                    _write(archive, rows, f"gdtslam/{source.name}", source.read_bytes())
            for library in libraries:
                _write(archive, rows, f"gdtslam/lib/{library.name}", library.read_bytes(), 0o755)
            for licence, text in _licences(others).items():
                _write(archive, rows, f"{info}/{licence}", text)
            _write(archive, rows, f"{info}/METADATA", _metadata(version).encode())
            wheel = f"Wheel-Version: 1.0\nGenerator: gdtslam\nRoot-Is-Purelib: false\nTag: {tag}\n"
            _write(archive, rows, f"{info}/WHEEL", wheel.encode())
            _write(archive, [], f"{info}/RECORD", "\n".join([*rows, f"{info}/RECORD,,", ""]).encode())
    return name


def build_sdist(sdist_directory, config_settings=None):
    """PEP 517. The library is built from the whole project, which is what its own source archive is for."""
    raise SystemExit("gdtslam: there is no source archive of the Python package alone; take that of the project")


__all__ = ["build_sdist", "build_wheel", "prepare_metadata_for_build_wheel"]
