"""`gdtslam fleet` by what starts commands on several machines, as docs/howto/fleet.md and examples/fleet have them: Slurm of two
nodes, GNU parallel, Snakemake and Kubernetes each end in the atlas of one machine."""

import os
import re
import shutil
import subprocess
import types

import yaml

import cli_support as cli
from cli_support import SOURCE, expect, fresh_folder, skip
from scenario_fleet import finished, make_logs
from slurm_cluster import SlurmCluster, require_slurm

SHARDS = 3
EXAMPLES = SOURCE / "examples/fleet"


def begun(name):
    """A folder, logs in it, and the environment in which gdtslam is found by its name."""
    folder = fresh_folder(name)
    cli.installed_copy(folder / "program")
    (folder / "program/share").mkdir()
    (folder / "program/share/gdtslam").symlink_to(SOURCE / "assets")
    environment = cli.environment(PATH=f"{folder}/program/bin:{os.environ['PATH']}", HOME=str(folder))
    return folder, make_logs(folder / "logs"), environment


def expect_same(folder, logs, environment):
    """folder/atlas was finished, with the hash of one machine's."""
    subprocess.run(["gdtslam", "fleet", "run", logs, "-o", folder / "alone", "-q"], check=True, env=environment)
    expect((folder / "atlas/index.html").exists(), "the atlas was not finished")
    expect(finished(folder / "atlas")[0]["atlas_sha256"] == finished(folder / "alone")[0]["atlas_sha256"], "another atlas")


def fleet_by_slurm():
    """The job array of the example, and a job after it; a second array finds all logs done."""
    require_slurm()
    folder, logs, environment = begun("fleet_by_slurm")
    atlas = folder / "atlas"
    with SlurmCluster() as slurm:
        environment = {**environment, **{name: value for name, value in slurm.environment.items() if name.startswith("SLURM")}}

        def submit(*words):
            words = ["sbatch", "--parsable", f"--chdir={folder}", *map(str, words)]
            done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
            expect(done.returncode == 0, done.stderr)
            return done.stdout.strip()

        array = (f"--array=1-{SHARDS}", "--cpus-per-task=1", EXAMPLES / "slurm.sh", logs, atlas)
        first = submit(*array)
        submit(f"--dependency=afterany:{first}", f"--wrap=gdtslam fleet finish {atlas}")
        slurm.wait_for_jobs()
        second = submit(*array)
        slurm.wait_for_jobs()
        for job, words in ((first, "0 skipped"), (second, "0 mapped")):
            texts = [path.read_text() for path in sorted(folder.glob(f"fleet-{job}_*.txt"))]
            expect(len(texts) == SHARDS and all(words in text for text in texts), str(texts))
    expect_same(folder, logs, environment)


def fleet_by_gnu_parallel():
    """The line of the page, less the hosts."""
    if not shutil.which("parallel"):
        expect(os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") != "1", "there is no GNU parallel, and GDTSLAM_REQUIRE_PROGRAMS=1")
        skip("there is no GNU parallel")
    folder, logs, environment = begun("fleet_by_gnu_parallel")
    line, = re.findall(r"seq 20 \| parallel.*\\\n.*", (SOURCE / "docs/howto/fleet.md").read_text())
    for old, new in (("seq 20", f"seq {SHARDS}"), ("/20", f"/{SHARDS}"), ("--sshloginfile hosts.txt ", ""), ("/data/logs", str(logs))):
        expect(old in line, f"{old} is not in the page's line: {line}")
        line = line.replace(old, new)
    subprocess.run(["bash", "-c", f"{line}\ngdtslam fleet finish atlas"], check=True, cwd=folder, env=environment)
    expect_same(folder, logs, environment)


def fleet_by_kubernetes():
    """The command of the example, with the variable that an indexed job sets."""
    folder, logs, environment = begun("fleet_by_kubernetes")
    job = yaml.safe_load((EXAMPLES / "kubernetes.yaml").read_text())["spec"]
    container, = job["template"]["spec"]["containers"]
    expect(job["completionMode"] == "Indexed" and f'/{job["completions"]}"' in container["command"][2], f"{job}")
    words = container["command"][2].replace(f"/{job['completions']}\"", f"/{SHARDS}\"")
    words = words.replace(" /logs", f" {logs}").replace(" /atlas", f" {folder}/atlas")
    for index in range(SHARDS):
        subprocess.run(["sh", "-c", words], check=True, env={**environment, "JOB_COMPLETION_INDEX": str(index)})
    subprocess.run(["gdtslam", "fleet", "finish", folder / "atlas"], check=True, env=environment)
    expect_same(folder, logs, environment)


def rules_of(snakefile, config):
    """The rules of a Snakefile as plain as ours: name, its keys, and what the lines above the rules define."""
    head, *parts = re.split(r"^rule (\w+):\n", snakefile, flags=re.MULTILINE)
    names = {"config": config, "touch": lambda path: path,
             "expand": lambda pattern, shard: [pattern.format(shard=k) for k in shard]}
    exec(head, names)
    for name, body in zip(parts[::2], parts[1::2]):
        yield name, {key: eval(f"dict({value})" if key == "resources" else value, names)
                     for key, value in re.findall(r"^    (\w+): (.*)$", body, re.MULTILINE)}, names


def fleet_by_snakemake():
    """Snakemake itself where it is installed, which the tests do not ask for, else its commands in the order of the rules."""
    folder, logs, environment = begun("fleet_by_snakemake")
    config = {"atlas": str(folder / "atlas"), "logs": str(logs), "shards": str(SHARDS)}
    if shutil.which("snakemake"):
        subprocess.run(["snakemake", "--snakefile", EXAMPLES / "Snakefile", "--cores", "2", "--config",
                        *(f"{name}={value}" for name, value in config.items())], cwd=folder, env=environment, check=True)
        return expect_same(folder, logs, environment)
    for name, rule, names in sorted(rules_of((EXAMPLES / "Snakefile").read_text(), config), key=lambda row: row[0] == "finish"):
        for shard in range(1, SHARDS + 1) if name == "run" else [None]:
            text = rule["shell"].format(**{**names, "threads": rule.get("threads", 1),
                                           "wildcards": types.SimpleNamespace(shard=shard)})
            subprocess.run(["bash", "-c", text], check=True, env=environment)
    return expect_same(folder, logs, environment)
