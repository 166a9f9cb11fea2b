"""`gdtslam fleet` by engines other than Slurm, as docs/howto/fleet-elsewhere.md has them: each ends in the atlas of one
machine."""

import os
import pathlib
import re
import shutil
import subprocess
import types

import yaml

import cli_support as cli
from cli_support import SOURCE, command, expect, expect_exit, fresh_folder, skip
from scenario_slurm import finished, local_atlas, planned

SHARDS = 3


def path_with_program(folder):
    """The environment in which gdtslam is found by its name."""
    cli.installed_copy(folder)
    (folder / "share").mkdir()
    (folder / "share/gdtslam").symlink_to(SOURCE / "assets")
    return cli.environment(PATH=f"{folder}/bin:{os.environ['PATH']}")


def fleet_by_gnu_parallel():
    """The line of the page, less the hosts; a second time there is nothing to do."""
    if not shutil.which("parallel"):
        expect(os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") != "1", "there is no GNU parallel, and GDTSLAM_REQUIRE_PROGRAMS=1")
        skip("there is no GNU parallel")
    folder = fresh_folder("fleet_parallel")
    logs, expected = local_atlas(folder)
    atlas = planned(folder / "atlas", logs, "--shards", SHARDS)
    page = (SOURCE / "docs/howto/fleet-elsewhere.md").read_text()
    line, = re.findall(r"seq 50 \| parallel.*\\\n.*", page)
    for old, new in (("seq 50", f"seq {SHARDS}"), ("/50", f"/{SHARDS}"), ("--sshloginfile hosts.txt ", ""),
                     ("run atlas", f"run {atlas}"), ("parallel.log", str(folder / "parallel.log"))):
        expect(old in line, f"{old} is not in the page's line: {line}")
        line = line.replace(old, new)
    environment = {**path_with_program(folder / "program"), "HOME": str(folder)}
    for _ in range(2):
        subprocess.run(["bash", "-c", line], check=True, cwd=folder, env=environment)
        expect(len((folder / "parallel.log").read_text().splitlines()) == 1 + SHARDS, "not every shard was run")
    expect_exit(command("fleet", "finish", atlas), 0)
    expect(finished(atlas) == expected, "another atlas by GNU parallel")


def rules_of(snakefile, config):
    """The rules of a Snakefile as plain as ours: name, its keys, and what the lines above the rules define."""
    head, *parts = re.split(r"^rule (\w+):\n", snakefile, flags=re.MULTILINE)
    names = {"config": config, "touch": lambda path: path,
             "expand": lambda pattern, shard: [pattern.format(shard=k) for k in shard]}
    exec(head, names)
    for name, body in zip(parts[::2], parts[1::2]):
        yield name, {key: eval(f"dict({value})" if key == "resources" else value, names)
                     for key, value in re.findall(r"^    (\w+): (.*)$", body, re.MULTILINE)}, names


def fleet_by_commands_of_the_snakefile():
    """Run one after the other, in the order of the rules: for where there is no Snakemake."""
    folder = fresh_folder("fleet_snakefile")
    logs, expected = local_atlas(folder, settings=())
    atlas = folder / "atlas"
    (folder / "logs.txt").write_text("".join(f"{path}\n" for path in sorted(logs.iterdir())))
    config = {"atlas": str(atlas), "list": str(folder / "logs.txt"), "shards": str(SHARDS)}
    environment = path_with_program(folder / "program")
    for name, rule, names in rules_of((SOURCE / "examples/fleet/Snakefile").read_text(), config):
        if "shell" not in rule:
            continue
        every = range(1, SHARDS + 1) if name == "run" else [None]
        for shard in every:
            text = rule["shell"].format(**{**names, "input": rule["input"], "threads": rule.get("threads", 1),
                                           "wildcards": types.SimpleNamespace(shard=shard)})
            subprocess.run(["bash", "-c", text], check=True, env=environment)
        if name != "run":
            expect(pathlib.Path(rule["output"]).exists(), f"rule {name} made no {rule['output']}")
    expect(finished(atlas) == expected, "another atlas by the commands of the Snakefile")


def fleet_by_snakemake():
    """A dry run, then a real one. Snakemake is too large for the packages of the tests, so nothing requires it."""
    if not shutil.which("snakemake"):
        skip("there is no snakemake; its commands are run by fleet_by_commands_of_the_snakefile")
    folder = fresh_folder("fleet_snakemake")
    logs, expected = local_atlas(folder, settings=())
    (folder / "logs.txt").write_text("".join(f"{path}\n" for path in sorted(logs.iterdir())))
    environment = path_with_program(folder / "program")
    words = ["snakemake", "--snakefile", SOURCE / "examples/fleet/Snakefile", "--cores", "2", "--config",
             f"atlas={folder / 'atlas'}", "list=logs.txt", f"shards={SHARDS}"]
    dry = subprocess.run([*words, "--dry-run"], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    expect(dry.returncode == 0 and re.search(rf"^run +{SHARDS} ", dry.stdout + dry.stderr, re.MULTILINE), dry.stdout + dry.stderr)
    real = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    expect(real.returncode == 0, real.stdout + real.stderr)
    expect(finished(folder / "atlas") == expected, "another atlas by Snakemake")


def fleet_by_containers():
    """What the examples of Kubernetes and AWS Batch run, with the variables that these set."""
    folder = fresh_folder("fleet_containers")
    logs, expected = local_atlas(folder)
    job = yaml.safe_load((SOURCE / "examples/fleet/kubernetes.yaml").read_text())
    arguments = job["spec"]["template"]["spec"]["containers"][0]["args"]
    for variable in ("JOB_COMPLETION_INDEX", "AWS_BATCH_JOB_ARRAY_INDEX"):
        atlas = planned(folder / variable, logs, "--shards", SHARDS)
        for index in range(SHARDS):
            mine = [atlas if word == "/atlas" else word for word in arguments]
            expect_exit(command(*mine, env=cli.environment(**{variable: str(index)})), 0)
        expect_exit(command("fleet", "finish", atlas), 0)
        expect(finished(atlas) == expected, f"another atlas by {variable}")
