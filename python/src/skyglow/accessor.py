"""`sky.skyglow`: pictures, and values in any direction, of the dataset of a panorama."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes

from . import plot
from .answers import Answer, answer


@xarray.register_dataset_accessor("skyglow")  # type: ignore[no-untyped-call]
class SkyAccessor:
    """What a panorama can be asked beside what every dataset can."""

    def __init__(self, sky: xarray.Dataset) -> None:
        self._sky = sky

    @property
    def assumptions(self) -> Answer:
        """What the numbers depend on, and the numbers of the sky as ``.sky``."""
        return Answer(answer(json.loads(self._sky.attrs["assumptions"])))

    def fisheye(self, **how: Any) -> Axes:
        """See :func:`skyglow.plot.fisheye`."""
        return plot.fisheye(self._sky, **how)

    def panorama(self, **how: Any) -> Axes:
        """See :func:`skyglow.plot.panorama`."""
        return plot.panorama(self._sky, **how)

    def at(self, azimuth_deg: Any, elevation_deg: Any, name: str = "luminance") -> np.ndarray[Any, Any]:
        """A variable in directions, bilinear between samples; NaN below the observer's horizon.

        Above the highest and below the lowest samples it is that of the nearest row; next to hidden samples it
        is that of the visible ones around.
        """
        values = self._sky[name].transpose("elevation", "azimuth").values.astype(float)
        azimuths, elevations = self._sky["azimuth"].values, self._sky["elevation"].values
        azimuth, elevation = np.broadcast_arrays(np.asarray(azimuth_deg, float), np.asarray(elevation_deg, float))
        x = (azimuth - azimuths[0]) / (azimuths[1] - azimuths[0]) % azimuths.size
        y = np.clip((elevation - elevations[0]) / (elevations[1] - elevations[0]), 0.0, elevations.size - 1.0)
        left, low = np.floor(x).astype(int) % azimuths.size, np.floor(y).astype(int)
        right, high = (left + 1) % azimuths.size, np.minimum(low + 1, elevations.size - 1)
        to_right, to_high = x - np.floor(x), y - low
        total, weight = np.zeros(azimuth.shape), np.zeros(azimuth.shape)
        for row, part_y in ((low, 1.0 - to_high), (high, to_high)):
            for column, part_x in ((left, 1.0 - to_right), (right, to_right)):
                sample = values[row, column]
                part = np.where(np.isfinite(sample), part_x * part_y, 0.0)
                total += part * np.nan_to_num(sample)
                weight += part
        with np.errstate(invalid="ignore", divide="ignore"):
            seen = total / weight
        horizon = self._sky["horizon"].values
        skyline = horizon[left] * (1.0 - to_right) + horizon[right] * to_right
        return np.where((elevation < 0.0) | (elevation < skyline), np.nan, seen)
