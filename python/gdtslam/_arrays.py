"""numpy arrays over memory of the library, which lives as long as the arrays do."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from ._library import CGridView, Handle, call, plain


class _Memory:
    """What numpy takes for an array; keeps the owner of the memory alive."""

    def __init__(self, owner: Any, address: int, shape: tuple[int, ...], strides: tuple[int, ...], kind: str) -> None:
        self.owner = owner
        self.__array_interface__ = {
            "version": 3,
            "data": (address, True),  # nobody may write
            "shape": shape,
            "strides": strides,
            "typestr": kind,
        }


def poses_view(owner: Any, address: "int | None", count: int) -> np.ndarray:
    """Poses as an array (count, 4) of float64: stamp, x, y, theta."""
    if count == 0 or address is None:
        return np.empty((0, 4))
    return np.asarray(_Memory(owner, address, (count, 4), (32, 8), "<f8"))


class Grid(np.ndarray):
    """The cells of a map or a distance field, shape (height, width), row 0 the one of the lowest y.

    A read-only view of the library's memory. What is made of it (slices, sums) is a plain grid of numbers, without the
    attributes below.

    Attributes:
        resolution: metres from cell to cell.
        origin: x and y in metres of the lower left corner of the cell [0, 0].
        cap: of a distance field, what cells hold that are so far from every obstacle or unknown, 1/256 cell; else 0.
        sha256: of a distance field, what report.json calls map_sha256; else "".
    """

    resolution: "float | None" = None
    origin: "tuple[float, float] | None" = None
    cap: "int | None" = None
    _handle: "Handle | None" = None

    @property
    def sha256(self) -> str:
        return "" if self._handle is None else plain("grid_sha256", self._handle).decode()

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top in metres, as matplotlib's imshow(..., origin="lower") takes it."""
        x, y = self.origin
        return x, x + self.shape[1] * self.resolution, y, y + self.shape[0] * self.resolution

    def metres(self) -> np.ndarray:
        """The distances of a distance field in metres, float32; cells at the cap are nan."""
        cells = np.asarray(self)
        return np.where(cells < self.cap, cells * np.float32(self.resolution / 256.0), np.float32(np.nan))


def make_grid(handle: Handle) -> Grid:
    view = CGridView()
    call("grid_look", handle, ctypes.byref(view))
    kind = "<u2" if view.cell_bytes == 2 else "|u1"
    shape = (view.height, view.width)
    if view.cells is None:  # of a map before its first scan
        cells = np.empty(shape, kind)
        cells.flags.writeable = False
    else:
        cells = np.asarray(_Memory(handle, view.cells, shape, (view.row_bytes, view.cell_bytes), kind))
    grid = cells.view(Grid)
    grid.resolution = view.resolution_m
    grid.origin = (view.origin_x_m, view.origin_y_m)
    grid.cap = view.cap
    grid._handle = handle
    return grid
