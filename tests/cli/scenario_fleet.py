"""Many logs by a plan, shards and records: the same hash whoever computes what, and what is killed is done again."""

import gzip
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time

import cli_support as cli
from cli_support import LOG, MODULES, PROGRAM, SOURCE, command, environment, expect, expect_exit, fresh_folder, one_error_line
from content_policy import faults_of

# Finding out how late odometry is stamped takes most of the time that a short log takes.
QUICK = ("--set", "log.odometry_stamps=log")


def make_logs(folder, count=5, bad=0):
    """Pieces of the simulated drive, and logs that cannot be mapped."""
    lines = LOG.read_text().splitlines(keepends=True)
    folder.mkdir(parents=True)
    piece = len(lines) // (count + 1)
    for k in range(count):
        (folder / f"drive-{k}.log").write_text("".join(lines[k * piece:(k + 1) * piece + 20 * k]))
    for k in range(bad):
        (folder / f"bad-{k}.log").write_text("# no scan\n" * (k + 1) + "FLASER 2 1.0 wall\n" * (k % 2))
    return folder


def planned(atlas, *logs, **options):
    process = command("fleet", "plan", *logs, "-o", atlas, *QUICK, **options)
    expect_exit(process, 0)
    return json.loads((atlas / "plan.json").read_text())


def fleet(*arguments, code=0, **options):
    process = command("fleet", *arguments, **options)
    expect_exit(process, code)
    if code not in (0, 130):
        expect(process.stderr.splitlines()[-1].startswith("gdtslam: error: "), process.stderr)
    return process


def finished(atlas):
    return json.loads(fleet("finish", atlas, "--json").stdout)


def status_of(atlas):
    return json.loads(fleet("status", atlas, "--json").stdout)


def done_alone(folder, logs, name="reference"):
    """The hash of an atlas that one command made."""
    planned(folder / name, logs)
    fleet("submit", folder / name, "--engine", "local", "-q")
    return finished(folder / name)["atlas_sha256"]


def fleet_local():
    """One command: maps as `map` makes them, a hash that can be computed by hand, one page; a second time nothing is done."""
    folder = fresh_folder("fleet_local")
    logs = make_logs(folder / "logs", bad=2)
    atlas = folder / "atlas"
    planned(atlas, logs)
    before = (atlas / "plan.json").read_bytes()
    process = fleet("submit", atlas, "--engine", "local", "--max-failed", 2)
    expect("7 logs: 5 mapped, 2 refused\n" in process.stdout, process.stdout)
    expect("bad-0.log is refused: " in process.stderr, process.stderr)
    report = finished(atlas)
    cli.validate(json.dumps(report), "fleet_atlas")
    cli.validate(json.dumps(status_of(atlas)), "fleet_status")
    lines = []
    for path in sorted((atlas / "units").rglob("*.json")):
        cli.validate(path.read_text(), "fleet_record")
        record = json.loads(path.read_text())
        log = pathlib.Path(record["uri"])
        expect(record["input_sha256"] == hashlib.sha256(log.read_bytes()).hexdigest(), f"{log}: another hash")
        lines.append(f"{record['run']} {record['input_sha256']} {record['outcome']} {record['result_sha256']}\n")
        if record["outcome"] == "refused":
            alone = command("map", log, "-o", folder / "alone", *QUICK)
            said = re.sub("^line ", f"{log}:", record["reason"])
            expect(alone.returncode == record["exit_code"] and said in alone.stderr, f"{said} is not {alone.stderr}")
            continue
        run = atlas / "runs" / record["run"][:2] / record["run"]
        expect_exit(command("map", log, "-o", folder / log.stem, "--no-copy", "-q", *QUICK), 0)
        alone, here = cli.digests(folder / log.stem), cli.digests(run)
        for found in (alone, here):
            del found["report.json"]
        del here["thumbnail.png" if "thumbnail.png" in here else "thumbnail.svg"]
        expect(alone == here, f"{log}: another run than by map")
    expect(report["atlas_sha256"] == hashlib.sha256("".join(sorted(lines)).encode()).hexdigest(), "another hash")
    page = (atlas / "index.html").read_text()
    faults = faults_of(page)
    expect(not faults, f"the page's policy: {faults}")
    expect("drive-3.log" in page and "bad-0.log" in page and report["atlas_sha256"] in page, "the page lacks a log")
    expect(len((atlas / "summary.csv").read_text().splitlines()) == 8, "summary.csv")
    process = fleet("submit", atlas, "--engine", "local", "--max-failed", 2)
    expect("7 were done already" in process.stdout and (atlas / "plan.json").read_bytes() == before, process.stdout)
    expect(not list((atlas / "staging").iterdir()), "something is left in staging")


def fleet_shards():
    """The same hash for any number and order of shards, at the same time or not, from a shuffled list, and baseline."""
    folder = fresh_folder("fleet_shards")
    logs = make_logs(folder / "logs")
    reference = done_alone(folder, logs)
    planned(folder / "three", logs, "--shards", 3)
    # Work on another disk than the atlas is copied.
    memory = pathlib.Path("/dev/shm")
    other = str(memory) if memory.is_dir() and memory.stat().st_dev != folder.stat().st_dev else str(folder)
    for shard in ("3", "1/3", "2/3"):
        fleet("run", folder / "three", "--shard", shard, "-q", env=environment(TMPDIR=other, SLURM_TMPDIR=None))
    expect(not list((folder / "three/staging").iterdir()), "something is left in staging")
    names = sorted((str(path) for path in logs.iterdir()), key=lambda name: hashlib.sha256(name.encode()).digest())
    plan = planned(folder / "list", "--list", "-", "--shards", 2, input="\n".join(names))
    expect([unit[0] for unit in plan["units"]] == sorted(names), "units are not by URI")
    both = [subprocess.Popen([PROGRAM, "fleet", "run", folder / "list", "--shard", shard, "-q", "-j", "1"],
                             env=environment(TMPDIR=str(folder))) for shard in ("1", "1", "2")]
    for process in both:
        expect(process.wait(timeout=300 * cli.SLOWNESS) == 0, "a shard that is run twice")
    planned(folder / "auto", logs, "--shards", 5)
    for task in range(2):
        fleet("run", folder / "auto", "--shard", "auto", "--isa", "baseline",
              env=environment(SLURM_ARRAY_TASK_ID=str(task), SLURM_ARRAY_TASK_COUNT="2"))
    for name in ("three", "list", "auto"):
        expect(finished(folder / name)["atlas_sha256"] == reference, f"{name}: another hash")
    isas = {json.loads(path.read_text())["isa"] for path in (folder / "auto/units").rglob("*.json")}
    expect(isas == {"baseline"}, str(isas))
    process = fleet("verify", folder / "auto", "--sample", "100%")
    expect(process.stdout.startswith("5 logs computed again"), process.stdout)


def fleet_on_vulkan():
    """The same hash on a Vulkan device."""
    cli.require_vulkan()
    folder = fresh_folder("fleet_on_vulkan")
    logs = make_logs(folder / "logs", count=2)
    reference = done_alone(folder, logs)
    planned(folder / "vulkan", logs)
    fleet("submit", folder / "vulkan", "--engine", "local", "-q", "--device", "vulkan")
    expect(finished(folder / "vulkan")["atlas_sha256"] == reference, "another hash")


def fleet_failures():
    """Bad logs are recorded and stop nothing; what the machine is to blame for leaves no record; verify finds changes."""
    folder = fresh_folder("fleet_failures")
    logs = make_logs(folder / "logs", count=3, bad=2)
    atlas = folder / "atlas"
    planned(atlas, logs)
    process = fleet("finish", atlas, code=65)
    expect("5 of 5 logs are not done" in process.stderr, process.stderr)
    process = fleet("run", atlas, "--shard", "1", "--max-failed", "1", code=65)
    expect("2 of 5 logs were refused, and --max-failed allows 1" in process.stderr, process.stderr)
    expect((status_of(atlas)["mapped"], status_of(atlas)["refused"]) == (3, 2), str(status_of(atlas)))
    fleet("run", atlas, "--shard", "1", "--max-failed", "40%")
    # A log that this node does not see.
    gone = folder / "gone"
    planned(gone, logs)
    (logs / "drive-1.log").rename(folder / "kept.log")
    process = fleet("run", gone, "--shard", "1", code=74)
    expect("is not done and is tried again" in process.stderr and "the same command goes on" in process.stderr, process.stderr)
    report = json.loads(fleet("finish", gone, "--partial", "--json").stdout)
    expect(report["atlas_sha256"] is None and report["missing"] == 1, str(report))
    (folder / "kept.log").rename(logs / "drive-1.log")
    fleet("run", gone, "--shard", "1", "--max-failed", "2")
    expect(finished(gone)["atlas_sha256"] == finished(atlas)["atlas_sha256"], "another hash")
    # A disk that lies.
    record = json.loads((gone / "units/000/000003.json").read_text())
    with open(gone / "runs" / record["run"][:2] / record["run"] / "trajectory.tum", "a") as file:
        file.write("1 0 0 0 0 0 0 1\n")
    process = fleet("verify", gone, "--sample", "5", code=1)
    expect(record["run"] in process.stdout and "was changed since" in process.stdout and "report.json tells of" in process.stdout,
           process.stdout)


def falsified_copy(folder):
    """A copy of the program whose sample log is not that of the plan."""
    program = cli.installed_copy(folder)
    share = folder / "share/gdtslam"
    shutil.copytree(SOURCE / "assets", share)
    lines = gzip.decompress((share / "logs/office-start.log.gz").read_bytes()).splitlines(keepends=True)
    (share / "logs/office-start.log.gz").write_bytes(gzip.compress(b"".join(lines[:-20])))
    return program


def fleet_untrusted_node():
    """A node on which the sample log becomes something else refuses to work, and says so in one line."""
    folder = fresh_folder("fleet_untrusted_node")
    atlas = folder / "atlas"
    planned(atlas, make_logs(folder / "logs", count=1))
    program = falsified_copy(folder / "copy")
    process = subprocess.run([program, "fleet", "run", atlas, "--shard", "1"], capture_output=True, text=True, check=False)
    expect_exit(process, 70)
    one_error_line(process.stderr)
    expect("refuses to work: the sample log becomes map" in process.stderr, process.stderr)
    expect(status_of(atlas)["missing"] == 1, "it worked nevertheless")
    node, = (atlas / "nodes").iterdir()
    expect(json.loads(node.read_text())["agrees"] is False, node.read_text())
    fleet("run", atlas, "--shard", "1")


def wait_for(what, message):
    end = time.monotonic() + 60 * cli.SLOWNESS
    while not what():
        expect(time.monotonic() < end, message)
        time.sleep(0.01)


def fleet_resume():
    """Killed, terminated and cut off in the middle: nothing counts that is not whole, and the end is the same."""
    folder = fresh_folder("fleet_resume")
    logs = make_logs(folder / "logs")
    reference = done_alone(folder, logs)
    atlas = folder / "atlas"
    planned(atlas, logs)
    work = folder / "tmp"
    work.mkdir()

    def started():
        process = subprocess.Popen([PROGRAM, "fleet", "submit", atlas, "--engine", "local", "-j", "2"],
                                   stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                                   env=environment(TMPDIR=str(work), SLURM_TMPDIR=None))
        return process

    done = 0
    for sign, code in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGTERM, 130)):
        process = started()
        wait_for(lambda: len(list((atlas / "units").rglob("0*.json"))) > done, "no log was done")
        process.send_signal(sign)
        _, text = process.communicate(timeout=60 * cli.SLOWNESS)
        expect(process.returncode == code, f"exit {process.returncode}: {text}")
        if sign == signal.SIGTERM:
            expect(text.splitlines()[-1] == "gdtslam: error: interrupted", text)
            expect(not list(work.iterdir()), "an interrupted run left its work folder")
        status = status_of(atlas)
        done = status["mapped"]
        expect(0 < done, "nothing is done")
        expect(not status["damaged"], str(status))
        for path in (atlas / "runs").glob("*/*"):
            expect((path / "report.json").exists(), f"{path} is no whole run")
        if done == 5:
            break
    # Torn by a disk that failed, and a run that lacks its record.
    records = sorted((atlas / "units").rglob("0*.json"))
    records[0].write_bytes(records[0].read_bytes()[:40])
    expect(len(status_of(atlas)["damaged"]) <= 1, "more than one record is damaged")
    shutil.rmtree(atlas / "shards", ignore_errors=True)
    expect(len(status_of(atlas)["damaged"]) == 1, "a torn record is not told")
    process = started()
    _, text = process.communicate(timeout=300 * cli.SLOWNESS)
    expect(process.returncode == 0 and "is no JSON text" in text, text)
    expect(finished(atlas)["atlas_sha256"] == reference, "another hash")
    expect(not list(work.iterdir()), "work folders are left")
    # What the last process left before it was killed goes although there is no log left to map.
    left = [parent / "gdtslam-fleet-1-aBcD12" for parent in (work, atlas / "staging")]
    for path in left:
        (path / "sample").mkdir(parents=True)
        (path / ".gdtslam-fleet").touch()
        (path / "sample/gdt.yaml").touch()
    notes = work / "gdtslam-fleet-notes"
    notes.mkdir()
    fleet("run", atlas, "--shard", "1", "-q", env=environment(TMPDIR=str(work), SLURM_TMPDIR=None))
    expect(not any(path.exists() for path in left) and notes.is_dir(), "work of a killed process stays, or a stranger's goes")


def fleet_of_fetched_logs():
    """Logs that a command prints have the hash of files; one that cannot be had is tried again and left undone."""
    folder = fresh_folder("fleet_of_fetched_logs")
    logs = make_logs(folder / "logs", count=2)
    reference = done_alone(folder, logs)
    atlas = folder / "atlas"
    listed = "".join(f"s3://bucket/{path.name}\t{path.stat().st_size}\n" for path in logs.iterdir())
    get = f"name={{}}; cat {logs}/$(basename $name)"
    planned(atlas, "--list", "-", "--get", get, input=listed)
    fleet("submit", atlas, "--engine", "local", "-q")
    expect(finished(atlas)["atlas_sha256"] == reference, "another hash")
    planned(folder / "failing", "s3://bucket/a.log", "--get", "echo x; false {}")
    process = fleet("run", folder / "failing", "--shard", "1", code=74)
    expect("ended with code 1" in process.stderr, process.stderr)
    expect(status_of(folder / "failing")["missing"] == 1, "a cut log counts")


def fleet_bad_input():
    """One line each, with the right code; nothing is written."""
    folder = fresh_folder("fleet_bad_input")
    logs = make_logs(folder / "logs", count=1, bad=0)
    atlas = folder / "atlas"
    (folder / "none").mkdir()
    (folder / "list.txt").write_text("s3://a/b.log\tmany\n")
    for arguments, code, words in ((("plan", "-o", atlas), 2, "name logs, folders of logs"),
                                   (("plan", folder / "absent.log", "-o", atlas), 74, "absent.log"),
                                   (("plan", folder / "none", "-o", atlas), 65, "named as a log"),
                                   (("plan", "s3://a/b.log", "-o", atlas), 2, "--get"),
                                   (("plan", "--list", folder / "list.txt", "-o", atlas), 65, "list.txt:1:"),
                                   (("plan", logs, "-o", atlas, "--shards", 1001), 2, "more than 1000"),
                                   (("plan", logs, "-o", atlas, "--topic", "/sc\udce4n"), 2, "is UTF-8, and its reading is not"),
                                   (("plan", logs, "-o", atlas, "--set", "map.resolutoin=1 m"), 78, "map.resolution"),
                                   (("run", atlas, "--shard", "1"), 74, "gdtslam fleet plan"),
                                   (("status", atlas), 74, "plan.json")):
        process = command("fleet", *arguments)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
        expect(not atlas.exists(), "something was written")
    (folder / "site").mkdir()
    (folder / "site/index.html").write_text("somebody's")
    process = command("fleet", "plan", logs, "-o", folder / "site")
    expect_exit(process, 2)
    expect("index.html, which an atlas would replace" in process.stderr, process.stderr)
    expect(os.listdir(folder / "site") == ["index.html"], "something was written")
    planned(atlas, logs)
    clean = environment(SLURM_ARRAY_TASK_ID=None, AWS_BATCH_JOB_ARRAY_INDEX=None, JOB_COMPLETION_INDEX=None)
    for arguments, code, words in ((("plan", logs, "-o", atlas, "--set", "map.resolution=10 cm"), 2, "has another plan"),
                                   (("run", atlas, "--shard", "2"), 2, "the plan has 1 shards"),
                                   (("run", atlas, "--shard", "0/1"), 2, "shards are 1 to N"),
                                   (("run", atlas, "--shard", "auto"), 2, "no scheduler says"),
                                   (("run", atlas, "--shard", "1", "--max-failed", "lots"), 2, "--max-failed"),
                                   (("run", atlas, "--shard", "1", "--isa", "sse9"), 2, "--isa"),
                                   (("submit", atlas, "--engine", "slurmm"), 2, "did you mean 'slurm'"),
                                   (("submit", atlas, "--engine", "slurm"), 69, "there is no sbatch here"),
                                   *((("submit", atlas, "--engine", "local", *option), 2, f"{option[0]}: is for Slurm") for option in
                                     (("--partition", "cpu"), ("--mem", "4G"), ("--time", "1:00"), ("--array-limit", "64"),
                                      ("--max-retries", "1"))),
                                   (("verify", atlas), 65, "no log is done"),
                                   (("verify", atlas, "--sample", "0"), 2, "--sample: no log would be computed"),
                                   (("verify", atlas, "--sample", "0%"), 2, "--sample: no log would be computed")):
        process = command("fleet", *arguments, env={**clean, "PATH": str(folder)} if "slurm" in arguments else clean)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
    (atlas / "plan.json").write_text((atlas / "plan.json").read_text()[:-20])
    process = command("fleet", "status", atlas)
    expect_exit(process, 65)
    one_error_line(process.stderr)
    printed = command("fleet", "submit", folder / "none", "--engine", "print")
    expect_exit(printed, 74)


def fleet_prints_jobs():
    """The script that would be submitted is one that a shell takes, with names that a shell could mistake."""
    folder = fresh_folder("fleet_prints_jobs")
    atlas = folder / "an atlas; of 'ours'"
    planned(atlas, make_logs(folder / "logs"), "--shards", 3)
    process = fleet("submit", atlas, "--engine", "print", "--partition", "cpu", "--mem", "4G", "-j", "4", "--array-limit", "2",
                    "--isa", "baseline")
    calls = folder / "calls"
    (folder / "bin").mkdir()
    (folder / "bin/sbatch").write_text(f'#!/bin/sh\nfor word; do printf "%s\\n" "$word"; done >> {calls}\necho "17;cluster"\n')
    (folder / "bin/sbatch").chmod(0o755)
    path = environment(PATH=f"{folder}/bin:{os.environ['PATH']}")
    script = subprocess.run(["sh", "-e"], input=process.stdout, text=True, capture_output=True, check=False, env=path)
    expect_exit(script, 0)
    said = calls.read_text().splitlines()
    for word in ("--array=0-2%2", "--requeue", "--partition=cpu", "--mem=4G", "--cpus-per-task=4", f"{atlas}/slurm/run.sh",
                 f"{atlas}/slurm/finish.sh"):
        expect(word in said, f"{word} is not in {said}")
    expect(any(word.startswith("--dependency=afterok:17") for word in said), str(said))
    calls.unlink()
    process = fleet("submit", atlas, "--engine", "slurm", env=path)
    expect("job 17: 3 tasks" in process.stdout, process.stdout)
    expect("--array=0-2%64" in calls.read_text(), calls.read_text())
    task = subprocess.run(["sh", atlas / "slurm/run.sh"], capture_output=True, text=True, check=False,
                          env=environment(SLURM_ARRAY_TASK_ID="2", SLURM_ARRAY_TASK_COUNT="3", SLURM_ARRAY_TASK_MIN="0"))
    expect_exit(task, 0)
    expect("shard 3 of 3" in task.stdout, task.stdout)


def fleet_merge():
    """Maps of an atlas that overlap are one site; what cannot be joined is told and left out; the page leads there."""
    folder = fresh_folder("fleet_merge")
    lines = LOG.read_text().splitlines(keepends=True)
    (folder / "logs").mkdir()
    part = 6 * len(lines) // 10
    (folder / "logs/early.log").write_text("".join(lines[:part]))
    (folder / "logs/late.log").write_text("".join(lines[-part:]))
    (folder / "logs/bad.log").write_text("# no scan\n")
    atlas = folder / "atlas"
    planned(atlas, folder / "logs")
    fleet("submit", atlas, "--engine", "local", "-q", "--max-failed", 1)
    process = fleet("merge", atlas)
    expect(process.stdout.startswith("2 runs, 1 site\n"), process.stdout)
    merged = json.loads((atlas / "site/merge.json").read_text())
    cli.validate((atlas / "site/merge.json").read_text(), "merge")
    expect(len(merged["sites"]) == 1 and len(merged["sites"][0]["runs"]) == 2, json.dumps(merged["sites"]))
    expect((atlas / "site/1/map.pgm").stat().st_size > 0, "no map")
    fleet("finish", atlas, "-q")
    expect("site/merge.json" in (atlas / "index.html").read_text(), "the page does not lead to the site")
    run, = [path for path in atlas.glob("runs/*/*") if (path / "keyframes.bin.gz").exists()][:1]
    (run / "keyframes.bin.gz").unlink()
    process = fleet("merge", atlas, code=65)
    expect("left out: " in process.stderr and "one of its runs can be joined" in process.stderr, process.stderr)
