"""A SpatioTemporal Asset Catalog (STAC 1.1.0) of a map's files: a collection with an item for each."""

from __future__ import annotations

import dataclasses
import datetime
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas

from .grids import Grid

COG = "image/tiff; application=geotiff; profile=cloud-optimized"
PROJECTION = "https://stac-extensions.github.io/projection/v2.0.0/schema.json"
RASTER = "https://stac-extensions.github.io/raster/v2.0.0/schema.json"
Box = tuple[float, float, float, float]


@dataclasses.dataclass(frozen=True)
class Part:
    """A file: ``transform`` as affine has it, ``box`` west, south, east and north, degrees."""

    path: Path
    shape: tuple[int, int]
    transform: tuple[float, ...]
    box: Box


def write(folder: Path, parts: Sequence[Part], about: dict[str, Any], grid: Grid, *, unit: str, shows: str) -> None:
    """Writes ``collection.json`` and an item beside each file, with relative links."""
    try:
        import pystac
    except ModuleNotFoundError as error:
        raise ImportError("a STAC catalogue needs pystac: pip install 'skyglow[export]'") from error
    scene, light = str(about["scene"]), about.get("comment", "")
    first, last, note = _interval(about.get("date"))
    description = " ".join(part for part in (f"{shows.capitalize()}, {unit}.", str(light), note) if part)
    boxes = [part.box for part in parts]
    # That of all, then those of the parts: where there is one, STAC takes it once alone.
    extents = [list(around(boxes)), *(list(box) for box in boxes if len(boxes) > 1)]
    collection = pystac.Collection(
        id=f"{scene}-{parts[0].path.stem.partition('-')[0]}",
        title=f"{scene}: {shows}",
        description=description,
        license="other",
        keywords=["light pollution", "night lights"],
        providers=[pystac.Provider(str(about["attribution"]), roles=[pystac.ProviderRole.PRODUCER])]
        if "attribution" in about
        else None,
        extent=pystac.Extent(pystac.SpatialExtent(extents), pystac.TemporalExtent([[first, last]])),
        extra_fields={"skyglow:assumptions": about["assumptions"]},
    )
    epsg = grid.crs.to_epsg()
    for part in parts:
        item = pystac.Item(
            id=f"{scene}-{part.path.stem}",
            geometry=_geometry(part.box),
            bbox=list(part.box),
            datetime=first if first == last else None,
            start_datetime=None if first == last else first,
            end_datetime=None if first == last else last,
            properties={
                "title": f"{scene}: {shows}",
                "description": description,
                "proj:code": f"EPSG:{epsg}" if epsg else None,
                **({} if epsg else {"proj:wkt2": grid.crs.to_wkt()}),
                "proj:shape": list(part.shape),
                "proj:transform": list(part.transform),
            },
            stac_extensions=[PROJECTION, RASTER],
        )
        fields: dict[str, Any] = {"data_type": "float32", "nodata": "nan", "unit": unit}
        fields |= {"raster:spatial_resolution": grid.step_m, "raster:sampling": "area"}
        asset = pystac.Asset(f"./{part.path.name}", title=shows, media_type=COG, roles=["data"], extra_fields=fields)
        item.add_asset("data", asset)
        item.set_self_href(str((folder / f"{part.path.stem}.json").absolute()))
        collection.add_item(item)
    collection.set_self_href(str((folder / "collection.json").absolute()))
    for item in collection.get_items():
        item.set_self_href(str((folder / f"{item.id.removeprefix(scene + '-')}.json").absolute()))
    collection.catalog_type = pystac.CatalogType.SELF_CONTAINED
    for made in (*collection.get_items(), collection):
        made.save_object(include_self_link=False)


def around(boxes: Sequence[Box]) -> Box:
    """The narrowest box around all, across the antimeridian where that is narrower."""
    south, north = min(box[1] for box in boxes), max(box[3] for box in boxes)
    wests = np.array([box[0] for box in boxes])
    widths = np.array([(box[2] - box[0]) % 360.0 or 360.0 for box in boxes])
    # It begins where one of them does.
    ends = (wests - wests[:, np.newaxis]) % 360.0 + widths
    first = int(np.argmin(ends.max(axis=1)))
    if ends[first].max() >= 360.0:
        return -180.0, south, 180.0, north
    return boxes[first][0], south, boxes[int(np.argmax(ends[first]))][2], north


def _geometry(box: Box) -> dict[str, Any]:
    """A box as GeoJSON, cut at the antimeridian (RFC 7946, 3.1.9)."""
    west, south, east, north = box

    def ring(west: float, east: float) -> list[list[list[float]]]:
        return [[[west, south], [east, south], [east, north], [west, north], [west, south]]]

    if west <= east:
        return {"type": "Polygon", "coordinates": ring(west, east)}
    return {"type": "MultiPolygon", "coordinates": [ring(west, 180.0), ring(-180.0, east)]}


def _interval(date: Any) -> tuple[datetime.datetime, datetime.datetime, str]:
    """First and last instant of a scene's date; of no date, now, with words that say so."""
    if not date:
        now = datetime.datetime.now(datetime.UTC).replace(microsecond=0)
        return now, now, "The light has no date: the time is when the files were written."
    first, _, last = str(date).partition("/")
    return _edge(first, is_end=False), _edge(last or first, is_end=True), ""


def _edge(text: str, *, is_end: bool) -> datetime.datetime:
    if "T" in text:
        given: datetime.datetime = pandas.Timestamp(text).tz_convert("UTC").to_pydatetime()
        return given
    period = pandas.Period(text)
    instant = period.end_time.floor("s") if is_end else period.start_time
    edge: datetime.datetime = instant.tz_localize("UTC").to_pydatetime()
    return edge
