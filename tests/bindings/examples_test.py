"""Programs of 20 lines in C, Python and Rust map the sample log and a simulated office to the hash of the command."""
import os
import subprocess
import sys

from bindings_support import LIBRARY, SAMPLE, SKIPPED, SOURCE, fail, folder, run, same_run, sample_hashes

EXAMPLES = SOURCE / "examples"
work = folder("examples")
library_folder = LIBRARY.parent
loaded = {**os.environ, "LD_LIBRARY_PATH": str(library_folder), "PYTHONPATH": str(SOURCE / "python")}
skipped = []


def rust_program():
    """Built by plain rustc; None where there is none."""
    rustc = next((path for path in ("/usr/bin/rustc",) if os.access(path, os.X_OK)), None)
    if rustc is None:
        if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1":
            fail("no rustc on this machine (package rustc)")
        skipped.append("no rustc on this machine (package rustc)")
        return None
    run(rustc, "-D", "warnings", "-O", "-L", library_folder, "-l", "gdtslam", "-o", work / "map_rust", EXAMPLES / "rust/map.rs")
    return [work / "map_rust"]


programs = {"c": [os.environ["GDTSLAM_C_EXAMPLE"]], "rust": rust_program()}
python = os.environ["GDTSLAM_PYTHON"]
if subprocess.run([python, "-c", "import numpy"], capture_output=True).returncode == 0:
    programs["python"] = [python, EXAMPLES / "python/map.py"]
else:
    skipped.append("no numpy for Python (package python3-numpy)")
    if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1":
        fail(skipped[-1])

for source in ("c/map.c", "python/map.py", "rust/map.rs"):
    lines = (EXAMPLES / source).read_text().count("\n")
    if lines > 20:
        fail(f"examples/{source} has {lines} lines")

logs = {"sample": (SAMPLE, sample_hashes())}
if "GDTSLAM" in os.environ and "GDTSLAM_HAS_SIM" in os.environ:
    log = work / "office-loop.log"
    run(os.environ["GDTSLAM"], "simulate", "office-loop", "--quiet", "-o", log)
    logs["office-loop"] = (log, None)

for name, (log, expected) in logs.items():
    command = work / f"{name}-command"
    if "GDTSLAM" in os.environ:
        run(os.environ["GDTSLAM"], "map", log, "-o", command, "--quiet", "--device", "cpu")
    for language, program in programs.items():
        if program is None:
            continue
        out = work / f"{name}-{language}"
        words = run(*program, log, out, env=loaded).split()
        if expected is None:
            expected = words
        if list(words) != list(expected):
            fail(f"{language}: {name} gives {words} and not {expected}")
        if command.exists():
            same_run(command, out)
        print(f"{language}: {name} {words[0][:16]} {words[1][:16]}")

for language, program in programs.items():  # errors have the command's text and exit code
    if program is not None:
        done = subprocess.run([*map(str, program), "no/such.log", str(work / "none")], capture_output=True, text=True, env=loaded)
        if done.returncode != 74 or done.stderr != "map: no/such.log: cannot be opened: No such file or directory\n":
            fail(f"{language}: exit {done.returncode}, '{done.stderr}'")
for line in skipped:
    print(f"SKIPPED: {line}")
sys.exit(SKIPPED if skipped else 0)
