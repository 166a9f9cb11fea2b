"""One scan in, one pose out: mapping, and localisation in a map that stays."""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import os
import threading
from typing import Any, Iterator, Sequence

import numpy as np

from . import _library
from ._arrays import Grid, make_grid, poses_view
from ._callers import Caller, ProgressFunction
from ._errors import UsageError
from ._library import CLocalizerRequest, CLocation, CMapperRequest, CMatch, CTracked, call, encoded, make, plain
from ._runs import Run, thread_count
from ._scans import Options, Path, Pose, _to_pose, c_scan, have_same_fields, make_options, scan_from

VERDICTS = ("found", "ambiguous", "poor fit", "no pose")
WHEREABOUTS = ("unknown", "found", "tracked", "predicted")


@dataclasses.dataclass(frozen=True)
class Match:
    """The pose of a scan and what speaks for it.

    Attributes:
        pose: x, y, theta of the robot in the map, whose origin is its pose at the first scan; it never leaps.
        predicted: the same by the odometry alone.
        correction: where the frame of these poses lies in the one with the loops closed that were found by then.
        accepted: the match was taken; else the pose is the prediction.
        keyframe: the scan went into the map.
        doubt: why it is in doubt, or "none".
        overlap: share of the points near known obstacles.
        contradiction: share of the points beside known obstacles.
        mean_distance: of the points to the map's obstacles, metres.
        points: valid returns.
        stamp: seconds.
    """

    pose: Pose
    predicted: Pose
    correction: Pose
    accepted: bool
    keyframe: bool
    doubt: str
    overlap: float
    contradiction: float
    mean_distance: float
    points: int
    stamp: float


class Mapper:
    """Maps one robot's scans, one after the other: the same map and poses as a whole log gives.

    Args:
        options: {"map.resolution": "5 cm"} or a configuration file.
        loops: look for places that were seen before; else each scan is matched with one map of all that was seen.
        threads: of the processor; 0 is one a processor. Results are the same.
    """

    def __init__(self, options: Options = None, *, loops: bool = True, threads: "int | None" = None) -> None:
        handle = make_options(options)
        request = CMapperRequest(
            options=handle.pointer, flags=0 if loops else _library.NO_LOOPS, threads=thread_count(threads)
        )
        self._lock = threading.RLock()
        self._is_closing = False
        self._process = os.getpid()
        self._handle = make("mapper", "mapper_new", ctypes.byref(request))

    @contextlib.contextmanager
    def _turn(self) -> Iterator[None]:
        """The library's mapper belongs to one thread at a time, and to the process that has its threads."""
        if os.getpid() != self._process:
            raise RuntimeError("this mapper's threads are in the process that made it; make one in this process")
        with self._lock:
            if self._is_closing:  # in this thread
                raise RuntimeError("the mapper is being closed: its progress function cannot use it; wait for close()")
            yield

    def process(
        self,
        scan: Any,
        *,
        stamp: "float | None" = None,
        first: "float | None" = None,
        step: "float | None" = None,
        odometry: "Sequence[float] | None" = None,
        max_range: "float | None" = None,
        mount: "Sequence[float] | None" = None,
    ) -> Match:
        """Takes the next scan: a Scan, or its ranges (metres, shape (beams,)) and what describes them as Scan does."""
        given, _ranges = c_scan(
            scan_from(
                scan, stamp=stamp, first=first, step=step, odometry=odometry, max_range=max_range, mount=mount
            )
        )
        match = CMatch()
        with self._turn():
            call("mapper_process", self._handle, ctypes.byref(given), ctypes.byref(match))
        return Match(
            pose=_to_pose(match.T_map_base),
            predicted=_to_pose(match.T_map_predicted),
            correction=_to_pose(match.correction),
            accepted=bool(match.is_accepted),
            keyframe=bool(match.is_keyframe),
            doubt=plain("doubt_name", match.doubt).decode(),
            overlap=match.overlap,
            contradiction=match.contradiction,
            mean_distance=match.mean_distance_m,
            points=match.points,
            stamp=match.stamp_s,
        )

    def close(self, progress: "ProgressFunction | None" = None) -> None:
        """After the last scan: closes the rest of the loops and adjusts the path. `progress` as of map()."""
        with self._turn(), Caller(progress) as caller:
            self._is_closing = True
            try:
                call("mapper_close", self._handle, caller.progress, None)
            finally:
                self._is_closing = False

    @property
    def trajectory(self) -> np.ndarray:
        """The poses so far, shape (scans, 4), float64: stamp, x, y, theta; those of Match until close()."""
        poses, count = ctypes.c_void_p(), ctypes.c_size_t()
        with self._turn():
            call("mapper_trajectory", self._handle, ctypes.byref(poses), ctypes.byref(count))
            return poses_view(None, poses.value, count.value).copy()  # the library's moves with the next scan

    def field(self) -> Grid:
        """The distance field as it is now, shape (height, width), uint16: 1/256 cell to the nearest obstacle.

        A view of the library's memory, which stays as it is whatever becomes of the mapper.
        """
        with self._turn():
            return make_grid(make("grid", "mapper_field", self._handle))


@dataclasses.dataclass(frozen=True)
class Location:
    """What the search for a scan came to.

    Attributes:
        verdict: "found", "ambiguous" (a pose elsewhere may be as good), "poor fit" (it was taken elsewhere) or "no pose".
        pose: x, y, theta of the robot in the map; None without one.
        mean_distance: of the scan's points to the map's obstacles there, metres.
        gap: no pose has a mean distance that is smaller by more than this, metres.
        runner_up: the best pose elsewhere, 1 m or 20 degrees away; None where it was not looked for.
        runner_up_mean_distance: metres.
        points: valid returns.
    """

    verdict: str
    pose: "Pose | None"
    mean_distance: float
    gap: float
    runner_up: "Pose | None"
    runner_up_mean_distance: float
    points: int

    @property
    def found(self) -> bool:
        return self.verdict == "found"

    @property
    def ambiguous(self) -> bool:
        return self.verdict == "ambiguous"


def _limit(name: str, value: "float | None") -> float:
    """As the library takes it, for which 0 is its default."""
    if value is None:
        return 0.0
    if value == 0:
        raise UsageError(f"{name}: 0 cannot be kept; give more, or None")
    return value


class Localizer:
    """Finds scans in the whole of a map, without odometry and with a proof. May serve several threads.

    Args:
        map: a Run, its folder or gdt.yaml, or the map.yaml of an occupancy map of any program.
        options: as of Mapper.
        gap: the proof that is asked for, metres; None: 5 mm.
        max_seconds: for a pose; None: until it is proven.
        good_fit: the largest mean distance that is one, metres; None: what the map tells.
        runner_up: look for the best pose elsewhere.
    """

    def __init__(
        self,
        map: "Run | Path",  # noqa: A002 - the word of the field
        options: Options = None,
        *,
        gap: "float | None" = None,
        max_seconds: "float | None" = None,
        good_fit: "float | None" = None,
        runner_up: bool = True,
    ) -> None:
        handle = make_options(options)
        request = CLocalizerRequest(
            map=encoded(map.folder if isinstance(map, Run) else map),
            options=handle.pointer,
            flags=0 if runner_up else _library.NO_RUNNER_UP,
            gap_m=_limit("gap", gap),
            max_seconds=_limit("max_seconds", max_seconds),
            good_fit_m=_limit("good_fit", good_fit),
        )
        self._handle = make("localizer", "localizer_new", ctypes.byref(request))

    def find(
        self,
        scan: Any,
        *,
        first: "float | None" = None,
        step: "float | None" = None,
        max_range: "float | None" = None,
        mount: "Sequence[float] | None" = None,
    ) -> Location:
        """Where a scan was taken: a Scan, or its ranges and what describes them."""
        given, _ranges = c_scan(scan_from(scan, first=first, step=step, max_range=max_range, mount=mount))
        found = CLocation()
        call("localizer_find", self._handle, ctypes.byref(given), ctypes.byref(found))
        verdict = VERDICTS[found.verdict]
        return Location(
            verdict=verdict,
            pose=None if verdict == "no pose" else _to_pose(found.T_map_base),
            mean_distance=found.mean_distance_m,
            gap=found.proven_gap_m,
            runner_up=_to_pose(found.runner_up) if found.has_runner_up else None,
            runner_up_mean_distance=found.runner_up_mean_distance_m,
            points=found.points,
        )

    def tracker(self) -> "Tracker":
        """Follows a robot in this map, from a start that is found by itself."""
        return Tracker(self)


@dataclasses.dataclass(frozen=True, eq=False)
class Tracked:
    """Where a robot is, and how that is known.

    Attributes:
        whereabouts: "unknown", "found" (by a search, not proven by a drive yet), "tracked" or "predicted".
        pose: x, y, theta in the map; None where it is unknown.
        ambiguous: another place fitted as well when it was found, and nothing has told them apart yet.
        explained: share of the scan's points near an obstacle of the map.
        mean_distance: of the points to the map's obstacles, metres.
        covariance: of x, y, theta along the map's axes, shape (3, 3).
    """

    whereabouts: str
    pose: "Pose | None"
    ambiguous: bool
    explained: float
    mean_distance: float
    covariance: np.ndarray

    def __eq__(self, other: Any) -> bool:
        return have_same_fields(self, other) if isinstance(other, Tracked) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


class Tracker:
    """Follows a robot in a map that stays; made by Localizer.tracker()."""

    def __init__(self, localizer: Localizer) -> None:
        self._lock = threading.Lock()
        self._handle = make("tracker", "tracker_new", localizer._handle)

    def follow(self, scan: Any, **described: Any) -> Tracked:
        """Takes the next scan: a Scan, or its ranges and what describes them as Mapper.process() takes it."""
        given, _ranges = c_scan(scan_from(scan, **described))
        tracked = CTracked()
        with self._lock:
            call("tracker_follow", self._handle, ctypes.byref(given), ctypes.byref(tracked))
        whereabouts = WHEREABOUTS[tracked.whereabouts]
        xx, xy, xt, yy, yt, tt = tracked.covariance
        return Tracked(
            whereabouts=whereabouts,
            pose=None if whereabouts == "unknown" else _to_pose(tracked.T_map_base),
            ambiguous=bool(tracked.is_ambiguous),
            explained=tracked.explained,
            mean_distance=tracked.mean_distance_m,
            covariance=np.array([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]]),
        )


def localize(map: "Run | Path", scan: Any, **how: Any) -> Location:  # noqa: A002
    """Where a scan was taken in a map: Localizer(map).find(scan), for one scan.

    What Localizer takes (options, gap, max_seconds, good_fit, runner_up) and what describes ranges (first, step,
    max_range, mount) may follow.
    """
    names = ("options", "gap", "max_seconds", "good_fit", "runner_up")
    limits = {name: how.pop(name) for name in names if name in how}
    return Localizer(map, **limits).find(scan, **how)
