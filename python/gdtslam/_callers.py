"""The caller's own functions, which the library calls, and the signals that come while it works."""

from __future__ import annotations

import signal
import threading
import types
import warnings
from _signal import getsignal  # that of signal takes ten times as long, to name what is no handler
from typing import Any, Callable

from . import _library

_SIGNALS = [int(number) for number in signal.valid_signals()]

ProgressFunction = Callable[[str, int, "float | None"], Any]
WarnFunction = Callable[[str], Any]


def _warn(text: str) -> None:
    warnings.warn(text, stacklevel=5)  # of the line that calls the package


class Caller:
    """A block in which the library may call the caller's functions. What they raise ends the work, and the block raises
    it once the library has returned.

    So does what the handlers of signals raise, KeyboardInterrupt among it: the interpreter gives them their turn as the
    library calls a function, before its first line, and what is raised there would go nowhere. So the block puts itself
    before the handlers. Within the caller's own functions they act as everywhere. While it waits for a pipe the library
    calls progress after each signal, so that they have their turn then, too. A block may be entered again.
    """

    def __init__(self, progress: "ProgressFunction | None" = None, warn: "WarnFunction | None" = None) -> None:
        self.progress = _library.Progress(self._tell_progress)
        self.warn = _library.Warn(self._tell_warning)
        self._progress = progress
        self._warn = _warn if warn is None else warn
        self._problem: "BaseException | None" = None
        self._is_in_library = False
        self._replaced: "dict[int, tuple[Any, Any]]" = {}  # handlers of signals: the caller's and ours

    def __enter__(self) -> "Caller":
        self._is_in_library = True
        try:
            self._replace_handlers()
        except BaseException as problem:  # noqa: BLE001 - of a handler that is not replaced yet
            self._keep(problem)
            self.__exit__()
        return self

    def __exit__(self, *_raised: Any) -> None:
        self._is_in_library = False  # from here on those that are not back yet act as everywhere, too
        try:
            self._give_handlers_back()
        except BaseException as problem:  # noqa: BLE001 - of a handler; the rest goes back all the same
            self._keep(problem)
            self._give_handlers_back()
        first, self._problem = self._problem, None
        if first is not None:
            raise first

    def _tell_progress(self, _user: Any, step: bytes, scans: int, share: float) -> int:
        ends = False
        if self._progress is not None and self._problem is None:
            ends = self._call(self._progress, step.decode(), scans, share if share >= 0.0 else None)
        return 1 if ends or self._problem is not None else 0

    def _tell_warning(self, _user: Any, text: bytes) -> None:
        if self._problem is None:
            self._call(self._warn, text.decode("utf-8", "replace"))

    def _call(self, function: "Callable[..., Any]", *arguments: Any) -> bool:
        try:
            try:
                self._is_in_library = False
                return bool(function(*arguments))
            finally:
                self._is_in_library = True
        except BaseException as problem:  # noqa: BLE001 - goes on in the caller's thread
            self._is_in_library = True  # where a handler raised before it was so again
            self._keep(problem)
            return True

    def _keep(self, problem: BaseException) -> None:
        if self._problem is None:
            self._problem = problem

    def _replace_handlers(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return  # signals are handled elsewhere
        for number in _SIGNALS:
            handler = getsignal(number)
            if not callable(handler):
                continue
            ours = self._before(handler)
            self._replaced[number] = (handler, ours)
            signal.signal(number, ours)

    def _give_handlers_back(self) -> None:
        for number, (handler, ours) in self._replaced.items():
            if getsignal(number) is ours:  # else the caller has set another one meanwhile
                signal.signal(number, handler)
        self._replaced = {}

    def _before(self, handler: "Callable[[int, types.FrameType | None], Any]") -> Any:
        def handle(number: int, frame: "types.FrameType | None") -> None:
            if not self._is_in_library:
                handler(number, frame)
                return
            try:
                handler(number, frame)
            except BaseException as problem:  # noqa: BLE001 - raised when the library has returned
                self._keep(problem)

        return handle
