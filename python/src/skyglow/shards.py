"""A map of brightness as a Zarr v3 group with an array in shards, as CF and GeoZarr have it; needs ``zarr`` 3.

Shards are windows of the map's own rows and columns, so that poles and the antimeridian are like any other place.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyproj

from . import stores
from .datasets import CONVENTIONS
from .errors import SkyglowError
from .maps import Frame, Window
from .stores import Options, Where

try:
    import zarr
    from zarr.abc.store import Store
    from zarr.codecs import ZstdCodec
    from zarr.storage import LocalStore, MemoryStore
except ModuleNotFoundError as error:
    raise ImportError("maps in shards need zarr 3: pip install 'skyglow[distributed]'") from error

KEY = "skyglow_key"
# By which a server knows tiles of the map, and the parameters that it was made with.
ATLAS_KEY, ATLAS_QUERY = "atlas_key", "atlas_query"
# Side of the chunks within a shard at most: what a reader of a few places reads.
CHUNK = 256
# Places of a side of a shard where nobody says: 4 MiB a shard.
SIDE = 1024
# All that a shard has is written: a shard of places without a number is there, as any other that is done.
CONFIG: Any = {"write_empty_chunks": True}

Tile = tuple[int, int]
# The description of a group or an array; that of the map is written last: where it is there, the map is.
ROOT = "zarr.json"


class Shards:
    """A map where it is kept: a Zarr group, with one file for each shard."""

    def __init__(self, store: Store, name: str, mode: Literal["r", "r+"] = "r+") -> None:
        self.store, self.name = store, name
        self._array = zarr.open_array(store, path=name, mode=mode).with_config(CONFIG)
        rows, columns = self._array.shards or self._array.chunks
        self.tile: Tile = (rows, columns)

    def at(self, shard: Tile) -> Window:
        """The window of a shard by its row and column among shards."""
        ends = [
            (at * side, min((at + 1) * side, length))
            for at, side, length in zip(shard, self.tile, self._array.shape, strict=True)
        ]
        return Window(ends[0], ends[1])

    def over(self, window: Window) -> list[Tile]:
        """The shards that have places of a window, from the north."""
        rows, columns = (
            _over(ends, side, length)
            for ends, side, length in zip((window.rows, window.columns), self.tile, self._array.shape, strict=True)
        )
        return [(row, column) for row in rows for column in columns]

    def key(self, shard: Tile) -> str:
        """The file of a shard."""
        return f"{self.name}/c/{shard[0]}/{shard[1]}"

    def has(self, shard: Tile) -> bool:
        """Whether a shard is there and whole, by the checksums in it."""
        if not stores.size_of(self.store, self.key(shard)):
            return False
        try:
            self._array[self.at(shard).slices]
        except (ValueError, RuntimeError):
            return False
        return True

    def is_whole(self) -> bool:
        """Whether all shards are there."""
        rows, columns = self._array.shape
        every = self.over(Window((0, rows), (0, columns)))
        return all(stores.size_of(self.store, self.key(shard)) for shard in every)

    def write(self, shard: Tile, values: np.ndarray[Any, Any]) -> None:
        """Writes a shard in one piece: in a folder beside its place, then renamed."""
        # Zarr would read a damaged one.
        if not self.has(shard):
            stores.delete(self.store, self.key(shard))
        self._array[self.at(shard).slices] = values

    def clear_unfinished(self) -> None:
        """Removes what writers that were killed left beside shards in a folder."""
        if isinstance(self.store, LocalStore):
            for path in (self.store.root / self.name).rglob("*.partial"):
                path.unlink(missing_ok=True)


def open_shards(
    where: Where, frame: Frame, tile: Tile | None, *, resume: bool, options: Options | None = None
) -> Shards:
    """The map of a frame where it is kept, made where it is not there yet.

    A :class:`SkyglowError` where another map is there, or the same in shards of another size.
    """
    name, store = variable(frame), stores.open_store(where, options)
    if isinstance(store, LocalStore):
        Path(where).mkdir(parents=True, exist_ok=True)
    if not stores.is_empty(store):
        found = _key(store)
        if found is None and not _is_begun(store, name):
            raise SkyglowError(f"{where} is there already and is no map of this program")
        if resume and found is not None:
            if found != frame.key:
                raise SkyglowError(
                    f"{where} is another map, or of another scene, other packs or another build of the engine: "
                    "resume=False begins anew"
                )
            shards = Shards(store, name)
            if tile is not None and shards.tile != _fitted(tile, frame.shape):
                raise SkyglowError(f"{where} has shards of {shards.tile} places: resume=False begins anew")
            return shards
        stores.clear(store)
    _create(store, name, frame, _fitted(tile or _natural(frame), frame.shape))
    return Shards(store, name)


def _over(ends: Tile, side: int, length: int) -> list[int]:
    """The parts of a side, each once, that have places between two ends, of which one may lie beyond the last."""
    first, end = ends
    pieces = [(first, min(end, length)), (0, end - length)]
    parts = (at for first, end in pieces if end > first for at in range(first // side, (end - 1) // side + 1))
    return list(dict.fromkeys(parts))


def variable_in(group: zarr.Group) -> str:
    """The name of the map of a group."""
    names = [name for name, array in group.arrays() if "colour_range" in array.attrs]
    if len(names) != 1:
        raise SkyglowError("this is no map of skyglow.distributed.atlas, or one of an older version: bake it anew")
    return names[0]


def variable(frame: Frame) -> str:
    """The name of what a map shows."""
    return {"cd m-2": "luminance", "lx": "illuminance"}.get(frame.unit, "radiance_seen")


def _key(store: Store) -> str | None:
    try:
        return str(zarr.open_group(store, mode="r").attrs[KEY])
    except (FileNotFoundError, KeyError):
        return None


def _is_begun(store: Store, name: str) -> bool:
    """Whether a map was begun, and whoever made it ended before its description was there."""
    try:
        attributes = zarr.open_array(store, path=name, mode="r").attrs
    except (FileNotFoundError, KeyError, ValueError):
        return False
    return stores.size_of(store, ROOT) is None and attributes.get("grid_mapping") == "spatial_ref"


def _natural(frame: Frame) -> Tile:
    """Whole patches, about as many as make a shard of SIDE x SIDE places."""
    rows, columns = (max(SIDE // side, 1) * side for side in frame.patch)
    if frame.patch[1] >= frame.shape[1]:
        rows = frame.patch[0]
    return rows, columns


def _fitted(tile: Iterable[int], shape: Tile) -> Tile:
    """No larger than the map, but of whole chunks where it is as large."""
    sides = []
    for side, length in zip(tile, shape, strict=True):
        if side < 1:
            raise SkyglowError("tile: rows and columns of a shard, at least one of each")
        sides.append(side if side < length else -(-length // CHUNK) * CHUNK if length > CHUNK else length)
    return sides[0], sides[1]


def _chunk(side: int) -> int:
    """A side of chunks that a side of a shard has a whole number of; all of it where those would be narrow."""
    largest = next(part for part in range(min(side, CHUNK), 0, -1) if side % part == 0)
    return largest if largest >= 16 else side


def _create(store: Store, name: str, frame: Frame, tile: Tile) -> None:
    reference = pyproj.CRS.from_wkt(frame.crs_wkt)
    names = ("latitude", "longitude") if reference.is_geographic else ("y", "x")
    made = MemoryStore()
    group = zarr.open_group(made, mode="w", zarr_format=3, attributes=_attributes(frame))
    x, across, x_by_row, y, y_by_column, down = frame.transform
    if x_by_row == 0 == y_by_column:
        sides = ((names[0], y, down, frame.shape[0]), (names[1], x, across, frame.shape[1]))
        for (side, first, step, count), (standard, units, axis) in zip(sides, _axes(reference), strict=True):
            values = first + step * (np.arange(count) + 0.5)
            attributes: Any = {"standard_name": standard, "units": units, "axis": axis}
            group.create_array(side, data=values, chunks=values.shape, dimension_names=(side,), attributes=attributes)
    mapping = {**reference.to_cf(), "GeoTransform": " ".join(repr(float(part)) for part in frame.transform)}
    group.create_array("spatial_ref", data=np.array(0, np.int32), dimension_names=(), attributes=mapping)
    group.create_array(
        name,
        shape=frame.shape,
        shards=tile,
        chunks=(_chunk(tile[0]), _chunk(tile[1])),
        dtype="float32",
        fill_value=float("nan"),
        compressors=ZstdCodec(level=3, checksum=True),
        dimension_names=names,
        attributes={
            "long_name": frame.description,
            "units": frame.unit,
            "colour_range": list(frame.colour_range),
            "grid_mapping": "spatial_ref",
            "coordinates": "spatial_ref",
        },
    )
    stores.copy(made, store, first=f"{name}/{ROOT}", last=ROOT)


def _axes(reference: pyproj.CRS) -> tuple[tuple[str, str, str], tuple[str, str, str]]:
    if reference.is_geographic:
        return ("latitude", "degrees_north", "Y"), ("longitude", "degrees_east", "X")
    return ("projection_y_coordinate", "m", "Y"), ("projection_x_coordinate", "m", "X")


def _attributes(frame: Frame) -> dict[str, Any]:
    scene = frame.assumptions["scene"]
    attributes = {
        "Conventions": CONVENTIONS,
        "title": frame.description,
        "comment": "Illustrative light, not measured." if scene["illustrative"] else "",
        "scene": scene["id"],
        "scene_version": scene["version"],
        "attribution": frame.attribution or "",
        "date": frame.date or "",
        "warnings": "\n".join(frame.assumptions["warnings"]),
        "assumptions": json.dumps(frame.assumptions, ensure_ascii=False),
        KEY: frame.key,
        ATLAS_KEY: frame.atlas_key,
        ATLAS_QUERY: frame.query,
    }
    return {name: value for name, value in attributes.items() if value != ""}
