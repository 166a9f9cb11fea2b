"""calibrate: from a log of a wall to a linkage file that map and linkage take."""

import json

import cli_support as cli
from cli_support import command, expect, expect_exit, one_error_line

TRUE = """gdtslam_linkage: 1
name: mount
bars: {crank: 3.7 cm, coupler: 8.4 cm, rocker: 8.85 cm, ground: 4.9 cm}
assembly: open
encoder: {ticks_per_turn: 20000, wraps: true, zero: 40 deg, direction: 1}
elevation: {sign: 1, offset: -61.5 deg}
"""


def calibrate_recovers_the_mount():
    """The wall of the paper's protocol: the zero and the offset within what the tool states, figure and file written."""
    folder = cli.fresh_folder("calibrate")
    (folder / "true.yaml").write_text(TRUE)
    log = folder / "wall.log.gz"
    expect_exit(command("simulate", cli.SOURCE / "assets/scenes/wall.yaml", "-o", log, "--linkage", folder / "true.yaml"), 0)
    linkage, figure = folder / "linkage.yaml", folder / "figure.svg"
    process = command("calibrate", log, "-o", linkage, "--start", "paper-b", "--svg", figure, "--json")
    expect_exit(process, 0)
    found = {entry["name"]: entry for entry in json.loads(process.stdout)["parameters"]}
    for name, true in (("zero", 0.6981317), ("offset", -1.0733775), ("distance.wall", 2.0)):
        error = abs(found[name]["estimate"] - true)
        expect(error < 4.0 * found[name]["sigma"] + 1e-4, f"{name} is off by {error}, sigma {found[name]['sigma']}")
        expect(found[name]["observable"], f"{name} passes for not observed")
    expect(not any(found[bar]["observable"] for bar in ("crank", "coupler", "rocker", "ground")), "a bar passes for observed")
    expect(figure.read_text().startswith("<svg"), "no figure")
    expect_exit(command("linkage", linkage), 0)


def calibrate_refuses_what_tells_nothing():
    """No crank in the log, an elevation beyond the wall, no log: one line each, nothing written."""
    folder = cli.fresh_folder("calibrate_refuses")
    linkage = folder / "linkage.yaml"
    for code, arguments in ((65, [cli.LOG]), (2, [cli.LOG, "--up-to", "95deg"]),
                            (74, [folder / "missing.log"])):
        process = command("calibrate", *arguments, "-o", linkage)
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(not linkage.exists(), "a linkage was written")
