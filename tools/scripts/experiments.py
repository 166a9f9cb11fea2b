#!/usr/bin/env python3
"""The experiments behind the documents: logs that are simulated or public, mapped, compared with the truth, as Markdown tables.

    experiments.py NAME PROGRAM [-o FOLDER] [OPTION...]      experiments.py NAME --help

FOLDER keeps logs and runs; what it has is not made again where that takes long. Without it they are removed. The exit code is
1 where a bound or a target is missed. long_drives.py has one more, with worlds of its own."""

import argparse
import pathlib
import sys
import tempfile

from experiment.city import campus, city
from experiment.live import endurance, latency
from experiment.nodding import nodding
from experiment.sessions import sessions
from experiment.tracking import tracking


def option(name, default, **words):
    return (name,), {"type": type(default), "default": default, "help": "(%(default)s)", **words}


EXPERIMENTS = {
    city: [option("--side", 1000.0), option("--blocks", 10), option("--scans", 30000), option("--seed", 1),
           (("--loops",), {"action": "store_true"})],
    campus: [],
    latency: [(("log",), {"type": pathlib.Path}), option("--speed", 100.0), option("--busy", 1)],
    sessions: [option("--worlds", "wings"), option("--seeds", 20), option("--sessions", 20), option("--metres", 150.0)],
    nodding: [option("--seeds", 3)],
    tracking: [(("logs",), {"nargs": "+", "type": pathlib.Path})],
    endurance: [(("kinds",), {"nargs": "*", "metavar": "KIND"}), option("--hours", 10.0), option("--scans", 1_000_000),
                option("--maps", 10_000), option("--map-scans", 100)],
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = parser.add_subparsers(required=True, metavar="NAME")
    for experiment, options in EXPERIMENTS.items():
        its = names.add_parser(experiment.__name__, description=experiment.__doc__, help=experiment.__doc__.split(".")[0].split(":")[0])
        its.set_defaults(experiment=experiment)
        its.add_argument("program", type=pathlib.Path)
        its.add_argument("-o", "--output", type=pathlib.Path)
        its.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="for the mapper of city and latency")
        for words, properties in options:
            its.add_argument(*words, **properties)
    chosen = parser.parse_args()
    chosen.mapping = [word for value in chosen.set for word in ("--set", value)]
    with tempfile.TemporaryDirectory() as temporary:
        chosen.folder = chosen.output or pathlib.Path(temporary)
        chosen.folder.mkdir(parents=True, exist_ok=True)
        return 0 if chosen.experiment(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
