#!/usr/bin/env python3
"""What the bombs of tests/cli/scenario_bombs.py take: a table of each file, its bytes, the peak memory and CPU seconds of
the command that reads it, and the line that it ends in. Exit status 1 where one takes more than it may."""

import argparse
import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", nargs="?", default=ROOT / "build/test/bin/gdtslam", help="gdtslam (default: that of build/test)")
    parser.add_argument("--only", default="", metavar="TEXT", help="only bombs with that in their name")
    parser.add_argument("--piped", type=int, default=1024, metavar="MIB", help="newlines that come through a pipe (default: 1024)")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        log = os.path.join(work, "drive.log")
        os.environ.update(GDTSLAM=str(pathlib.Path(chosen.program).resolve()), GDTSLAM_SOURCE=str(ROOT), GDTSLAM_CLI_WORK=work,
                          GDTSLAM_CLI_LOG=log, FAILING_CALLS="", GDTSLAM_BOMB_MB=str(chosen.piped), XDG_CACHE_HOME=os.path.join(work, "cache"))
        sys.dont_write_bytecode = True
        sys.path.insert(0, str(ROOT / "tests/cli"))
        import cli_support as cli  # noqa: E402, the environment comes first
        from bomb_formats.bomb import detonate, faults_of
        from scenario_bombs import BOMBS

        pathlib.Path(log).write_text("".join(cli.room_scan(1 + 0.05 * k, 1.5, 0.01 * k, 10 + 0.2 * k) for k in range(20)))
        cli.TRUTH.write_text("10.0 0 0 0 0 0 0 1\n")
        print("| bomb | bytes | peak MB | CPU s | exit | line |\n|---|---:|---:|---:|---:|---|")
        failed = 0
        for bomb in BOMBS:
            if chosen.only.lower() not in bomb.name.lower():
                continue
            code, text, megabytes, cpu_s, size = detonate(bomb)
            line = text.strip().replace(work, "").replace("|", "\\|")[:200]
            faults = faults_of(bomb, code, text, megabytes, cpu_s)
            failed += bool(faults)
            print(f"| {bomb.name} | {size:,} | {megabytes} | {cpu_s:.2f} | {code} | {line}{' **' + '; '.join(faults) + '**' if faults else ''} |",
                  flush=True)
        return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
