"""What can be asked, whoever answers: the methods that `Client` and `Engine` have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeVar

import geopandas
import pandas
import xarray

from . import batches, calls, datasets
from .answers import Answer, Plan
from .calls import Call
from .errors import SkyglowError

T = TypeVar("T")
DOCUMENT = "/api/v1/openapi.json"


class Scenes:
    """What is known of whom one asks: which scene where nobody says, and the interface's document once it was read."""

    scene: str | None
    _document: dict[str, Any] | None = None

    def _only(self, scenes: Sequence[Answer]) -> str:
        if len(scenes) != 1:
            known = ", ".join(scene["id"] for scene in scenes) or "none"
            raise SkyglowError(f"say which scene: scene=... there or here; there are {known}")
        self.scene = str(scenes[0]["id"])
        return self.scene


class Questions(Scenes, ABC):
    """Questions about skies and lights, and their answers.

    ``asked`` of every method are the program's own parameters (``turbidity=3``, ``lamp="led_4000k"``,
    ``time=...``): :meth:`parameters` lists them, and the program checks them. ``scene`` may be left out where
    there is one scene alone.
    """

    @abstractmethod
    def _answer(self, call: Call[T]) -> T:
        """Asks, and reads what comes."""

    def _of_scene(self, call: Call[T], scene: str | None) -> T:
        return self._answer(call.at(scene or self.scene or self._only(self.scenes())))

    def get(self, path: str, **query: Any) -> Any:
        """Whatever JSON a path of the HTTP interface answers, such as ``/api/v1/atmospheres``."""
        return self._answer(calls.get(path, query))

    def parameters(self, operation: str = "get_sky") -> pandas.DataFrame:
        """The parameters that an operation takes, with their defaults and meanings, as the program tells them."""
        if self._document is None:
            self._document = self.get(DOCUMENT)
        return calls.parameters(self._document or {}, operation)

    def scenes(self) -> list[Answer]:
        """The scenes there are."""
        return list(self.get("/api/v1/scenes"))

    def atmospheres(self) -> list[Answer]:
        """The resident table packs: which turbidities, orders of scattering and clouds can be asked for."""
        return list(self.get("/api/v1/atmospheres"))

    def places(self, *, scene: str | None = None) -> geopandas.GeoDataFrame:
        """The named places of a scene as points."""
        return self._of_scene(calls.places(), scene)

    def sky(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> Answer:
        """The numbers of a sky: ``.sky`` has them, ``.night_sky`` what shines at a time; all else, assumptions."""
        return self._of_scene(calls.sky(lat, lon, asked), scene)

    def panorama(
        self,
        lat: float,
        lon: float,
        *,
        responses: Iterable[str] | None = None,
        times: Iterable[Any] | None = None,
        scene: str | None = None,
        **asked: Any,
    ) -> xarray.Dataset:
        """A sky by direction: ``luminance`` and ``brightness`` by elevation and azimuth, ``radiance`` by band.

        ``response=`` asks what one eye or instrument sees; ``responses=`` several, along a dimension
        ``response``. ``time=`` asks for one time, ``times=`` for several, along a dimension ``time``: ``to_zarr`` and
        ``to_netcdf`` keep such a cube. Below the observer's horizon all is NaN.
        """
        asked_by = calls.panoramas(lat, lon, asked, responses, times)
        skies = [[self._of_scene(call, scene) for call in of_response] for of_response in asked_by]
        return datasets.cube(skies, has_responses=responses is not None, has_times=times is not None)

    def picture(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> bytes:
        """A sky as the program draws it, as PNG: ``style="eye"``, ``projection="fisheye"`` and others."""
        return self._of_scene(calls.picture(lat, lon, asked), scene)

    def influence(
        self, lat: float, lon: float, *, boundary: Any = None, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """Which lights cause a sky: the ``limit`` most influential pixels as points.

        ``boundary`` is an area, as GeoJSON, of shapely or of geopandas. ``frame.attrs`` has the rest of the
        answer: ``total``, ``rings``, ``sectors``, ``boundary`` with its share, and the assumptions.
        """
        return self._of_scene(calls.influence(lat, lon, boundary, asked), scene)

    def shares(
        self, lat: float, lon: float, *, areas: Any = None, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """Whose light a sky is: the named places with the largest shares, as points, or areas with theirs.

        ``areas`` are a table of geopandas or a GeoJSON FeatureCollection, whose features have names
        (``name_field`` says which property). ``frame.attrs`` has the rest: ``total``, ``elsewhere`` or ``outside``.
        """
        return self._of_scene(calls.shares(lat, lon, areas, asked), scene)

    def influence_map(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> xarray.DataArray:
        """The influence of every lit pixel, on the scene's own grid (needs rasterio)."""
        return self._of_scene(calls.influence_map(lat, lon, asked), scene)

    def layer(self, name: str, *, scene: str | None = None, **asked: Any) -> xarray.DataArray:
        """``brightness``, ``radiance`` or ``elevation`` on the scene's own grid (needs rasterio)."""
        return self._of_scene(calls.layer(name, asked), scene)

    def plan(self, request: Mapping[str, Any], *, scene: str | None = None, **asked: Any) -> Plan:
        """What to dim: ``request`` is the body of ``POST .../plans``; areas may be of geopandas.

        ``.frame()`` lists the dimmed pixels; ``.sites`` has each sky before and after.
        """
        return self._of_scene(calls.plan(request, asked), scene)

    def scenario(self, request: Mapping[str, Any], *, scene: str | None = None, **asked: Any) -> Answer:
        """Other lights: ``request`` is the body of ``POST .../scenarios``.

        Pass the answer's ``id`` as ``scenario=`` to every question about light.
        """
        return self._of_scene(calls.scenario(request, asked), scene)

    def night(self, lat: float, lon: float, date: Any) -> Answer:
        """Rise, set and twilights of the night that begins on a date, its Moon, and when it is dark."""
        return self._answer(calls.night(lat, lon, date))

    def nights(self, lat: float, lon: float, month: str) -> pandas.DataFrame:
        """How long the nights of a month (``2026-08``) are dark, by date."""
        return self._answer(calls.nights(lat, lon, month))

    def skies(
        self,
        places: batches.Places,
        *,
        times: Iterable[Any] | None = None,
        keep_problems: bool = False,
        scene: str | None = None,
        **asked: Any,
    ) -> geopandas.GeoDataFrame:
        """The numbers of the skies of many places, as a table of points: one request for each thousand.

        ``places`` are pairs of latitude and longitude, points of geopandas, or a table with ``latitude_deg`` and
        ``longitude_deg``; a column ``time`` says when, for each, and ``times`` asks for every place at each of
        them. With ``keep_problems`` a place without an answer has the reason in a column ``problem``; otherwise
        the first one is raised.
        """
        table = batches.table(places, times)
        parts = batches.parts(table)
        found = [sky for part in parts for sky in self._of_scene(calls.skies(part, asked), scene)]
        return batches.frame(table, found, keep_problems=keep_problems)
