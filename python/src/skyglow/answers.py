"""The server's JSON with its own names, and tables of what it lists."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import geopandas
import pandas


class Answer(dict[str, Any]):
    """An answer of the server: a dictionary whose entries are attributes too, with the server's names."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the answer has no {name!r}; it has {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


class Plan(Answer):
    """A reduction plan. Its ``id`` is taken as ``scenario=`` by every question about light."""

    def frame(self) -> geopandas.GeoDataFrame:
        """The listed pixels with what each is dimmed by, the most effective first."""
        return points(self.get("pixels", []), {k: v for k, v in self.items() if k != "pixels"})


def answer(document: Any) -> Any:
    """A JSON document with every object as an :class:`Answer`."""
    if isinstance(document, dict):
        return Answer({name: answer(value) for name, value in document.items()})
    if isinstance(document, list):
        return [answer(value) for value in document]
    return document


def points(rows: Iterable[Mapping[str, Any]], attributes: Mapping[str, Any] | None = None) -> geopandas.GeoDataFrame:
    """Rows with ``latitude_deg`` and ``longitude_deg`` as points in WGS 84."""
    table = pandas.DataFrame(list(rows))
    if table.empty:
        table = pandas.DataFrame({"latitude_deg": [], "longitude_deg": []}, dtype=float)
    where = geopandas.points_from_xy(table["longitude_deg"], table["latitude_deg"])
    frame = geopandas.GeoDataFrame(table, geometry=where, crs="EPSG:4326")
    frame.attrs = dict(attributes or {})
    return frame


def scalars(sky: Mapping[str, Any]) -> dict[str, Any]:
    """What a table of skies has of one: its single numbers, and those that say how far to trust it."""
    row = {name: value for name, value in sky["sky"].items() if not isinstance(value, list | dict)}
    row |= {"altitude_m": sky["observer"]["altitude_m"], "coverage": sky["coverage"]}
    if "night_sky" in sky:
        row["visible_stars"] = sky["night_sky"]["stars"]["visible"]
    row["warnings"] = "; ".join(sky["warnings"])
    return row
