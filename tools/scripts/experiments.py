#!/usr/bin/env python3
"""The experiments behind the documents: simulated logs are mapped and compared with the truth, as Markdown tables.

    experiments.py NAME PROGRAM [-o FOLDER] [OPTION...]      experiments.py NAME --help

FOLDER keeps logs and runs; without it they are removed. The exit code is 1 if a bound or a target is missed."""

import argparse
import pathlib
import sys
import tempfile

from experiment.drives import WORLDS, drives
from experiment.endurance import endurance
from experiment.nodding import nodding


def option(name, default, **words):
    return (name,), {"type": type(default), "default": default, "help": "(%(default)s)", **words}


EXPERIMENTS = {
    drives: [option("--worlds", ",".join(WORLDS)), option("--seeds", 3), option("--km", 2.0),
             (("--set",), {"action": "append", "default": [], "metavar": "PATH=VALUE", "help": "for the mapper"})],
    nodding: [option("--seeds", 3)],
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
        for words, properties in options:
            its.add_argument(*words, **properties)
    chosen = parser.parse_args()
    chosen.mapping = [word for value in getattr(chosen, "set", []) for word in ("--set", value)]
    with tempfile.TemporaryDirectory() as temporary:
        chosen.folder = chosen.output or pathlib.Path(temporary)
        chosen.folder.mkdir(parents=True, exist_ok=True)
        return 0 if chosen.experiment(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
