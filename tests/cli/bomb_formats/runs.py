"""Bombs in the folder of a run: keyframes, tables, copies of logs, tiles. The run is a real one, whose report does not tell
of hashes, as one that somebody else sends."""

import functools
import json
import shutil
import struct

import cli_support as cli
from bomb_formats.bomb import MB, Bomb, gzipped


@functools.cache
def real_run():
    folder = cli.fresh_folder("bombs/real_run")
    cli.expect_exit(cli.command("map", cli.LOG, "-o", folder / "run", "-q", "--no-pictures"), 0)
    return folder / "run"


def run_with(name, content, *command):
    """A run with another file of that name; the command's RUN stands for its folder."""

    def make(folder):
        run = folder / "run"
        shutil.copytree(real_run(), run)
        report = json.loads((run / "report.json").read_text())
        report.pop("files")
        (run / "report.json").write_text(json.dumps(report))
        (run / name).parent.mkdir(exist_ok=True)
        (run / name).write_bytes(content())
        for other in run.rglob("*"):  # the bomb is the only file whose bytes count
            if other.is_file() and other != run / name:
                other.touch()
        return [str(word).replace("RUN", str(run)).replace("OUT", str(folder / "out")) for word in command]

    return make


BOMBS = [
    Bomb("keyframes of zeros in gzip", run_with("keyframes.bin.gz", lambda: gzipped(b"", bytes(MB), 1000), "edit", "RUN", "--rotate-to-walls", "-o", "OUT"), 65, "keyframes.bin.gz", 700, 10),
    Bomb("covariances of newlines", run_with("covariance.csv", lambda: b"\n" * (64 * MB), "evaluate", "RUN", "--reference", cli.TRUTH), 65, "covariance.csv", 200),
    Bomb("edits nested 1,000,000 deep", run_with("again.json", lambda: b'{"edits":' + b"[" * 1_000_000, "edit", "RUN", "--again", "RUN/again.json", "-o", "OUT"), 65, "again.json"),
    Bomb("graph of 16 MB in a line", run_with("graph.g2o", lambda: b"VERTEX_SE2 " + b"1" * (16 * MB), "merge", "RUN", "RUN", "-o", "OUT"), 65, "graph.g2o"),
    Bomb("continue.json nested 1,000,000 deep", run_with("continue.json", lambda: b'{"logs":' + b"[" * 1_000_000, "map", "--continue", "RUN"), 65, "continue.json"),
]
