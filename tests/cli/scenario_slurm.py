"""`gdtslam fleet` on a real Slurm of two nodes: the same atlas as on one machine, and nothing lost whatever ends in between."""

import gzip
import json
import os
import pathlib
import random
import shutil

import cli_support as cli
from cli_support import LOG, PROGRAM, SOURCE, command, expect, expect_exit, fresh_folder, vulkan_devices
from slurm_cluster import SlurmCluster, require_slurm

PIECES = 6


def drives(folder):
    """Short drives: pieces of the fixture's, and one that is no drive."""
    lines = LOG.read_text().splitlines(keepends=True)
    head = [line for line in lines if line.startswith("PARAM")]
    rest = [line for line in lines if not line.startswith("PARAM")]
    size = len(rest) // (2 * PIECES)
    folder.mkdir(parents=True)
    for piece in range(PIECES):
        begin = len(rest) // 3 + piece * size
        (folder / f"{piece}.log").write_text("".join(head + rest[begin:begin + size]))
    (folder / "broken.log").write_text("".join(head) + "FLASER many 1.0 2.0\n")
    return folder


# To measure the delay of the odometry takes longer than all the rest of a short drive.
SETTINGS = ("--set", "log.odometry_stamps=log")


def planned(atlas, *arguments, settings=SETTINGS):
    expect_exit(command("fleet", "plan", *arguments, "-o", atlas, *settings), 0)
    return atlas


def finished(atlas):
    """atlas.json, which holds what the records say."""
    expect((atlas / "atlas.json").exists(), f"{atlas} was not finished: {texts_of(atlas)}")
    atlas_json = json.loads((atlas / "atlas.json").read_text())
    expect((atlas_json["mapped"], atlas_json["refused"], atlas_json["missing"]) == (PIECES, 1, 0), f"{atlas_json}")
    return atlas_json["atlas_sha256"]


def texts_of(atlas):
    """What the tasks printed."""
    return "\n".join(f"{path.name}: {path.read_text()}" for path in sorted((atlas / "slurm").glob("*.txt")))


def records(atlas):
    return [json.loads(path.read_text()) for path in sorted(atlas.glob("units/*/*.json"))]


def local_atlas(folder, settings=SETTINGS):
    """Drives and the hash of their atlas, made on this machine."""
    logs = drives(folder / "logs")
    atlas = planned(folder / "local", logs, settings=settings)
    expect_exit(command("fleet", "submit", atlas, "--engine", "local"), 0)
    return logs, finished(atlas)


def submitted(slurm, atlas, *arguments):
    process = command("fleet", "submit", atlas, "--engine", "slurm", *arguments, env=slurm.environment)
    expect_exit(process, 0)


def submitted_by_nodes(slurm, atlas, *arguments):
    """As `submit`, but what `--engine print` prints, changed so that nodes may differ: each has its own NODE_COMMAND and
    NODE_OPTIONS (SlurmCluster.set_variables)."""
    process = command("fleet", "submit", atlas, "--engine", "print", *arguments, env=slurm.environment)
    expect_exit(process, 0)
    ours = f"{PROGRAM} fleet run"
    expect(process.stdout.count(ours) == 1 and process.stdout.count("--shard auto") == 1, process.stdout)
    script = atlas.with_suffix(".sh")
    script.write_text(process.stdout.replace(ours, f"${{NODE_COMMAND:-{PROGRAM}}} fleet run")
                      .replace("--shard auto", "--shard auto $NODE_OPTIONS"))
    expect(slurm.run("sh", script) is not None, f"{script} failed")


def slurm_gives_the_same_atlas():
    """Of a job array of several shards, of logs in another order, of nodes of different instruction sets, of one with a
    Vulkan device."""
    require_slurm()
    folder = fresh_folder("slurm_same")
    logs, expected = local_atlas(folder)
    with SlurmCluster() as slurm:
        atlas = planned(folder / "four", logs, "--shards", 4)
        submitted(slurm, atlas)
        slurm.wait_for_jobs()
        expect(finished(atlas) == expected, "another atlas than on one machine")
        hosts = {record["host"] for record in records(atlas)}
        expect(hosts == {"n1", "n2"}, f"computed by {hosts}")

        shuffled = sorted(str(path) for path in logs.iterdir())
        random.Random(1).shuffle(shuffled)
        (folder / "list.txt").write_text("".join(f"{path}\n" for path in shuffled))
        atlas = planned(folder / "instruction_sets", "--list", folder / "list.txt", "--shards", 3)
        best = "avx2" if "avx2" in pathlib.Path("/proc/cpuinfo").read_text() else "baseline"
        slurm.set_variables("n1", NODE_OPTIONS="--isa baseline")
        slurm.set_variables("n2", NODE_OPTIONS=f"--isa {best}")
        submitted_by_nodes(slurm, atlas)
        slurm.wait_for_jobs()
        expect(finished(atlas) == expected, "another atlas by nodes of different instruction sets")
        used = {(record["host"], record["isa"]) for record in records(atlas) if record["exit_code"] == 0}
        expect(used == {("n1", "baseline"), ("n2", best)}, f"computed by {used}")

        devices = vulkan_devices()
        if not devices:
            expect(os.environ.get("GDTSLAM_REQUIRE_VULKAN") != "1", "there is no Vulkan device, and GDTSLAM_REQUIRE_VULKAN=1")
            return
        atlas = planned(folder / "vulkan", logs, "--shards", 2)
        slurm.set_variables("n2", NODE_OPTIONS=f"--device {devices[0]['device']}")
        submitted_by_nodes(slurm, atlas)
        slurm.wait_for_jobs()
        expect(finished(atlas) == expected, "another atlas with a node on Vulkan")
        devices = {record["host"]: record["device"] for record in records(atlas) if record["exit_code"] == 0}
        expect(devices["n1"] == "cpu" and "llvmpipe" in devices["n2"], f"computed on {devices}")


def is_in_a_unit(temporary):
    """Whether a run that works below this folder has begun with a log of its plan."""
    return any(path.name.isdigit() for path in temporary.glob("*/*"))


def slurm_node_and_controller_die():
    """A node that loses its power in the middle of a log, with its jobs; the controller, which comes back: the atlas is that
    of one machine, and the job after the array ran."""
    require_slurm()
    folder = fresh_folder("slurm_dies")
    logs, expected = local_atlas(folder)
    with SlurmCluster() as slurm:
        atlas = planned(folder / "atlas", logs, "--shards", 3)
        for node in ("n1", "n2"):
            (folder / node).mkdir()
            slurm.set_variables(node, TMPDIR=folder / node)
        submitted(slurm, atlas)
        slurm.wait_until("n2 is in the middle of a log", lambda: is_in_a_unit(folder / "n2"), 120)
        slurm.kill_node("n2")
        expect(not (atlas / "atlas.json").exists(), "the atlas was finished before a node died")
        slurm.kill_controller()
        slurm.start_controller()
        slurm.wait_until("slurmctld answers", lambda: slurm.jobs() is not None, 30)
        # What its operators would say, or slurmctld itself after SlurmdTimeout and some rounds of asking.
        slurm.run("scontrol", "update", "NodeName=n2", "State=DOWN", "Reason=power")
        slurm.wait_for_jobs()
        expect(finished(atlas) == expected, "another atlas after a node and the controller died")
        expect(slurm.states()["n2"].startswith("down"), f"{slurm.states()}")


def falsified_program(folder):
    """A program that maps the sample log to something else, as one on a broken machine: it has another sample log."""
    program = cli.installed_copy(folder)
    shutil.copytree(SOURCE / "assets", folder / "share/gdtslam")
    sample = folder / "share/gdtslam/logs/office-start.log.gz"
    lines = gzip.decompress(sample.read_bytes()).splitlines(keepends=True)
    sample.write_bytes(gzip.compress(b"".join(lines[:len(lines) // 2]), mtime=0))
    return program


def slurm_bad_nodes():
    """A node that does not compute what the plan's program does refuses to work, with one line. A node on which the atlas
    cannot be written gives its task back. Once they are gone the same command goes on, and nothing is lost."""
    require_slurm()
    folder = fresh_folder("slurm_bad_nodes")
    logs, expected = local_atlas(folder)
    with SlurmCluster() as slurm:
        atlas = planned(folder / "falsified", logs, "--shards", 2)
        slurm.set_variables("n2", NODE_COMMAND=falsified_program(folder / "other"))
        submitted_by_nodes(slurm, atlas)
        slurm.wait_for_jobs()
        lines = [line for line in texts_of(atlas).splitlines() if "refuses to work" in line]
        expect(len(lines) == 1 and "n2 refuses to work" in lines[0], texts_of(atlas))
        expect(not (atlas / "atlas.json").exists(), "the atlas was finished although a node refused to work")
        slurm.set_variables("n2")
        submitted(slurm, atlas)
        slurm.wait_for_jobs()
        expect(finished(atlas) == expected, "another atlas after a node refused to work")

        if cli.IS_SANITIZED:
            return  # a build with sanitizers, which want to be loaded first
        full = (f"env LD_PRELOAD={os.environ['FAILING_CALLS']} FAILING_KINDS=write,sync FAILING_AT=35 FAILING_HOW=ENOSPC "
                f"FAILING_ON=1 {PROGRAM}")
        atlas = planned(folder / "full", logs, "--shards", 2)
        slurm.set_variables("n2", NODE_COMMAND=full)
        submitted_by_nodes(slurm, atlas, "--max-retries", 5)
        slurm.wait_until("n2 has found the disk full", lambda: "No space left on device" in texts_of(atlas), 120)
        slurm.set_variables("n2")
        slurm.wait_for_jobs()
        expect(finished(atlas) == expected, "another atlas after the disk was full")
