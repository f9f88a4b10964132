"""Many places in, one table of skies out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import geopandas
import pandas

from .answers import Answer, points, scalars
from .errors import ProblemError

Places: TypeAlias = pandas.DataFrame | Iterable[tuple[float, float]]


# As many as one request takes.
PART = 1000


def table(places: Places, times: Iterable[Any] | None = None) -> pandas.DataFrame:
    """Places as a table with ``latitude_deg`` and ``longitude_deg``, whatever they came as; at each of ``times``."""
    listed = _listed(places)
    if times is None:
        return listed
    if "time" in listed:
        raise ValueError("the places have times of their own, which times= excludes")
    moments = list(times)
    each = listed.loc[listed.index.repeat(len(moments))]
    return each.assign(time=moments * len(listed))


def _listed(places: Places) -> pandas.DataFrame:
    if isinstance(places, geopandas.GeoDataFrame):
        if places.crs is None:
            raise ValueError("the points have no coordinate reference system; frame.set_crs('EPSG:4326') says WGS 84")
        where = places.geometry.to_crs("EPSG:4326")
        if not (where.geom_type == "Point").all():
            raise ValueError("places must be points; representative_point() gives one for each area")
        rest = pandas.DataFrame(places.drop(columns=places.geometry.name))
        return rest.assign(latitude_deg=where.y, longitude_deg=where.x)
    if isinstance(places, pandas.DataFrame):
        missing = {"latitude_deg", "longitude_deg"} - set(places.columns)
        if missing:
            raise ValueError(f"the table of places lacks {', '.join(sorted(missing))}")
        return places.copy()
    return pandas.DataFrame([(lat, lon) for lat, lon in places], columns=["latitude_deg", "longitude_deg"])


def parts(places: pandas.DataFrame) -> Iterator[list[dict[str, Any]]]:
    """What to ask for each place, as many at once as one request takes."""
    columns = [name for name in ("latitude_deg", "longitude_deg", "time") if name in places]
    names = {"latitude_deg": "lat", "longitude_deg": "lon"}
    rows = places[columns].rename(columns=names).to_dict("records")
    for first in range(0, len(rows), PART):
        yield rows[first : first + PART]


def frame(
    places: pandas.DataFrame, skies: Sequence[Answer | ProblemError], *, keep_problems: bool
) -> geopandas.GeoDataFrame:
    """The table with the numbers of each sky beside its place; assumptions that all share are in ``attrs``.

    Columns of the table whose names the numbers have are kept as ``NAME_given``. The first problem is raised
    unless they are kept.
    """
    for sky in skies:
        if isinstance(sky, ProblemError) and not keep_problems:
            raise sky
    rows: list[Mapping[str, Any]] = [
        {"problem": str(sky)} if isinstance(sky, ProblemError) else scalars(sky) for sky in skies
    ]
    found = pandas.DataFrame(rows, index=places.index)
    given = places.rename(columns={name: f"{name}_given" for name in found.columns})
    whole = pandas.concat([given, found], axis=1)
    answers = [sky for sky in skies if isinstance(sky, Answer)]
    air = ("turbidity", "scattering", "clouds", "cloud_cover", "cloud_pattern")
    shared = ("scene", "scenario", *air, "lamp", "emission", "calibration")
    attributes = {
        name: answers[0][name]
        for name in shared
        if answers and name in answers[0] and all(sky.get(name) == answers[0][name] for sky in answers)
    }
    points_of = points(whole.to_dict("records"), attributes)
    points_of.index = places.index
    return points_of
