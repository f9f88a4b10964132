"""What others open, from a map of :func:`skyglow.distributed.atlas`: GeoTIFFs with a STAC catalogue, and PMTiles.

    skyglow.export.cogs("/shared/world.zarr", "/shared/world")  # /shared/world/collection.json leads to them
    skyglow.export.pmtiles("/shared/world.zarr", "/shared/world.pmtiles")

Needs ``pip install 'skyglow[export]'``, and for the colours of PMTiles ``skyglow-engine``.
"""

from __future__ import annotations

import dataclasses
import json
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from . import stac
from .errors import SkyglowError
from .grids import Grid, Numbers, between, halved
from .shards import ATLAS_KEY, ATLAS_QUERY, ROOT, Shards, variable_in
from .stores import Options, Where, open_store, size_of

# Rows and columns of a file: 256 MiB in memory.
SIDE = 8192
TILE_PX = 256
# Metres of a pixel of the one tile of zoom 0 on the equator (Web Mercator).
ZOOM_0_PIXEL_M = 2.0 * np.pi * 6378137.0 / TILE_PX
DEEPEST = 14
Progress = Callable[[int, int], None]


@dataclasses.dataclass(frozen=True)
class Baked:
    """A map in shards, open for reading."""

    values: Any
    grid: Grid
    about: dict[str, Any]
    shards: Shards

    @property
    def unit(self) -> str:
        """Of its numbers."""
        return str(self.values.attrs["units"])

    @property
    def shows(self) -> str:
        """What its numbers are, in words."""
        return str(self.values.attrs["long_name"])


def baked(where: Where, store: Options | None = None) -> Baked:
    """Opens a map; ``store`` are options of object storage, as of :func:`skyglow.distributed.atlas`."""
    import zarr

    kept = open_store(where, store)
    if size_of(kept, ROOT) is None:
        raise SkyglowError(f"{where} is no map of skyglow.distributed.atlas")
    group = zarr.open_group(kept, mode="r")
    name = variable_in(group)
    values: Any = group[name]
    mapping = group["spatial_ref"].attrs
    transform = tuple(float(part) for part in str(mapping["GeoTransform"]).split())
    grid = Grid(values.shape, transform, str(mapping["crs_wkt"]))
    return Baked(values, grid, dict(group.attrs), Shards(kept, name, "r"))


def cogs(
    where: Where,
    out: Where,
    *,
    side: int = SIDE,
    store: Options | None = None,
    progress: Progress | None = None,
) -> list[Path]:
    """Writes a map as Cloud-Optimized GeoTIFFs of ``side`` places at most either way, and a STAC catalogue of them.

    Each has its overviews; parts without a number are left out. The folder can be moved and served as it is: its
    links are relative. ``collection.json`` is the catalogue's beginning. Numbers are those of the map, bit for bit.
    """
    try:
        from rasterio.transform import Affine
    except ModuleNotFoundError as error:
        raise ImportError("GeoTIFFs need rasterio: pip install 'skyglow[export]'") from error
    chart, folder = baked(where, store), Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    x0, across, x_by_row, y0, y_by_column, down = chart.grid.transform
    whole = Affine(across, x_by_row, x0, y_by_column, down, y0)
    blocks = list(_blocks(chart.values.shape, _whole_shards(chart.values, side)))
    written: list[stac.Part] = []
    for done, (name, rows, columns) in enumerate(blocks, 1):
        values = chart.values[rows, columns]
        if not np.isnan(values).all():
            path = folder / f"{chart.values.basename}-{name}.tif"
            transform = whole @ Affine.translation(columns.start, rows.start)
            _write_cog(path, values, transform, chart)
            box = Grid(values.shape, transform.to_gdal(), chart.grid.crs).bounds
            written.append(stac.Part(path, values.shape, tuple(transform)[:6], box))
        if progress:
            progress(done, len(blocks))
    if not written:
        raise SkyglowError(f"{where} has no number yet")
    stac.write(folder, written, chart.about, chart.grid, unit=chart.unit, shows=chart.shows)
    return [part.path for part in written]


def _whole_shards(values: Any, side: int) -> tuple[int, int]:
    """Sides of files that are made of whole shards, so that each shard is read once."""
    rows, columns = (max(side // shard, 1) * shard for shard in (values.shards or values.chunks))
    return rows, columns


def _blocks(shape: tuple[int, int], side: tuple[int, int]) -> Iterator[tuple[str, slice, slice]]:
    for row, first in enumerate(range(0, shape[0], side[0])):
        for column, left in enumerate(range(0, shape[1], side[1])):
            rows, columns = slice(first, min(first + side[0], shape[0])), slice(left, min(left + side[1], shape[1]))
            yield f"{row}-{column}", rows, columns


def _write_cog(path: Path, values: Numbers, transform: Any, chart: Baked) -> None:
    import rasterio
    from rasterio.shutil import copy

    # As `skyglow atlas` says it in its files.
    notes = {"TIFFTAG_SOFTWARE": "Skyglow", "ASSUMPTIONS": str(chart.about["assumptions"])}
    if "attribution" in chart.about:
        notes["TIFFTAG_COPYRIGHT"] = str(chart.about["attribution"])
    unfinished = path.with_suffix(".unfinished")
    with rasterio.MemoryFile() as memory:
        with memory.open(
            driver="GTiff",
            height=values.shape[0],
            width=values.shape[1],
            count=1,
            dtype="float32",
            crs=chart.grid.crs.to_wkt(),
            transform=transform,
            nodata=float("nan"),
        ) as file:
            file.write(values, 1)
            file.set_band_description(1, chart.shows)
            file.set_band_unit(1, chart.unit)
            file.update_tags(**notes)
        copy(
            memory.name,
            unfinished,
            driver="COG",
            compress="DEFLATE",
            predictor="YES",
            blocksize=512,
            overview_resampling="AVERAGE",
            bigtiff="IF_SAFER",
        )
    unfinished.rename(path)


def pmtiles(
    where: Where,
    out: Where,
    *,
    max_zoom: int | None = None,
    store: Options | None = None,
    progress: Progress | None = None,
) -> Path:
    """Writes a map as PMTiles of coloured PNG, in the colours of the server's tiles and of ``skyglow atlas``.

    ``max_zoom`` is by default that at which a tile's pixel is no larger than a place; there it is what ``skyglow
    atlas`` draws. Pixels of lower zooms are means of four. Tiles that show nothing are left out. A server that is
    given the file (``atlases``) shows its tiles where it would compute the same map; of a map of which shards are
    missing it does not.
    """
    try:
        import skyglow_engine
        from pmtiles.tile import Compression, TileType, tileid_to_zxy, zxy_to_tileid
        from pmtiles.writer import Writer
    except ModuleNotFoundError as error:
        raise ImportError(f"PMTiles need {error.name}: pip install 'skyglow[export]' and skyglow-engine") from error
    chart, path = baked(where, store), Path(out)
    whole_zoom = _deepest_zoom(chart.grid)
    deepest = whole_zoom if max_zoom is None else max_zoom
    # Before its tiles are drawn: workers may still be at it.
    is_shown = deepest >= whole_zoom and chart.shards.is_whole()
    if not is_shown:
        why = "shards are missing" if deepest >= whole_zoom else f"its places want zoom {whole_zoom}"
        warnings.warn(f"servers do not show {path} in place of a map of their own: {why}", stacklevel=2)
    pyramid = _Pyramid(chart, deepest, progress)
    low, high = chart.values.attrs["colour_range"]
    description = f"{chart.shows}, {chart.unit}"
    if comment := chart.about.get("comment"):
        description += f". {comment}"
    unfinished = path.with_suffix(".unfinished")
    index: list[tuple[int, int, int]] = []
    with tempfile.TemporaryFile(dir=path.parent) as spool, unfinished.open("wb") as file:
        for zoom, x, y, values in pyramid.tiles():
            drawn = values.astype(np.float32)
            if not (drawn > low).any():
                continue
            png = skyglow_engine.brightness_png(drawn.tobytes(), (TILE_PX, TILE_PX), (low, high), description)
            index.append((zxy_to_tileid(zoom, x, y), spool.tell(), len(png)))
            spool.write(png)
        if not index:
            raise SkyglowError(f"{where} has nothing to show yet")
        writer: Any = Writer(file)  # type: ignore[no-untyped-call]
        # In the archive's order, so that parts of it can be extracted.
        in_order = sorted(index)
        zooms = [tileid_to_zxy(tile)[0] for tile, _, _ in (in_order[0], in_order[-1])]
        for tile, start, length in in_order:
            spool.seek(start)
            writer.write_tile(tile, spool.read(length))
        west, south, east, north = pyramid.bounds
        header = {
            "tile_type": TileType.PNG,
            "tile_compression": Compression.NONE,
            "min_lon_e7": round(west * 1e7),
            "min_lat_e7": round(south * 1e7),
            "max_lon_e7": round(east * 1e7),
            "max_lat_e7": round(north * 1e7),
            "center_zoom": deepest // 2,
            "center_lon_e7": round(0.5 * (west + east) * 1e7),
            "center_lat_e7": round(0.5 * (south + north) * 1e7),
        }
        about = {
            "name": f"{chart.about['scene']}: {chart.shows}",
            "description": description,
            "attribution": chart.about.get("attribution"),
            "assumptions": chart.about["assumptions"],
            "scene": chart.about["scene"],
            "scene_version": chart.about["scene_version"],
        }
        if is_shown:
            about |= {name: chart.about[name] for name in (ATLAS_KEY, ATLAS_QUERY) if name in chart.about}
            about["atlas_step"] = json.loads(chart.about["assumptions"])["step_pixels"]
            about["atlas_extent"] = [west, south, east, north, *zooms]
        writer.finalize(header, about)
    unfinished.rename(path)
    return path


def _deepest_zoom(grid: Grid) -> int:
    _, south, _, north = _degrees(grid)
    shrunk = max(np.cos(np.radians(0.5 * (south + north))), 0.05)
    return int(np.clip(np.ceil(np.log2(ZOOM_0_PIXEL_M * shrunk / grid.step_m)), 0, DEEPEST))


def _degrees(grid: Grid) -> tuple[float, float, float, float]:
    """West, south, east and north of a grid: all longitudes where it crosses the antimeridian."""
    west, south, east, north = grid.bounds
    return (west, south, east, north) if west < east else (-180.0, south, 180.0, north)


class _Pyramid:
    """Tiles of Web Mercator from the deepest zoom upward: what four have becomes one."""

    def __init__(self, chart: Baked, deepest: int, progress: Progress | None) -> None:
        self._chart, self._deepest, self._progress = chart, deepest, progress
        self.bounds = _degrees(chart.grid)
        west, south, east, north = self.bounds
        count = 2**deepest
        self._columns = tuple(int(np.clip((lon + 180.0) / 360.0 * count, 0, count - 1)) for lon in (west, east))
        self._rows = tuple(int(np.clip(_down(lat) * count, 0, count - 1)) for lat in (north, south))
        self._all = (self._columns[1] - self._columns[0] + 1) * (self._rows[1] - self._rows[0] + 1)
        self._done = 0

    def tiles(self) -> Iterator[tuple[int, int, int, Numbers]]:
        """Zoom, column, row and numbers of every tile that has any, deeper ones first."""
        yield from self._below(0, 0, 0, [])

    def _below(self, zoom: int, x: int, y: int, found: list[Numbers]) -> Iterator[tuple[int, int, int, Numbers]]:
        """The tiles of a quarter of the world of any depth; what it has itself is put into ``found``."""
        side = 2 ** (self._deepest - zoom)
        is_off = (x + 1) * side <= self._columns[0] or x * side > self._columns[1]
        if is_off or (y + 1) * side <= self._rows[0] or y * side > self._rows[1]:
            return
        if zoom == self._deepest:
            values = self._sampled(x, y)
            self._done += 1
            if self._progress:
                self._progress(self._done, self._all)
        else:
            four = np.full((2 * TILE_PX, 2 * TILE_PX), np.nan)
            for down in (0, 1):
                for right in (0, 1):
                    quarter: list[Numbers] = []
                    yield from self._below(zoom + 1, 2 * x + right, 2 * y + down, quarter)
                    if quarter:
                        top, left = down * TILE_PX, right * TILE_PX
                        four[top : top + TILE_PX, left : left + TILE_PX] = quarter[0]
            values = halved(four)
        if np.isfinite(values).any():
            found.append(values)
            yield zoom, x, y, values

    def _sampled(self, x: int, y: int) -> Numbers:
        middles = (np.arange(TILE_PX) + 0.5) / TILE_PX
        count = 2**self._deepest
        longitude = (x + middles) / count * 360.0 - 180.0
        latitude = np.degrees(np.arctan(np.sinh(np.pi * (1.0 - 2.0 * (y + middles) / count))))
        columns, rows = self._chart.grid.positions(*np.meshgrid(longitude, latitude))
        if not np.isfinite(columns).any():
            return np.full((TILE_PX, TILE_PX), np.nan)
        height, width = self._chart.values.shape
        first_row, last_row = max(int(np.nanmin(rows)), 0), min(int(np.nanmax(rows)) + 2, height)
        first_column, last_column = max(int(np.nanmin(columns)), 0), min(int(np.nanmax(columns)) + 2, width)
        window = self._chart.values[first_row:last_row, first_column:last_column]
        return between(window, columns - first_column, rows - first_row)


def _down(latitude_deg: float) -> float:
    """How far down the map of the world a latitude lies, of 1."""
    latitude = np.radians(np.clip(latitude_deg, -85.0511287798066, 85.0511287798066))
    return float(0.5 - np.arcsinh(np.tan(latitude)) / (2.0 * np.pi))
