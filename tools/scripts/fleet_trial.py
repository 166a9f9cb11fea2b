#!/usr/bin/env python3
"""`gdtslam fleet` over 200 logs on a Slurm of two nodes, held against one machine: `fleet_trial.py PROGRAM -o FOLDER
[--logs N] [--scans N] [--data DIR] [--cases NAME,...] [--set PATH=VALUE]`.

The logs are pieces of simulated drives of two scenes, three lasers and several seeds, and the public logs that DIR has. They
are mapped by a shell loop of `gdtslam map`, by `fleet submit --engine local`, by one node, on Slurm in other numbers of
shards and orders, by nodes of different instruction sets, with a node on lavapipe, and with a node and the controller that
die. Prints a table as Markdown; the exit code is 1 where an atlas differs. FOLDER keeps the logs; some 20 minutes on two
cores. Needs what tools/install-packages.sh test installs."""

import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ("office-loop", "corridor")
LASERS = ("sick-lms", "sick-361", "hokuyo-961")
PUBLIC = ("intel", "fr079", "mit-csail")


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, **options).stdout


def make_logs(program, folder, number, scans):
    """Pieces of so many scans each; what is there is taken again."""
    folder.mkdir(parents=True, exist_ok=True)
    drive, seed = folder / "drive.log", 0
    while len(list(folder.glob("piece-*.log"))) < number:
        seed += 1
        scene, laser = SCENES[seed % len(SCENES)], LASERS[seed % len(LASERS)]
        run(program, "simulate", scene, "-o", drive, "--laser", laser, "--seed", seed, "--quiet")
        head, piece, count = [], [], 0
        with open(drive, encoding="ascii") as lines:
            for line in lines:
                if line.startswith("PARAM"):
                    head.append(line)
                    continue
                piece.append(line)
                count += line.startswith(("FLASER", "ROBOTLASER1"))
                if count < scans:
                    continue
                if len(list(folder.glob("piece-*.log"))) < number:
                    (folder / f"piece-{seed}-{pieces_of(folder, seed)}.log").write_text("".join(head + piece))
                piece, count = [], 0
    for path in folder.glob("drive.*"):
        path.unlink()


def pieces_of(folder, seed):
    return len(list(folder.glob(f"piece-{seed}-*.log")))


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Trial:
    def __init__(self, program, folder, logs, settings):
        self.program, self.folder, self.logs, self.settings = program, folder, logs, settings
        self.rows, self.expected = [], None

    def atlas(self, name, *arguments, order=None):
        folder = self.folder / name
        shutil.rmtree(folder, ignore_errors=True)
        listed = list(self.logs)
        if order is not None:
            random.Random(order).shuffle(listed)
        (self.folder / "list.txt").write_text("".join(f"{log}\n" for log in listed))
        run(self.program, "fleet", "plan", "--list", self.folder / "list.txt", "-o", folder, "--quiet", *arguments,
            *self.settings)
        return folder

    def case(self, what, work):
        """Runs work(), which leaves a finished atlas, and takes its row."""
        before, begin = cpu_s(), time.monotonic()
        atlas = work()
        wall_s, used_s = time.monotonic() - begin, cpu_s() - before
        found = json.loads((atlas / "atlas.json").read_text()) if atlas else None
        if found and self.expected is None:
            self.expected = found["atlas_sha256"]
        is_same = found is None or found["atlas_sha256"] == self.expected
        said = "" if found is None else f"{found['mapped']} mapped, {found['refused']} refused, {found['missing']} missing"
        who = "" if found is None else hosts_of(atlas)
        digest = "" if found is None else found["atlas_sha256"][:12] + ("" if is_same else " **differs**")
        self.rows.append((what, digest, said, who, f"{wall_s:.0f} s", f"{used_s:.0f} s",
                          f"{100.0 * used_s / wall_s / os.cpu_count():.0f} %", is_same))
        print("| " + " | ".join(self.rows[-1][:-1]) + " |", flush=True)


def hosts_of(atlas):
    counts = {}
    for path in atlas.glob("units/*/*.json"):
        record = json.loads(path.read_text())
        key = f"{record['host']} ({record['device'] if record['device'] != 'cpu' else record['isa']})"
        counts[key] = counts.get(key, 0) + 1
    return ", ".join(f"{name}: {count}" for name, count in sorted(counts.items()))


def shell_loop(trial):
    for log in trial.logs:
        out = trial.folder / "loop"
        run(trial.program, "map", log, "-o", out, "--no-copy", "--quiet", *trial.settings)
        shutil.rmtree(out)


def local(trial):
    atlas = trial.atlas("local")
    run(trial.program, "fleet", "submit", atlas, "--engine", "local", "--quiet")
    return atlas


def one_node(trial):
    atlas = trial.atlas("one")
    run(trial.program, "fleet", "run", atlas, "--shard", "1/1", "--quiet")
    run(trial.program, "fleet", "finish", atlas, "--quiet")
    return atlas


def on_slurm(trial, name, shards, order=None, options=None, disturb=None):
    from slurm_cluster import SlurmCluster
    atlas = trial.atlas(name, "--shards", shards, order=order)
    with SlurmCluster() as slurm:
        for node in ("n1", "n2"):
            (atlas / node).mkdir()
            slurm.set_variables(node, TMPDIR=atlas / node, NODE_OPTIONS=(options or {}).get(node, ""))
        script = run(trial.program, "fleet", "submit", atlas, "--engine", "print", "--max-retries", 5)
        path = trial.folder / f"{name}.sh"
        path.write_text(script.replace("--shard auto", "--shard auto $NODE_OPTIONS"))
        run("sh", path, env=slurm.environment)
        if disturb:
            disturb(slurm, atlas)
        slurm.wait_for_jobs(1800)
    for node in ("n1", "n2"):
        shutil.rmtree(atlas / node)
    return atlas


def power_cut(slurm, atlas):
    """n2 dies in the middle of a log, and nobody tells slurmctld, which is killed itself and comes back."""
    slurm.wait_until("n2 maps a log", lambda: any(path.name.isdigit() for path in (atlas / "n2").glob("*/*")), 60)
    slurm.kill_node("n2")
    slurm.kill_controller()
    slurm.start_controller()
    slurm.wait_until("slurmctld answers", lambda: slurm.jobs() is not None, 30)


def cases_of(shards):
    return {
        "loop": ("shell loop of `gdtslam map`", shell_loop),
        "local": ("`submit --engine local`", local),
        "one": ("one node, `run --shard 1/1`", one_node),
        "slurm": (f"Slurm, {shards} shards", lambda trial: on_slurm(trial, "slurm", shards)),
        "shuffled": (f"Slurm, {shards // 3} shards, shuffled list", lambda trial: on_slurm(trial, "shuffled", shards // 3, 1)),
        "isa": ("Slurm, n1 with baseline, n2 with avx2", lambda trial: on_slurm(
            trial, "isa", shards, options={"n1": "--isa baseline", "n2": "--isa avx2"})),
        "vulkan": ("Slurm, n2 on lavapipe", lambda trial: on_slurm(
            trial, "vulkan", shards, options={"n2": "--device vulkan:0"})),
        "dies": ("Slurm, n2 and slurmctld killed", lambda trial: on_slurm(trial, "dies", shards, disturb=power_cut)),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--logs", type=int, default=200)
    parser.add_argument("--scans", type=int, default=300, help="of a simulated log")
    parser.add_argument("--shards", type=int, default=20)
    parser.add_argument("--data", type=pathlib.Path, help="folder of the public logs")
    parser.add_argument("--cases", help="names with commas: " + ", ".join(cases_of(20)))
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="of every map")
    options = parser.parse_args()
    program, folder = options.program.resolve(), options.output.resolve()
    public = [options.data.resolve() / f"{name}.clf.gz" for name in PUBLIC] if options.data else []
    make_logs(program, folder / "logs", options.logs - len(public), options.scans)
    # The cluster is that of the tests, which find the program by variables.
    os.environ.update(GDTSLAM=str(program), GDTSLAM_SOURCE=str(ROOT), GDTSLAM_CLI_WORK=str(folder), GDTSLAM_CLI_LOG=str(folder))
    sys.path.insert(0, str(ROOT / "tests/cli"))
    trial = Trial(program, folder, [*sorted((folder / "logs").glob("piece-*.log"))[:options.logs - len(public)], *public],
                  [word for one in options.set for word in ("--set", one)])
    print("| | atlas | logs | by | time | CPU time | busy |\n|---|---|---|---|---|---|---|", flush=True)
    cases = cases_of(options.shards)
    for name in options.cases.split(",") if options.cases else cases:
        what, work = cases[name]
        trial.case(what, lambda work=work: work(trial))
    sys.exit(0 if all(row[-1] for row in trial.rows) else 1)


if __name__ == "__main__":
    main()
