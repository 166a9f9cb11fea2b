"""Options, scans and logs."""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import operator
import os
import threading
from typing import Any, Iterator, Mapping, NamedTuple, Sequence, Union

import numpy as np

from . import _library
from ._callers import Caller
from ._errors import InputError, UsageError
from ._library import CLogWarning, COption, CPose, CReaderRequest, CScan, Handle, call, encoded, make, plain

MOST_WHOLE = (1 << 64) - 1  # that the library can be told

Path = Union[str, "os.PathLike[str]"]
Options = Union[Mapping[str, Any], Path, None]


class Pose(NamedTuple):
    """Metres and radians; x forward, y left, theta counter-clockwise."""

    x: float
    y: float
    theta: float


class Option(NamedTuple):
    """An option of the configuration: its value as text with its unit, and what it means."""

    value: str
    doc: str


def _to_pose(pose: CPose) -> Pose:
    return Pose(pose.x_m, pose.y_m, pose.theta_rad)


def whole(name: str, value: Any, least: int, most: int) -> int:
    """A whole number of the caller's: one that C has no room for would become another one unseen."""
    number = operator.index(value)
    if not least <= number <= most:
        raise UsageError(f"{name}: {number} is not from {least} to {most}")
    return number


def c_pose(pose: "Sequence[float]") -> CPose:
    if len(pose) != 3:
        raise UsageError(f"a pose is x, y, theta, not {len(pose)} numbers")
    return CPose(*(float(value) for value in pose))


def _value_text(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    return str(value)


def make_options(
    options: Options,
    topics: "Sequence[str] | str" = (),
    odometry: "str | None" = None,
    crank: "str | None" = None,
    mount: "Mapping[str, Sequence[float]] | Sequence[float] | None" = None,
) -> Handle:
    """The options as the library has them: of a dictionary {"map.resolution": "5 cm"} or a YAML file."""
    handle = make("options", "options_new")
    if isinstance(options, Mapping):
        for path, value in options.items():
            call("options_set", handle, encoded(path), encoded(_value_text(value)))
    elif options is not None:
        call("options_read", handle, encoded(options))
    for topic in [topics] if isinstance(topics, str) else topics:
        call("options_add_topic", handle, encoded(topic))
    if odometry is not None:
        call("options_set_odometry", handle, encoded(odometry))
    if crank is not None:
        call("options_set_crank", handle, encoded(crank))
    if isinstance(mount, Mapping):
        for topic, pose in mount.items():
            call("options_add_mount", handle, encoded(topic), ctypes.byref(c_pose(pose)))
    elif mount is not None:
        call("options_add_mount", handle, None, ctypes.byref(c_pose(mount)))
    return handle


def options(changed: Options = None) -> dict[str, Option]:
    """Every option, by its path, as it stands with these changes."""
    handle = make_options(changed)
    rows = {}
    for index in range(plain("options_count", handle)):
        row = COption()
        call("options_at", handle, index, ctypes.byref(row))
        rows[row.path.decode()] = Option(row.value.decode(), row.doc.decode())
    return rows


@dataclasses.dataclass(eq=False)
class Scan:
    """A sweep of the laser.

    Attributes:
        ranges: metres, float32, shape (beams,); what is not finite, masked, 0 or at the limit is no return.
        first: bearing of the first beam in the laser's frame, radians; 0 is ahead, positive is left.
        step: bearing from beam to beam, radians.
        stamp: seconds.
        odometry: x, y, theta of the robot by its wheels in any frame that stays; None: not known.
        max_range: the sensor's limit, metres; 0: not known.
        mount: x, y, theta of the laser on the robot.
        first_beam_after, beam_period: seconds; beam k was measured at stamp + first_beam_after + k * beam_period.
        speed: x, y, theta a second of the robot meanwhile; None: not known.
        laser: which of several, in the order of their first scans.
    """

    ranges: np.ndarray
    first: float
    step: float
    stamp: float = 0.0
    odometry: "Sequence[float] | None" = None
    max_range: float = 0.0
    mount: Sequence[float] = (0.0, 0.0, 0.0)
    first_beam_after: float = 0.0
    beam_period: float = 0.0
    speed: "Sequence[float] | None" = None
    laser: int = 0

    def __eq__(self, other: Any) -> bool:
        return have_same_fields(self, other) if isinstance(other, Scan) else NotImplemented

    __hash__ = None  # type: ignore[assignment]


def _with_no_returns(values: Any) -> Any:
    """Without its mask; what it hid is nan."""
    return values.astype(np.float32).filled(np.nan) if isinstance(values, np.ma.MaskedArray) else values


def _are_same(one: Any, other: Any) -> bool:
    if one is None or other is None or isinstance(one, str):
        return one == other
    return np.array_equal(_with_no_returns(one), _with_no_returns(other), equal_nan=True)


def have_same_fields(one: Any, other: Any) -> bool:
    """Of dataclasses that hold arrays, which have no == that is true or false; nan is like nan."""
    return all(_are_same(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one))


def c_scan(scan: Scan) -> "tuple[CScan, np.ndarray]":
    """The scan for the library, and the ranges, which must live as long."""
    ranges = np.ascontiguousarray(_with_no_returns(scan.ranges), dtype=np.float32)
    if ranges.ndim != 1:
        raise InputError(f"ranges have the shape {ranges.shape}, and not (beams,)")
    given = CScan(
        stamp_s=float(scan.stamp),
        first_bearing_rad=float(scan.first),
        bearing_step_rad=float(scan.step),
        ranges_m=ranges.ctypes.data,
        range_count=ranges.size,
        max_range_m=float(scan.max_range),
        T_base_laser=c_pose(scan.mount),
        first_beam_after_s=float(scan.first_beam_after),
        beam_period_s=float(scan.beam_period),
        laser=whole("laser", scan.laser, 0, MOST_WHOLE),
    )
    if scan.odometry is not None:
        given.has_odometry, given.T_odom_base = 1, c_pose(scan.odometry)
    if scan.speed is not None:
        given.has_speed, given.speed = 1, c_pose(scan.speed)
    return given, ranges


def scan_from(scan: Any, **described: Any) -> Scan:
    """A scan as it is, or one of ranges and what describes them."""
    if isinstance(scan, Scan):
        given = [name for name, value in described.items() if value is not None]
        if given:
            raise UsageError(f"{', '.join(given)}: a Scan has them already")
        return scan
    if scan is None:
        raise TypeError("a Scan or its ranges are needed, not None")
    described = {name: value for name, value in described.items() if value is not None}
    for name in ("first", "step"):
        if name not in described:
            raise UsageError(f"{name} is missing: ranges need the bearing of their first beam and the step between two")
    return Scan(ranges=np.asarray(_with_no_returns(scan)), **described)


class LogWarning(NamedTuple):
    """What was skipped or mended in a log: of what kind, how often, and where and what the first one was."""

    kind: str
    count: int
    first: str


def _may_wait(log: bytes) -> bool:
    """Of a pipe, a terminal or another device; signals that come while a file is read have their turn soon enough."""
    return log == b"-" or not (os.path.isfile(log) or os.path.isdir(log))


def _scan_read(read: CScan) -> Scan:
    ranges = np.empty(read.range_count, dtype=np.float32)
    ctypes.memmove(ranges.ctypes.data, read.ranges_m, ranges.nbytes)  # the library's change with the next scan
    return Scan(
        ranges=ranges,
        first=read.first_bearing_rad,
        step=read.bearing_step_rad,
        stamp=read.stamp_s,
        odometry=_to_pose(read.T_odom_base) if read.has_odometry else None,
        max_range=read.max_range_m,
        mount=_to_pose(read.T_base_laser),
        first_beam_after=read.first_beam_after_s,
        beam_period=read.beam_period_s,
        speed=_to_pose(read.speed) if read.has_speed else None,
        laser=read.laser,
    )


class Scans:
    """The scans of logs, one after the other, each with the odometry that belongs to it; made by scans().

    What the handler of a signal raises while a pipe gives nothing comes out, and no more is read then. While a scan is
    read such a handler may ask for the progress alone.
    """

    def __init__(self, logs: "list[bytes]", options: Handle, flags: int) -> None:
        self._lock = threading.RLock()
        self._is_reading = False
        self._caller = Caller() if any(_may_wait(log) for log in logs) else None
        request = CReaderRequest(
            logs=_library.text_list(logs), log_count=len(logs), options=options.pointer, flags=flags
        )
        if self._caller is not None:
            request.progress = self._caller.progress
        with self._turn():
            self._handle = make("reader", "reader_new", ctypes.byref(request))

    @contextlib.contextmanager
    def _turn(self) -> Iterator[None]:
        """The library's reader belongs to one thread at a time."""
        with self._lock:
            if self._is_reading:  # in this thread
                raise RuntimeError("a scan is being read: the handler of a signal can ask for nothing but the progress")
            try:
                self._is_reading = True
                with self._caller or contextlib.nullcontext():
                    yield
            finally:
                self._is_reading = False

    def __iter__(self) -> Iterator[Scan]:
        return self

    def __next__(self) -> Scan:
        read, has_scan = CScan(), ctypes.c_int32()
        with self._turn():
            call("reader_next", self._handle, ctypes.byref(read), ctypes.byref(has_scan))
            scan = _scan_read(read) if has_scan.value else None
        if scan is None:
            raise StopIteration
        return scan

    @property
    def progress(self) -> "float | None":
        """Share of the logs that was read, from 0 to 1; None where that is not known."""
        with self._lock:
            share = plain("reader_progress", self._handle)
        return share if share >= 0.0 else None

    @property
    def warnings(self) -> "list[LogWarning]":
        """What was skipped or mended so far."""
        found: "list[LogWarning]" = []
        warning, has_warning = CLogWarning(), ctypes.c_int32()
        with self._turn():
            while True:
                call("reader_warning", self._handle, len(found), ctypes.byref(warning), ctypes.byref(has_warning))
                if not has_warning.value:
                    return found
                found.append(LogWarning(warning.kind.decode(), warning.count, warning.first.decode("utf-8", "replace")))


def log_list(logs: "Path | Sequence[Path]") -> "list[bytes]":
    """One log or several."""
    paths = [logs] if isinstance(logs, (str, os.PathLike)) else list(logs)
    return [encoded(path) for path in paths]  # type: ignore[misc]


def scans(
    logs: "Path | Sequence[Path]",
    *,
    options: Options = None,
    topics: "Sequence[str] | str" = (),
    odometry: "str | None" = None,
    mount: "Mapping[str, Sequence[float]] | Sequence[float] | None" = None,
    lenient: bool = False,
) -> Scans:
    """Reads a log of any format that the command reads, or several, one after the other.

    Args:
        logs: one file, or several that go on one after the other.
        options: {"log.max_range": "30 m"} or a configuration file.
        topics: of recordings (bags, MCAP), those whose scans are read; the only one where none is named.
        odometry: the topic of the odometry, or "tf".
        mount: x, y, theta of the laser on the robot, or of several {topic: (x, y, theta)}.
        lenient: count and skip what is malformed.
    """
    handle = make_options(options, topics, odometry, None, mount)
    return Scans(log_list(logs), handle, _library.LENIENT if lenient else 0)
