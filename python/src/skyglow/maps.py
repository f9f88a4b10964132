"""Parts of a map of brightness as numbers: what whoever makes a share of a map needs of an engine."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import sys
import urllib.parse
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import asked
from .engine import Engine
from .errors import SkyglowError

# Of `skyglow atlas`.
PLACES = 16_000_000
Bounds = tuple[float, float, float, float]


@dataclasses.dataclass(frozen=True)
class Window:
    """Rows from the north and columns from the west of a map: the first, and one beyond the last.

    Of a map that goes all around the Earth the columns may go on beyond the last, from the first.
    """

    rows: tuple[int, int]
    columns: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows[1] - self.rows[0], self.columns[1] - self.columns[0]

    @property
    def slices(self) -> tuple[slice, slice]:
        """What it is of an array of the whole map, if it does not go on beyond its last column."""
        return slice(*self.rows), slice(*self.columns)


@dataclasses.dataclass(frozen=True)
class Frame:
    """What a map is before any of it is found.

    ``shape`` are rows and columns of its places, ``window`` those within the bounds that were asked for. ``patch`` are
    rows and columns that are found together: parts that consist of whole ones cost no more than their share.
    ``transform`` has GDAL's six coefficients, ``bounds`` west, south, east and north of the scene; pictures have their
    colours between the ends of ``colour_range``; ``date`` is that of the scene's light. ``key`` tells this map, made by
    this engine, from all others; ``atlas_key`` and ``query`` are those by which a server shows tiles of the map where
    it would compute it.
    """

    shape: tuple[int, int]
    window: Window
    patch: tuple[int, int]
    transform: tuple[float, ...]
    crs_wkt: str
    bounds: Bounds
    unit: str
    description: str
    colour_range: tuple[float, float]
    attribution: str | None
    date: str | None
    assumptions: Mapping[str, Any]
    key: str
    atlas_key: str
    query: str


class BrightnessMap:
    """A map of brightness that an engine can make any part of, with the numbers of the whole map, bit for bit.

    ``places`` are as many as it has at most, as of ``skyglow atlas``; ``parameters`` are those of
    ``engine.layer("brightness")``. Work is done on all cores of the machine.
    """

    def __init__(self, engine: Engine, scene: str, *, places: int = PLACES, **parameters: Any) -> None:
        self._engine = engine
        self._which = (scene, urllib.parse.urlencode(asked.query(parameters)), places)

    def frame(self, bounds: Bounds | None = None) -> Frame:
        """What it is; ``bounds`` are west, south, east and north, west of east beyond the antimeridian."""
        said = json.loads(self._engine._asked(lambda engine: engine.map_frame(*self._which, bounds)))
        if said["window"] is None:
            raise SkyglowError(f"no place of the scene lies within the bounds {bounds}")
        content = f"{_program()} {said['content']}"
        return Frame(
            shape=(said["rows"], said["columns"]),
            window=Window(tuple(said["window"]["rows"]), tuple(said["window"]["columns"])),
            patch=(said["patch"][1], said["patch"][0]),
            transform=tuple(said["geotransform"]),
            crs_wkt=said["crs_wkt"],
            bounds=tuple(said["bounds"]),
            unit=said["unit"],
            description=said["description"],
            colour_range=tuple(said["colour_range"]),
            attribution=said["attribution"],
            date=said["date"],
            assumptions=said["assumptions"],
            key=hashlib.sha256(content.encode()).hexdigest(),
            atlas_key=said["atlas_key"],
            query=self._which[1],
        )

    def part(self, window: Window) -> np.ndarray[Any, np.dtype[np.float32]]:
        """The numbers of a window, and none of the rest; NaN where the ground is higher than the packs reach."""
        content = self._engine._asked(lambda engine: engine.map_part(*self._which, window.columns, window.rows))
        return np.frombuffer(content, np.float32).reshape(window.shape)


@functools.cache
def _program() -> str:
    """The hash of the engine's code: another build may round in another way."""
    import skyglow_engine

    # The extension module lies in a package with its types.
    module = sys.modules.get("skyglow_engine.skyglow_engine", skyglow_engine)
    with open(str(module.__file__), "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
