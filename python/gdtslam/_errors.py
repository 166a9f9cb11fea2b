"""What can go wrong, as exceptions: one class for each status of the library."""

from __future__ import annotations


class Error(Exception):
    """Anything that the library reports: one line that says what is wrong and what to do.

    ``status`` is the exit code that the command ``gdtslam`` would have.
    """

    status = 1


class UsageError(Error, ValueError):
    """A call that makes no sense."""

    status = 2


class InputError(Error, ValueError):
    """Data that cannot be used."""

    status = 65


class UnavailableError(Error):
    """Something that was asked for is not in this build or not on this machine."""

    status = 69


class OutOfMemoryError(Error, MemoryError):
    """There is no memory for a map of this size."""

    status = 71


class FileError(Error, OSError):
    """A file that cannot be read or written."""

    status = 74


class ConfigError(Error, ValueError):
    """An option that there is not, or a value out of its bounds."""

    status = 78


class Interrupted(Error):
    """The caller's own progress function ended the work; ``run`` has what there was, or is None.

    So do scans of a pipe whose reading was ended by what the handler of a signal raised, when they are asked again.
    """

    status = 130
    run = None


BY_STATUS = {
    kind.status: kind
    for kind in (Error, UsageError, InputError, UnavailableError, OutOfMemoryError, FileError, ConfigError, Interrupted)
}
