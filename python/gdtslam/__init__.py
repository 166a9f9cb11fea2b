"""gdtslam: 2D and 3D mapping with a laser range finder.

Frames and units: metres, radians, seconds; x forward, y left, angles counter-clockwise. Results are the bytes that the
command `gdtslam` gives for the same log, on every machine.

    run = gdtslam.map("drive.mcap", out="run")      # run.trajectory (N, 4), run.map (H, W), run.report, run.render()
    mapper = gdtslam.Mapper({"map.resolution": "5 cm"})
    for scan in gdtslam.scans("drive.mcap"):
        match = mapper.process(scan)                # match.pose, match.accepted, match.doubt
    mapper.field()                                  # (H, W) uint16
    gdtslam.localize("run", scan)                   # .verdict, .pose, .gap
"""

from ._arrays import Grid
from ._errors import (
    ConfigError,
    Error,
    FileError,
    InputError,
    Interrupted,
    OutOfMemoryError,
    UnavailableError,
    UsageError,
)
from ._library import plain as _plain
from ._live import Localizer, Location, Mapper, Match, Tracked, Tracker, localize
from ._runs import Run, map, render  # noqa: A004
from ._scans import LogWarning, Option, Pose, Scan, Scans, options, scans

OCCUPIED, UNKNOWN, FREE = 0, 205, 254
"""The cells of Run.map."""

__version__: str = _plain("version").decode()

__all__ = [
    "ConfigError",
    "Error",
    "FREE",
    "FileError",
    "Grid",
    "InputError",
    "Interrupted",
    "Localizer",
    "Location",
    "LogWarning",
    "Mapper",
    "Match",
    "OCCUPIED",
    "Option",
    "OutOfMemoryError",
    "Pose",
    "Run",
    "Scan",
    "Scans",
    "Tracked",
    "Tracker",
    "UNKNOWN",
    "UnavailableError",
    "UsageError",
    "localize",
    "map",
    "options",
    "render",
    "scans",
]
