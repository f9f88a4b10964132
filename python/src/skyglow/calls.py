"""What is asked and how answers are read, without sending anything: clients send these, and the engine answers them."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic, Protocol, TypeVar

import geopandas
import pandas
import xarray

from . import asked as written
from . import datasets
from .answers import Answer, Plan, answer, points
from .errors import ProblemError, UnreachableError, problem_in

T = TypeVar("T")
U = TypeVar("U")
SCENE = "/api/v1/scenes/{scene}"


class Response(Protocol):
    """What came: a response of httpx, or bytes of the engine."""

    @property
    def content(self) -> bytes:
        """All of it."""

    def json(self) -> Any:
        """The same, read as JSON."""


@dataclasses.dataclass(frozen=True)
class Call(Generic[T]):
    """A request, and what becomes of its response. ``{scene}`` in the path is filled in by whoever sends it."""

    path: str
    read: Callable[[Response], T]
    query: Mapping[str, str] = dataclasses.field(default_factory=dict)
    json: Any = None

    def at(self, scene: str) -> Call[T]:
        """The same of a scene."""
        return dataclasses.replace(self, path=self.path.replace("{scene}", scene))

    def then(self, step: Callable[[T], U]) -> Call[U]:
        """The same with a further step."""
        return Call(self.path, lambda response: step(self.read(response)), self.query, self.json)


def document(response: Response) -> Any:
    """The JSON of an answer."""
    return answer(response.json())


def get(path: str, query: Mapping[str, Any]) -> Call[Any]:
    """Any path that answers JSON."""
    return Call(path, document, written.query(query))


def places() -> Call[geopandas.GeoDataFrame]:
    """The named places of a scene."""
    return Call(f"{SCENE}/places", document).then(points)


def sky(lat: float, lon: float, asked: Mapping[str, Any]) -> Call[Answer]:
    """The numbers of a sky."""
    return get(f"{SCENE}/sky", {"lat": lat, "lon": lon, **asked})


def skies(places: Sequence[Mapping[str, Any]], asked: Mapping[str, Any]) -> Call[list[Answer | ProblemError]]:
    """The numbers of many skies, in their order; where one has none, the reason."""
    body = {"places": [written.query(place) for place in places]}
    call = Call(f"{SCENE}/skies", lambda response: response.content, written.query(asked), body)
    return call.then(lambda content: _lines(content, len(places)))


def _lines(content: bytes, count: int) -> list[Answer | ProblemError]:
    lines = [json.loads(line) for line in content.split(b"\n") if line]
    if len(lines) != count:
        raise UnreachableError(f"the answer ended after {len(lines)} of {count} skies")
    return [problem_in(line["error"]) if "error" in line else answer(line) for line in lines]


def panorama(lat: float, lon: float, asked: Mapping[str, Any]) -> Call[xarray.Dataset]:
    """The samples of a sky."""
    query = written.query({"lat": lat, "lon": lon, **asked})
    return Call(f"{SCENE}/panorama.json", lambda response: datasets.panorama(response.json()), query)


def panoramas(
    lat: float, lon: float, asked: Mapping[str, Any], responses: Iterable[str] | None, times: Iterable[Any] | None
) -> list[list[Call[xarray.Dataset]]]:
    """The samples of a sky by response and by time, where these are asked for."""
    by_response = [{}] if responses is None else [{"response": name} for name in responses]
    by_time = [{}] if times is None else [{"time": time} for time in times]
    if not by_response or not by_time:
        raise ValueError("no response or no time is asked for")
    return [[panorama(lat, lon, {**asked, **of, **at}) for at in by_time] for of in by_response]


def picture(lat: float, lon: float, asked: Mapping[str, Any]) -> Call[bytes]:
    """A picture that the server draws."""
    query = written.query({"lat": lat, "lon": lon, **asked})
    return Call(f"{SCENE}/panorama.png", lambda response: response.content, query)


def influence(lat: float, lon: float, boundary: Any, asked: Mapping[str, Any]) -> Call[geopandas.GeoDataFrame]:
    """Which lights cause a sky."""
    query = written.query({"lat": lat, "lon": lon, **asked})
    given = None if boundary is None else {"boundary": written.body(boundary)}
    return Call(f"{SCENE}/influence.json", document, query, given).then(_influential)


def _influential(said: Answer) -> geopandas.GeoDataFrame:
    return points(said["pixels"], {name: value for name, value in said.items() if name != "pixels"})


def shares(lat: float, lon: float, areas: Any, asked: Mapping[str, Any]) -> Call[geopandas.GeoDataFrame]:
    """Whose light a sky is: by named places, or by areas."""
    query = written.query({"lat": lat, "lon": lon, **asked})
    if areas is None:
        call = Call(f"{SCENE}/shares", document, query)
        return call.then(lambda said: _ranked(points(said["places"]), said, "places"))
    body = written.body(areas)
    given = geopandas.GeoDataFrame.from_features(body["features"], crs="EPSG:4326")

    def of_areas(said: Answer) -> geopandas.GeoDataFrame:
        table = pandas.DataFrame(said["areas"])
        where = given.geometry.iloc[table["feature"].to_numpy() - 1].to_numpy()
        return _ranked(geopandas.GeoDataFrame(table, geometry=where, crs="EPSG:4326"), said, "areas")

    return Call(f"{SCENE}/shares", document, query, body).then(of_areas)


def _ranked(frame: geopandas.GeoDataFrame, said: Answer, name: str) -> geopandas.GeoDataFrame:
    frame.attrs = {each: value for each, value in said.items() if each != name}
    return frame


def influence_map(lat: float, lon: float, asked: Mapping[str, Any]) -> Call[xarray.DataArray]:
    """The influence of every lit pixel on the scene's own grid."""
    query = written.query({"lat": lat, "lon": lon, **asked})
    return Call(f"{SCENE}/influence.tif", datasets.raster("influence"), query)


def layer(name: str, asked: Mapping[str, Any]) -> Call[xarray.DataArray]:
    """A layer on the scene's own grid."""
    return Call(f"{SCENE}/layers/{name}.tif", datasets.raster(name), written.query(asked))


def plan(request: Mapping[str, Any], asked: Mapping[str, Any]) -> Call[Plan]:
    """What to dim."""
    return Call(f"{SCENE}/plans", document, written.query(asked), written.body(request)).then(Plan)


def scenario(request: Mapping[str, Any], asked: Mapping[str, Any]) -> Call[Answer]:
    """Edits to the lights of a scene."""
    return Call(f"{SCENE}/scenarios", document, written.query(asked), written.body(request))


def night(lat: float, lon: float, date: Any) -> Call[Answer]:
    """Rise, set and twilights of a night."""
    return get("/api/v1/night", {"lat": lat, "lon": lon, "date": date})


def nights(lat: float, lon: float, month: Any) -> Call[pandas.DataFrame]:
    """How long the nights of a month are dark."""
    return get("/api/v1/nights", {"lat": lat, "lon": lon, "month": month}).then(_calendar)


def _calendar(said: Answer) -> pandas.DataFrame:
    table = pandas.DataFrame(said["nights"])
    table["date"] = pandas.to_datetime(table["date"])
    table = table.set_index("date")
    table.attrs = {name: value for name, value in said.items() if name != "nights"}
    return table


def parameters(document: Mapping[str, Any], operation: str) -> pandas.DataFrame:
    """The query parameters of an operation, such as ``get_sky``, as the server's own document describes them."""
    known = {}
    for item in document["paths"].values():
        for described in item.values():
            known[described["operationId"]] = described
    if operation not in known:
        raise KeyError(f"the server has no operation {operation!r}; it has {', '.join(sorted(known))}")
    rows = [
        {
            "parameter": entry["name"],
            "required": entry.get("required", False),
            "default": entry["schema"].get("default"),
            "description": entry.get("description", ""),
        }
        for entry in known[operation]["parameters"]
        if entry["in"] == "query"
    ]
    return pandas.DataFrame(rows).set_index("parameter")
