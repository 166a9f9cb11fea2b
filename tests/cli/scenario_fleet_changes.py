"""Many logs by a plan, while somebody changes what it works on: the logs, the atlas, the records."""

import fcntl
import hashlib
import json
import os
import shutil
import socket
import subprocess

import cli_support as cli
from cli_support import LOG, PROGRAM, command, environment, expect, expect_exit, fresh_folder, one_error_line
from scenario_fleet import QUICK, finished, fleet, make_logs, planned, status_of, wait_for


def begun(folder, atlas):
    """`fleet run` of the one shard, a log at a time, working in folder/tmp."""
    (folder / "tmp").mkdir(exist_ok=True)
    return subprocess.Popen([PROGRAM, "fleet", "run", atlas, "--shard", "1", "-j", "1"], text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, env=environment(TMPDIR=str(folder / "tmp"), SLURM_TMPDIR=None))


def record_of(atlas, unit):
    return json.loads((atlas / f"units/000/{unit:06}.json").read_text())


def fleet_log_that_grows():
    """A log that grows while it is mapped is mapped again: no run has the name of other bytes than it was made of."""
    folder = fresh_folder("fleet_log_that_grows")
    log, whole = folder / "a.log", LOG.read_text().splitlines(keepends=True)
    log.write_text("".join(whole[:len(whole) // 2]))
    atlas = folder / "atlas"
    planned(atlas, log)
    process = begun(folder, atlas)
    # Mapping begins with the folder of the run, after the log was hashed.
    wait_for(lambda: list((folder / "tmp").glob("gdtslam-fleet-*/0/run")), "nothing is mapped")
    with open(log, "a") as file:
        file.write("".join(whole[len(whole) // 2:]))
    _, text = process.communicate(timeout=100 * cli.SLOWNESS)
    expect(process.returncode == 0, f"exit {process.returncode}: {text}")
    expect(f"is tried again: {log}: was changed while it was mapped; run the command again\n" in text, text)
    record = record_of(atlas, 0)
    expect(record["input_sha256"] == hashlib.sha256(log.read_bytes()).hexdigest(), "the hash is not that of the log")
    expect_exit(command("map", log, "-o", folder / "alone", "--no-copy", "-q", *QUICK), 0)
    run, = (atlas / "runs").glob("*/*")
    expect(run.name == record["run"], "a run that no record names")
    expect((run / "map.pgm").read_bytes() == (folder / "alone/map.pgm").read_bytes(), "the map is that of other bytes")


def fleet_atlas_that_is_moved():
    """Moved, removed or replaced while logs are mapped: 74, one line, nothing in its place, and what was moved is whole."""
    folder = fresh_folder("fleet_atlas_that_is_moved")
    logs = make_logs(folder / "logs", count=4)
    atlas, moved = folder / "atlas", folder / "moved"
    for how in ("moved", "removed", "replaced"):
        planned(atlas, logs)
        process = begun(folder, atlas)
        wait_for(lambda: list((atlas / "units").rglob("0*.json")), "no log was done")
        atlas.rename(moved)
        if how == "replaced":
            planned(atlas, *sorted(logs.iterdir())[:2])
        if how == "removed":
            shutil.rmtree(moved)
        _, text = process.communicate(timeout=100 * cli.SLOWNESS)
        expect(process.returncode == 74, f"{how}: exit {process.returncode}: {text}")
        one_error_line(text)
        expect(f"{atlas}: is no longer the folder that the plan was read from" in text, text)
        if how == "replaced":
            expect([path.name for path in atlas.iterdir()] == ["plan.json"], "it was written into the new atlas")
            shutil.rmtree(atlas)
        expect(not atlas.exists(), f"{how}: {list(atlas.rglob('*'))}")
        if how == "removed":
            expect(not moved.exists(), "what was removed came back")
            continue
        done = status_of(moved)["mapped"]
        expect(0 < done < 4, f"{done} of 4 logs were done when it was moved")
        fleet("run", moved, "--shard", "1", "-q")
        expect(finished(moved)["missing"] == 0 and not list((moved / "staging").iterdir()), "the moved atlas is not whole")
        shutil.rmtree(moved)


def fleet_finish_alone():
    """While one process finishes an atlas a second one says so and writes nothing; afterwards it does."""
    folder = fresh_folder("fleet_finish_alone")
    atlas = folder / "atlas"
    planned(atlas, make_logs(folder / "logs", count=1))
    locked = os.open(atlas, os.O_RDONLY)
    fcntl.flock(locked, fcntl.LOCK_EX)
    process = fleet("finish", atlas, "--partial", code=2)
    one_error_line(process.stderr)
    expect(f"another process is writing to '{atlas}'" in process.stderr, process.stderr)
    expect([path.name for path in atlas.iterdir()] == ["plan.json"], "it wrote nevertheless")
    os.close(locked)
    fleet("finish", atlas, "--partial")
    expect((atlas / "atlas.json").exists(), "no atlas.json")


def fleet_with_pipes_in_its_places():
    """A pipe, which nobody reads, where a file of the atlas is to be: one line that names it, and no waiting."""
    folder = fresh_folder("fleet_pipes")
    atlas = folder / "atlas"
    planned(atlas, make_logs(folder / "logs", count=1))
    (atlas / "nodes").mkdir()
    places = {atlas / "nodes" / f"{socket.gethostname()}.json": ("run", atlas, "--shard", "1", "-q"),
              **{atlas / name: ("finish", atlas, "-q") for name in ("summary.csv", "atlas.json", "index.html")}}
    for place, arguments in places.items():
        place.unlink(missing_ok=True)
        os.mkfifo(place)
        process = fleet(*arguments, code=74)
        one_error_line(process.stderr)
        expect(f"{place}: is no plain file" in process.stderr, process.stderr)
        place.unlink()
        fleet(*arguments)
