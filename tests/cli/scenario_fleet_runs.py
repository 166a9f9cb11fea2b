"""Run folders of an atlas that are gone, damaged, of other settings or twice, and jobs that a cluster takes by half."""

import gzip
import json
import os
import shutil
import subprocess

import cli_support as cli
from cli_support import LOG, command, environment, expect, expect_exit, fresh_folder
from scenario_fleet import QUICK, finished, fleet, make_logs, planned, status_of


def atlas_of_two(name):
    """An atlas of two short drives, mapped, with its hash."""
    folder = fresh_folder(name)
    logs = make_logs(folder / "logs", count=2)
    atlas = folder / "atlas"
    planned(atlas, logs)
    fleet("submit", atlas, "--engine", "local", "-q")
    return logs, atlas, finished(atlas)["atlas_sha256"]


def run_of(atlas, unit=0):
    record = json.loads((atlas / f"units/000/{unit:06}.json").read_text())
    return atlas / "runs" / record["run"][:2] / record["run"]


def fleet_runs_that_are_gone():
    """Logs whose run folders are gone are counted and named, keep no hash alive, and are mapped again to the same bytes."""
    _, atlas, whole = atlas_of_two("fleet_runs_that_are_gone")
    gone = run_of(atlas)
    kept = {path.name: path.read_bytes() for path in gone.iterdir() if path.name != "report.json"}
    for what in (gone, atlas / "runs"):
        shutil.rmtree(what)
        lost = 1 if what == gone else 2
        status = status_of(atlas)
        cli.validate(json.dumps(status), "fleet_status")
        expect((status["mapped"], status["missing"], status["lost"]) == (2 - lost, lost, lost), str(status))
        text = fleet("status", atlas).stdout
        expect(f"{lost} of the missing have a record, but their run folders are gone" in text, text)
        process = fleet("finish", atlas, code=65)
        expect(f"{gone}: is gone, or has no report.json" in process.stderr and "--shard 1\n" in process.stderr, process.stderr)
        expect(f"{lost} of 2 logs are not done" in process.stderr, process.stderr)
        report = json.loads(fleet("finish", atlas, "--partial", "--json").stdout)
        expect(report["atlas_sha256"] is None and report["missing"] == lost, str(report))
        process = fleet("submit", atlas, "--engine", "local")
        expect(f"the run folders of {lost} logs of the atlas are gone" in process.stderr, process.stderr)
        expect(finished(atlas)["atlas_sha256"] == whole, "another hash")
        again = {path.name: path.read_bytes() for path in gone.iterdir() if path.name != "report.json"}
        expect(again == kept, "another run")
    # Whose log is another one by now has another run: the record of the one that is gone does not stay.
    record = json.loads((atlas / "units/000/000000.json").read_text())
    with open(record["uri"], "a") as file:
        file.write("# longer\n")
    shutil.rmtree(gone)
    fleet("submit", atlas, "--engine", "local", "-q")
    expect(run_of(atlas) != gone and status_of(atlas)["lost"] == 0, f"{run_of(atlas)}")


def fleet_runs_without_their_reports():
    """Folders that lost their report, more in a row than a disk that is gone would be given, are named one by one and
    tried once; the other logs are mapped."""
    folder = fresh_folder("fleet_runs_without_their_reports")
    atlas = folder / "atlas"
    planned(atlas, make_logs(folder / "logs", count=8))
    fleet("submit", atlas, "--engine", "local", "-q")
    whole = finished(atlas)["atlas_sha256"]
    runs = [run_of(atlas, unit) for unit in range(8)]
    for run in runs[:7]:
        (run / "report.json").unlink()
    shutil.rmtree(runs[7])
    process = fleet("submit", atlas, "--engine", "local", code=74)
    for unit, run in enumerate(runs[:7]):
        expect(process.stderr.count(f"unit {unit} is not done: {run}: is no whole run") == 1, process.stderr)
    expect("is tried again" not in process.stderr, process.stderr)
    expect((runs[7] / "report.json").is_file(), "the log behind them is not mapped")
    for run in runs[:7]:
        shutil.rmtree(run)
    fleet("submit", atlas, "--engine", "local", "-q")
    expect(finished(atlas)["atlas_sha256"] == whole, "another hash")


def fleet_logs_that_are_gone():
    """Logs that are gone, more in a row than failures that the machine is to blame for may be, keep none from being mapped."""
    folder = fresh_folder("fleet_logs_that_are_gone")
    logs = make_logs(folder / "logs", count=9)
    atlas = folder / "atlas"
    planned(atlas, logs)
    for k in range(2, 9):  # the largest, which come first
        (logs / f"drive-{k}.log").unlink()
    process = fleet("run", atlas, "--shard", "1", "-j", "1", code=74)
    status = status_of(atlas)
    expect((status["mapped"], status["missing"]) == (2, 7), f"{status}: {process.stderr}")
    expect(process.stderr.count("is not done and is tried again") == 7, process.stderr)


def fleet_many_logs_that_are_gone():
    """A hundred logs in a row that are gone keep those behind them from nothing; the later ones are looked for once."""
    folder = fresh_folder("fleet_many_logs_that_are_gone")
    logs = make_logs(folder / "logs", count=9)
    for k in range(2, 9):
        (logs / f"drive-{k}.log").unlink()
    for k in range(101):
        (logs / f"large-{k}.log").touch()
        os.truncate(logs / f"large-{k}.log", 10_000_000)
    atlas = folder / "atlas"
    planned(atlas, logs, "--shards", 1)
    for k in range(101):
        (logs / f"large-{k}.log").unlink()
    process = fleet("run", atlas, "--shard", "1", "-j", "1", code=74)
    status = status_of(atlas)
    expect((status["mapped"], status["missing"]) == (2, 101), f"{status}: {process.stderr}")
    expect(process.stderr.count("is not done and is tried again") == 99, process.stderr)
    expect("101 of 103 logs are not done" in process.stderr, process.stderr)


def fleet_logs_that_break_the_program():
    """Logs that end their process by a signal, more in a row than a disk that is gone would be given, keep none from being
    mapped."""
    folder = fresh_folder("fleet_logs_that_break_the_program")
    logs = make_logs(folder / "logs", count=2)
    names = [*(f"bad-{k}" for k in range(7)), *(path.stem for path in logs.iterdir())]
    listed = "".join(f"x://robot/{name}.log\t{10_000_000 if 'bad' in name else 1}\n" for name in names)  # the largest come first
    atlas = folder / "atlas"
    get = f"name=$(basename {{}}); case $name in bad*) kill -9 $PPID;; esac; cat {logs}/$name"
    planned(atlas, "--list", "-", "--get", get, "--shards", 1, input=listed)
    process = fleet("run", atlas, "--shard", "1", "-j", "1", code=1)
    status = status_of(atlas)
    expect((status["mapped"], status["missing"]) == (2, 7), f"{status}: {process.stderr}")
    expect("by signal 9" in process.stderr, process.stderr)


def fleet_runs_that_are_damaged():
    """A damaged run, and one that somebody mapped by hand, are not taken; whoever does what the line says has the same hash."""
    logs, atlas, whole = atlas_of_two("fleet_runs_that_are_damaged")
    run = run_of(atlas)
    map_bytes = (run / "map.pgm").read_bytes()

    def refused_for(words):
        for name in ("units", "shards"):
            shutil.rmtree(atlas / name)
        process = fleet("submit", atlas, "--engine", "local", code=74)
        expect(words in process.stderr and "remove that folder and run its shard again" in process.stderr, process.stderr)
        expect("gdtslam map" not in process.stderr, process.stderr)
        shutil.rmtree(run)
        fleet("submit", atlas, "--engine", "local", "-q")
        expect(finished(atlas)["atlas_sha256"] == whole and (run / "map.pgm").read_bytes() == map_bytes, "another hash")

    (run / "map.pgm").write_bytes(map_bytes[:100])
    refused_for(f"{run}/map.pgm: has 100 bytes")
    log = json.loads((atlas / "units/000/000000.json").read_text())["uri"]
    shutil.rmtree(run)
    expect_exit(command("map", log, "-o", run, "-q", *QUICK, "--set", "map.resolution=20 cm"), 0)
    refused_for(f"{run}: is a run of other settings than the plan's")
    report = run / "report.json"
    report.write_text(report.read_text().replace('"path_m"', '"path_km"'))
    refused_for("report.json")
    # A file that no record and no hash of the atlas tells of, cut or gone.
    for name, change in (("gdt.png", lambda path: os.truncate(path, 100)), ("keyframes.bin.gz", os.unlink)):
        rest = (run / name).read_bytes()
        change(run / name)
        process = fleet("verify", atlas, "--sample", "100%", code=1)
        expect(f"{run}/{name}: " in process.stdout and "1 of 2 logs became" in process.stderr, process.stdout + process.stderr)
        (run / name).write_bytes(rest)
    before = tree_of(atlas)
    fleet("verify", atlas, "--sample", "100%")
    expect(tree_of(atlas) == before, "verify wrote into the atlas")
    expect(sorted(path.name for path in logs.iterdir()) == ["drive-0.log", "drive-1.log"], "the logs")


def fleet_verify_tells_all_it_finds():
    """A log that is gone hides no difference of another one; without one its own code is the end."""
    logs, atlas, _ = atlas_of_two("fleet_verify_tells_all_it_finds")
    record = json.loads((atlas / "units/000/000000.json").read_text())
    os.rename(record["uri"], logs / "kept")
    process = fleet("verify", atlas, "--sample", "100%", code=74)
    expect("drive-0.log: cannot be " in process.stderr.splitlines()[-1] and not process.stdout, process.stdout + process.stderr)
    (run_of(atlas, 1) / "map.pgm").write_bytes(b"P5")
    process = fleet("verify", atlas, "--sample", "100%", code=1)
    expect(f"{run_of(atlas, 1)} was changed since: " in process.stdout, process.stdout)
    expect("1 of 1 logs became something else" in process.stderr and "unit 0 is not done: " in process.stderr, process.stderr)


def fleet_get_leaves_the_input_of_the_caller():
    """Commands of --get read nothing of what a script reads on, and a pipe that breaks ends what writes into it quietly."""
    folder = fresh_folder("fleet_get_leaves_the_input")
    logs = make_logs(folder / "logs", count=1)
    atlas = folder / "atlas"
    planned(atlas, "x://robot/drive-0.log", "--get", f"cat; (yes; echo $? > {folder}/code) | head -n 0; cat {logs}/$(basename {{}})")
    script = '"$0" fleet run "$1" --shard 1 -q; cat'
    done = subprocess.run(["sh", "-c", script, cli.PROGRAM, atlas], input="the rest\n", capture_output=True, text=True, check=False)
    expect((done.returncode, done.stdout, done.stderr) == (0, "the rest\n", ""), str(done))
    expect((folder / "code").read_text() == "141\n", "SIGPIPE is ignored")
    expect(status_of(atlas)["mapped"] == 1, "the log is not mapped")


def tree_of(folder):
    """All that lies there, with the times at which something was written."""
    return {str(path): path.stat().st_mtime_ns for path in [folder, *folder.rglob("*")]}


def fleet_merge_of_a_drive_kept_twice():
    """A drive that lies there plain and packed is joined once, which is told; so is a run that cannot be read, with what to
    do in an atlas."""
    folder = fresh_folder("fleet_merge_of_a_drive_kept_twice")
    lines = LOG.read_text().splitlines(keepends=True)
    logs = folder / "logs"
    logs.mkdir()
    part = 6 * len(lines) // 10
    (logs / "early.log").write_text("".join(lines[:part]))
    (logs / "late.log").write_text("".join(lines[-part:]))
    (logs / "early.log.gz").write_bytes(gzip.compress((logs / "early.log").read_bytes()))
    atlas = folder / "atlas"
    planned(atlas, logs)
    fleet("submit", atlas, "--engine", "local", "-q")
    process = fleet("merge", atlas)
    expect(process.stdout.startswith("2 runs, 1 site\n"), process.stdout)
    line, = [line for line in process.stderr.splitlines() if "left out: " in line]
    expect("is the same drive as" in line and f"{logs}/early.log" in line and f"{logs}/early.log.gz" in line, line)
    late, = [run_of(atlas, unit) for unit in range(3) if "late" in (atlas / f"units/000/{unit:06}.json").read_text()]
    (late / "keyframes.bin.gz").unlink()
    process = fleet("merge", atlas, code=65)
    expect("remove that folder and run its shard again" in process.stderr and "gdtslam map" not in process.stderr, process.stderr)


def with_sbatch(folder, script):
    """The environment in which sbatch is this script."""
    (folder / "bin").mkdir(exist_ok=True)
    (folder / "bin/sbatch").write_text(f"#!/bin/sh\n{script}\n")
    (folder / "bin/sbatch").chmod(0o755)
    return environment(PATH=f"{folder}/bin:{os.environ['PATH']}")


def fleet_job_that_is_refused():
    """Where the cluster takes the array and not the job after it, the line names what runs and what is left to do; and what
    never ends its answer is no job."""
    folder = fresh_folder("fleet_job_that_is_refused")
    atlas = folder / "atlas"
    planned(atlas, make_logs(folder / "logs", count=1))
    half = with_sbatch(folder, 'case "$*" in *gdtslam-finish*) echo "sbatch: error: too many jobs" >&2; exit 1;; esac; echo 4711')
    process = fleet("submit", atlas, "--engine", "slurm", code=1, env=half)
    expect("job 4711 is submitted and runs" in process.stderr and f"gdtslam fleet finish {atlas}" in process.stderr, process.stderr)
    process = fleet("submit", atlas, "--engine", "slurm", code=1, env=with_sbatch(folder, "yes 2>/dev/null"))
    expect("sbatch prints more than the number of a job" in process.stderr, process.stderr)


def fleet_folder_whose_name_slurm_would_change():
    """Each % of a folder is doubled for sbatch, which would put a number there, and a \\ is refused before anything is written."""
    folder = fresh_folder("fleet_folder_whose_name_slurm_would_change")
    logs = make_logs(folder / "logs", count=1)
    env = with_sbatch(folder, f'for word; do echo "$word"; done >> {folder}/calls; echo 12')
    (folder / "50%j").mkdir()
    planned(folder / "50%j/atlas", logs)
    fleet("submit", folder / "50%j/atlas", "--engine", "slurm", env=env)
    said = (folder / "calls").read_text().splitlines()
    for word in ("--output={}/slurm/%A_%a.txt", "--output={}/slurm/finish.txt"):
        expect(word.format(f"{folder}/50%%j/atlas") in said, str(said))
    expect(f"{folder}/50%j/atlas/slurm/run.sh" in said, str(said))
    atlas = folder / "back\\slash"
    planned(atlas, logs)
    for engine in ("slurm", "print"):
        process = fleet("submit", atlas, "--engine", engine, code=2, env=env)
        expect("rename it" in process.stderr and not (atlas / "slurm").exists(), process.stderr)


def fleet_folder_whose_name_has_lines():
    """No line of a folder's name becomes one of a script, and none of it an option for sbatch."""
    folder = fresh_folder("fleet_folder_whose_name_has_lines")
    home = folder / "a\ntouch CAME #\n#SBATCH --exclusive\nSCRIPT\ntouch CAME #"
    atlas = home / "atlas"
    home.mkdir()
    planned(atlas, make_logs(folder / "logs", count=1))
    env = {**with_sbatch(folder, "echo 12"), "SLURM_ARRAY_TASK_ID": "0"}

    def run_in_folder(*words, text=None):
        done = subprocess.run(words, input=text, cwd=folder, env=env, capture_output=True, text=True, check=False)
        expect_exit(done, 0)
        expect(not list(folder.glob("CAME*")), "a line of the name was run")

    fleet("submit", atlas, "--engine", "slurm", env=env)
    script = (atlas / "slurm/run.sh").read_text()
    head = script.splitlines()[:3]
    expect(head[0] == "#!/bin/sh" and head[1].startswith("# ") and not head[2].startswith("#"), script)
    run_in_folder("sh", atlas / "slurm/run.sh")
    run_in_folder("sh", atlas / "slurm/finish.sh")
    expect((atlas / "atlas.json").exists(), "the atlas was not finished")
    shutil.rmtree(atlas / "slurm")
    run_in_folder("sh", "-e", text=fleet("submit", atlas, "--engine", "print", env=env).stdout)
    expect((atlas / "slurm/run.sh").read_text() == script, "another script than that which is submitted")
