"""The main commands as cases, each with the bytes that it gives in an ordinary place, to be run in hostile ones."""

import hashlib
import re
import shutil
import subprocess

import cli_support as cli
from cli_support import LOG, RUN, TRUTH, expect

# What a run folder says of time, machine and memory.
OF_THE_MACHINE = {"report.json"}
# Names of processors and the time taken, in what verify prints.
OF_THE_TIME = re.compile(r"^cpu.*$|^\d+\.\d+ s$", re.MULTILINE)


class Case:
    """A command with {out} in its arguments, the folder of what it writes; what it prints counts where it is the same each
    time. Commands that go on with a run get a copy of one."""

    def __init__(self, name, *arguments, prints=False, begin=None):
        self.name, self.arguments, self.prints, self.begin = name, [str(word) for word in arguments], prints, begin
        self.expected = None

    def words(self, out):
        return [word.replace("{out}", str(out)) for word in self.arguments]

    def prepare(self, out):
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir(parents=True)
        if self.begin:
            shutil.copytree(self.begin, out / "run")


def files_of(folder):
    """sha256 by name, and what else is there."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.name not in OF_THE_MACHINE:
            found[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "folder"
    return found


def results_of(case, out, stdout):
    return files_of(out), OF_THE_TIME.sub("", stdout.decode("utf-8").replace(str(out), "{out}")) if case.prints else None


def cases_of(folder):
    """The commands, and what each gives here."""
    lines = LOG.read_text().splitlines(keepends=True)
    (folder / "first.log").write_text("".join(lines[:130]))
    (folder / "second.log").write_text("".join(lines[130:230]))
    cli.mapped(folder / "begun", log=folder / "first.log")
    cases = [Case("map", "map", LOG, "-o", "{out}/run", "--first", 30),
             Case("map --continue", "map", "--continue", "{out}/run", folder / "second.log", "-q", begin=folder / "begun"),
             Case("evaluate", "evaluate", RUN / "trajectory.tum", "--reference", TRUTH, prints=True),
             Case("localize", "localize", RUN, LOG, "--scan", 40, "--no-runner-up", "-o", "{out}/poses.tum", "-q"),
             Case("simulate", "simulate", "office-loop", "-o", "{out}/drive.log", "--rate", 1, "-q"),
             Case("doctor", "doctor", folder / "first.log", prints=True),
             Case("config show", "config", "show", "-c", RUN / "config.yaml", prints=True),
             Case("verify", "verify", "distance_field", "--device", "cpu", "-q", prints=True)]
    if cli.environment().get("GDTSLAM_VIEWER") == "1":
        cases.append(Case("render", "render", RUN, "--view", "map", "-o", "{out}/map.png", "--size", "300x200", "-q"))
    for case in cases:
        process, out = run(case, folder)
        expect(process.returncode == 0 and process.stderr == b"", f"{case.name}: {process.returncode} {process.stderr}")
        case.expected = results_of(case, out, process.stdout)
        again, out = run(case, folder)
        expect(results_of(case, out, again.stdout) == case.expected, f"{case.name} gives other bytes the second time")
    return cases


def run(case, folder, before=(), **options):
    """Runs a case in its own empty folder, by another command where `before` has one; the process and the folder."""
    out = folder / "out"
    case.prepare(out)
    options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.run([*before, cli.PROGRAM, *case.words(out)], timeout=100 * cli.SLOWNESS, check=False, **options), out


def check(case, process, out, where, failures=(), remarks=""):
    """The bytes of an ordinary place, or one of these exit codes with one line; which of both. Lines on standard error that
    match `remarks` may stand beside either."""
    said = (process.stderr or b"").decode("utf-8").splitlines()
    rest = [line for line in said if not (remarks and re.search(remarks, line))]
    what = f"{case.name} {where}: exit {process.returncode}: {said}"
    if process.returncode == 0:
        expect(not rest, what)
        stdout = process.stdout if process.stdout is not None else b""
        found = results_of(case, out, stdout)
        expect(found[0] == case.expected[0], f"{what}: other files: {sorted(set(found[0].items()) ^ set(case.expected[0].items()))}")
        expect(process.stdout is None or found[1] == case.expected[1], f"{what}: other words: {stdout}")
        return True
    expect(process.returncode in failures, what)
    expect(process.stderr is None or (len(rest) == 1 and rest[0].startswith("gdtslam: error: ")), what)
    expect("unexpected" not in "".join(rest) and "terminate" not in "".join(rest), what)
    expect(not [name for name in files_of(out) if ".gdtslam-new" in name or name.endswith(".tmp")], f"{what}: left {files_of(out)}")
    return False


def check_all(cases, folder, where, failures=(), before=(), remarks="", must=True, **options):
    """All cases in one place; the names of those that failed as they may. With `must` none may."""
    failed = []
    for case in cases:
        process, out = run(case, folder, before, **options)
        if not check(case, process, out, where, failures, remarks):
            failed.append(case.name)
    expect(not (must and failed), f"{where}: {failed} do not work")
    return failed
