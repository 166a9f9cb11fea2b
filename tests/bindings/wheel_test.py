"""The wheel is built by pip without the network, installs into a folder, and maps there to the same hash."""
import os
import pathlib
import re
import subprocess
import sys
import zipfile

from bindings_support import LIBRARY, SAMPLE, SKIPPED, SOURCE, fail, folder, run, sample_hashes, skip_without

for module, package in (("pip", "python3-pip"), ("wheel", "python3-wheel"), ("numpy", "python3-numpy")):
    if subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode != 0:
        print(f"SKIPPED: no {module} for Python (package {package})")
        sys.exit(1 if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1" else SKIPPED)
skip_without("patchelf", "patchelf")

work = folder("wheel")
clean = {name: value for name, value in os.environ.items() if not name.startswith(("GDTSLAM", "PYTHONPATH", "LD_"))}


def built(name, **settings):
    """The wheel with these settings."""
    out = work / name
    variables = {f"GDTSLAM_{key.upper()}": str(value) for key, value in settings.items()}
    run(sys.executable, "-m", "pip", "wheel", "--no-index", "--no-deps", "--no-build-isolation", "--disable-pip-version-check",
        "--quiet", "-w", out, SOURCE / "python", env={**clean, **variables, "PIP_FIND_LINKS": "", "TMPDIR": str(work)})
    return next(out.glob("*.whl"))


def check(wheel):
    """Its names, then a run from it in a folder where there is nothing else of the project."""
    place = work / f"{wheel.parent.name}-installed"
    run(sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--disable-pip-version-check", "--quiet", "--target", place,
        wheel, env=clean)
    code = (
        "import gdtslam, sys\n"
        "assert gdtslam.__file__.startswith(sys.argv[1]), gdtslam.__file__\n"
        "maps = open('/proc/self/maps').read()\n"
        "assert sys.argv[1] + '/gdtslam/lib/libgdtslam.so.0' in maps\n"
        "run = gdtslam.map(sys.argv[2], sys.argv[3])\n"
        "print(run.map_sha256, run.trajectory_sha256, *sorted({line.split()[-1] for line in maps.splitlines() if '.so' in line}))\n"
    )
    words = run(sys.executable, "-c", code, place, SAMPLE, work / f"{wheel.parent.name}-run", cwd=work,
                env={**clean, "PYTHONPATH": str(place)}).split()
    if tuple(words[:2]) != sample_hashes():
        fail(f"{wheel.name} gives {words[:2]}")
    return place, words[2:]


plain = built("plain", library=LIBRARY)
if not re.fullmatch(r"gdtslam-[0-9.]+-py3-none-linux_\w+\.whl", plain.name):
    fail(f"the name {plain.name}")
with zipfile.ZipFile(plain) as archive:
    names = archive.namelist()
    if archive.testzip() or "gdtslam/py.typed" not in names or not any(name.endswith("/LICENSE") for name in names):
        fail(f"{names}")
check(plain)
# By its name from the project's folder, as in docs/howto/python.md.
if built("again", library=os.path.relpath(LIBRARY, SOURCE)).read_bytes() != plain.read_bytes():
    fail("the same inputs give another wheel")

whole = built("whole", library=LIBRARY, bundle=1)
if not re.fullmatch(r"gdtslam-[0-9.]+-py3-none-linux_\w+\.whl", whole.name):
    fail(f"the name {whole.name}")
place, loaded = check(whole)
own = {path.name for path in (place / "gdtslam/lib").iterdir()}
for file in loaded:  # of what it brings nothing is the system's, but what Python had loaded before
    path = pathlib.Path(file)
    if path.name in own and place not in path.parents and path.name not in run(
            sys.executable, "-c", "import ctypes, numpy\nprint(open('/proc/self/maps').read())", env=clean):
        fail(f"{file} is the system's")
print(plain.name, plain.stat().st_size, whole.name, whole.stat().st_size)
