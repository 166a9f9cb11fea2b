"""The library in a program that has set a locale with decimal commas: the same bytes, files, drawings and hashes."""
import hashlib
import os
import pathlib
import subprocess
import sys

from bindings_support import SAMPLE, SOURCE, fail, folder, run, skip_without

PROGRAM = """
import locale, sys
sys.path.insert(0, sys.argv[1])
if sys.argv[3]:
    locale.setlocale(locale.LC_ALL, sys.argv[3])
    assert locale.localeconv()["decimal_point"] == ",", "not a decimal comma"
import gdtslam
made = gdtslam.map(sys.argv[2], "run", options={"map.resolution": "7.5 cm"})
print(made.map_sha256, made.trajectory_sha256)
open("map.svg", "wb").write(made.render(format="svg"))
"""


def results(place, locale_name, environment):
    place.mkdir()
    said = run(sys.executable, "-c", PROGRAM, SOURCE / "python", SAMPLE, locale_name, cwd=place, env=environment)
    files = {str(file.relative_to(place)): hashlib.sha256(file.read_bytes()).hexdigest() for file in sorted(place.rglob("*"))
             if file.is_file() and file.name != "report.json"}
    return said, files


def main():
    localedef = skip_without("localedef", "locales")
    place = pathlib.Path(folder("locale"))
    for name in ("de_DE", "tr_TR"):
        subprocess.run([localedef, "-i", name, "-f", "UTF-8", place / f"{name}.UTF-8"], check=True, capture_output=True)
    environment = {**os.environ, "LOCPATH": str(place)}
    said, files = results(place / "usual", "", environment)
    if "run/gdt.png" not in files or "map.svg" not in files:
        fail(f"the usual run gives {said} {sorted(files)}")
    for name in ("de_DE.UTF-8", "tr_TR.UTF-8"):
        said_here, files_here = results(place / f"in-{name}", name, environment)
        if said_here != said:
            fail(f"{name}: {said_here!r} instead of {said!r}")
        other = [file for file in {**files, **files_here} if files.get(file) != files_here.get(file)]
        if other:
            fail(f"{name}: other bytes: {other}")
    print(f"{len(files)} files are the same in three locales")


if __name__ == "__main__":
    main()
