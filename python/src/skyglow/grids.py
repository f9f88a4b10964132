"""Where places lie on a map's grid, and its numbers between places: as the program has them (`PlaceValues::at`)."""

from __future__ import annotations

import functools
from typing import Any, TypeAlias

import numpy as np
import pyproj

Numbers: TypeAlias = np.ndarray[Any, Any]
WGS84 = "EPSG:4326"


class Grid:
    """Rows and columns of places over the ground.

    ``transform`` has GDAL's six coefficients, ``crs`` whatever pyproj reads.
    """

    def __init__(self, shape: tuple[int, int], transform: tuple[float, ...], crs: Any) -> None:
        self.shape, self.transform, self.crs = shape, transform, pyproj.CRS.from_user_input(crs)

    def positions(self, longitude_deg: Numbers, latitude_deg: Numbers) -> tuple[Numbers, Numbers]:
        """Columns and rows of places, whole numbers in the middles of the grid's; NaN off the grid."""
        x0, across, x_by_row, y0, y_by_column, down = self.transform
        if self.crs.is_geographic:
            # From the western edge on eastward, wherever the grid begins.
            x, y = x0 + (longitude_deg - x0) % 360.0, latitude_deg
        else:
            x, y = self._from_degrees.transform(longitude_deg, latitude_deg)
        area = across * down - x_by_row * y_by_column
        columns = ((x - x0) * down - (y - y0) * x_by_row) / area - 0.5
        rows = ((y - y0) * across - (x - x0) * y_by_column) / area - 0.5
        is_on = (columns >= -0.5) & (columns < self.shape[1] - 0.5) & (rows >= -0.5) & (rows < self.shape[0] - 0.5)
        return np.where(is_on, columns, np.nan), np.where(is_on, rows, np.nan)

    @functools.cached_property
    def _from_degrees(self) -> pyproj.Transformer:
        return pyproj.Transformer.from_crs(WGS84, self.crs, always_xy=True)

    @functools.cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """West, south, east and north in degrees; west of east beyond the antimeridian."""
        x0, across, x_by_row, y0, y_by_column, down = self.transform
        rows, columns = self.shape
        corners = [
            (x0 + c * across + r * x_by_row, y0 + c * y_by_column + r * down) for c in (0, columns) for r in (0, rows)
        ]
        (west, south), (east, north) = np.min(corners, axis=0), np.max(corners, axis=0)
        if self.crs.is_geographic:
            if east - west >= 360.0:
                return -180.0, float(south), 180.0, float(north)
            turned = [float((side + 180.0) % 360.0 - 180.0) for side in (west, east)]
            return turned[0], float(south), turned[1] if turned[1] > -180.0 else 180.0, float(north)
        to_degrees = pyproj.Transformer.from_crs(self.crs, WGS84, always_xy=True)
        return to_degrees.transform_bounds(west, south, east, north)

    @property
    def step_m(self) -> float:
        """Side of a square with the area of a place in the middle of the grid, metres."""
        _, across, x_by_row, y0, y_by_column, down = self.transform
        area = abs(across * down - x_by_row * y_by_column)
        if not self.crs.is_geographic:
            return float(np.sqrt(area)) * self.crs.axis_info[0].unit_conversion_factor
        latitude = y0 + 0.5 * self.shape[0] * down + 0.5 * self.shape[1] * y_by_column
        return float(np.sqrt(area * np.cos(np.radians(latitude))) * np.radians(pyproj.Geod(ellps="WGS84").a))


def between(values: Numbers, columns: Numbers, rows: Numbers) -> Numbers:
    """Numbers at positions, linear between places; NaN where the nearest place has none."""
    is_off = ~np.isfinite(columns)
    columns, rows = np.where(is_off, 0.0, columns), np.where(is_off, 0.0, rows)
    (west, east, across), (north, south, down) = (_along(columns, values.shape[1]), _along(rows, values.shape[0]))
    total, weights, nearest = np.zeros(columns.shape), np.zeros(columns.shape), np.full(columns.shape, -1.0)
    has_number = np.zeros(columns.shape, bool)
    for column, row, weight in (
        (west, north, (1.0 - across) * (1.0 - down)),
        (east, north, across * (1.0 - down)),
        (west, south, (1.0 - across) * down),
        (east, south, across * down),
    ):
        value = values[row, column].astype(float)
        is_number = ~np.isnan(value)
        is_nearer = weight > nearest
        nearest, has_number = np.where(is_nearer, weight, nearest), np.where(is_nearer, is_number, has_number)
        total += np.where(is_number, weight * value, 0.0)
        weights += np.where(is_number, weight, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(has_number & ~is_off, total / weights, np.nan)


def _along(positions: Numbers, count: int) -> tuple[Numbers, Numbers, Numbers]:
    positions = np.clip(positions, 0.0, count - 1.0)
    below = np.minimum(positions.astype(int), max(count - 2, 0))
    return below, np.minimum(below + 1, count - 1), positions - below


def halved(values: Numbers) -> Numbers:
    """The means of blocks of two by two, of those in them that have a number."""
    rows, columns = (-(-side // 2) for side in values.shape)
    padded = np.full((2 * rows, 2 * columns), np.nan)
    padded[: values.shape[0], : values.shape[1]] = values
    blocks = padded.reshape(rows, 2, columns, 2)
    counts = np.isfinite(blocks).sum(axis=(1, 3))
    means: Numbers = np.nansum(blocks, axis=(1, 3)) / np.where(counts > 0, counts, np.nan)
    return means
