"""Pictures of any part of a scene's map of brightness, whoever draws them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from . import asked as written
from .calls import Call
from .engine import Engine
from .grids import Grid, Numbers, between, halved
from .maps import Bounds, BrightnessMap
from .questions import Questions

# Of a map that an engine makes for looking at: seconds of work.
PLACES = 50_000
# The parameters of these are what a map of brightness goes by.
OPERATION = "get_brightness_tif"
NATURAL = ("sky", "time", "solar_flux")


class Chart(Protocol):
    """Draws a map of brightness."""

    def draw(self, bounds: Bounds, size_px: tuple[int, int]) -> bytes:
        """What lies between west, south, east and north, degrees, as PNG; a degree of either is as long all over."""


def chart(source: Questions, scene: str, asked: Mapping[str, Any]) -> Chart:
    """The map of a scene with what it goes by of what is asked for a sky."""
    taken = source.parameters(OPERATION).index
    # Maps of the zenith know artificial light alone.
    of_map = {name: value for name, value in asked.items() if name in taken and name not in NATURAL}
    return OfEngine(source, scene, of_map) if isinstance(source, Engine) else OfServer(source, scene, of_map)


class OfServer:
    """By OGC API - Maps of a server."""

    def __init__(self, source: Questions, scene: str, asked: Mapping[str, Any]) -> None:
        self._source, self._path, self._asked = source, f"/api/ogc/collections/{scene}/map", dict(asked)

    def draw(self, bounds: Bounds, size_px: tuple[int, int]) -> bytes:
        """See :class:`Chart`."""
        box = ",".join(f"{side:.9f}" for side in bounds)
        query = written.query({**self._asked, "bbox": box, "width": size_px[0], "height": size_px[1]})
        return self._source._answer(Call(self._path, lambda response: response.content, query))


class OfEngine:
    """By the numbers of an engine, which makes the map with the first picture."""

    def __init__(self, source: Engine, scene: str, asked: Mapping[str, Any]) -> None:
        self._map = BrightnessMap(source, scene, places=PLACES, **asked)
        self._levels: list[Numbers] = []

    def draw(self, bounds: Bounds, size_px: tuple[int, int]) -> bytes:
        """See :class:`Chart`."""
        import skyglow_engine

        frame = self._map.frame()
        if not self._levels:
            self._levels = [self._map.part(frame.window)]
            while min(self._levels[-1].shape) > 1:
                self._levels.append(halved(self._levels[-1]))
        west, south, east, north = bounds
        east += 360.0 if east < west else 0.0
        across = west + (np.arange(size_px[0]) + 0.5) * (east - west) / size_px[0]
        down = north - (np.arange(size_px[1]) + 0.5) * (north - south) / size_px[1]
        columns, rows = Grid(frame.shape, frame.transform, frame.crs_wkt).positions(*np.meshgrid(across, down))
        # The level whose places are as far from each other as the picture's pixels.
        apart = np.abs(np.diff(rows, axis=0))
        apart = apart[np.isfinite(apart)]
        level = round(np.log2(max(float(np.median(apart)), 1.0))) if apart.size else 0
        scale = 2.0 ** min(level, len(self._levels) - 1)
        values = between(
            self._levels[min(level, len(self._levels) - 1)], (columns + 0.5) / scale - 0.5, (rows + 0.5) / scale - 0.5
        )
        drawn = values.astype(np.float32).tobytes()
        png: bytes = skyglow_engine.brightness_png(drawn, size_px, frame.colour_range, frame.description)
        return png
