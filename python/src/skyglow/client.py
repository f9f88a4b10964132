"""The two clients: `Client` waits for answers, `AsyncClient` is for asyncio; both have one interface."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Self, TypeVar

import geopandas
import httpx
import pandas
import xarray

from . import batches, calls, datasets
from .answers import Answer, Plan
from .calls import Call
from .errors import ProblemError, SkyglowError, UnreachableError, problem_of, retry_after_s

T = TypeVar("T")
OWNER = "Skyglow-Owner"
DOCUMENT = "/api/v1/openapi.json"


class _Settings:
    """What both clients know of a server, and what they make of its responses."""

    def __init__(
        self, scene: str | None, key: str | None, owner: str | None, patience_s: float, concurrency: int
    ) -> None:
        if concurrency < 1:
            raise ValueError(f"concurrency must be at least 1, not {concurrency}")
        self.scene = scene
        self.owner = owner
        self.patience_s = patience_s
        self.concurrency = concurrency
        self._key = key
        self._document: dict[str, Any] | None = None

    def _request(self, call: Call[Any]) -> dict[str, Any]:
        headers = {}
        if self._key:
            headers["Authorization"] = f"Bearer {self._key}"
        if self.owner:
            headers[OWNER] = self.owner
        method = "GET" if call.json is None else "POST"
        request = {"method": method, "url": call.path, "params": call.query, "headers": headers}
        return request if call.json is None else {**request, "json": call.json}

    def _pause_s(self, response: httpx.Response, waited_s: float) -> float | None:
        """How long to wait before asking again; None where the response is the answer."""
        pause_s = retry_after_s(response)
        if pause_s is None or waited_s + pause_s > self.patience_s:
            return None
        # A server that says 0 is not asked in a tight circle.
        return max(pause_s, 0.1)

    def _read(self, call: Call[T], response: httpx.Response) -> T:
        if response.is_error or response.is_redirect:
            raise problem_of(response)
        self.owner = response.headers.get(OWNER, self.owner)
        return call.read(response)

    def _only(self, scenes: Sequence[Answer]) -> str:
        if len(scenes) != 1:
            known = ", ".join(scene["id"] for scene in scenes) or "none"
            raise SkyglowError(f"say which scene: Client(url, scene=...) or scene=...; the server has {known}")
        self.scene = str(scenes[0]["id"])
        return self.scene


class Client(_Settings):
    """A Skyglow server.

    ``asked`` of every method are the server's own parameters (``turbidity=3``, ``lamp="led_4000k"``,
    ``time=...``): :meth:`parameters` lists them, and the server checks them. ``scene`` may be left out where the
    server has one scene alone. ``key`` is sent as a bearer token; ``owner`` is the secret under which scenarios
    and plans are kept: the server hands one out with the first, and this client keeps it in ``owner``. Where the
    server is busy or still makes a map, the client waits and asks again, ``patience_s`` seconds in all.
    """

    def __init__(
        self,
        url: str = "http://127.0.0.1:8080",
        *,
        scene: str | None = None,
        key: str | None = None,
        owner: str | None = None,
        timeout_s: float = 120.0,
        patience_s: float = 300.0,
        concurrency: int = 4,
    ) -> None:
        super().__init__(scene, key, owner, patience_s, concurrency)
        self._http = httpx.Client(base_url=url, timeout=timeout_s)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections."""
        self._http.close()

    def _answer(self, call: Call[T]) -> T:
        waited_s = 0.0
        while True:
            try:
                response = self._http.request(**self._request(call))
            except httpx.TransportError as error:
                raise UnreachableError(f"no answer from {self._http.base_url}: {error!r}") from error
            pause_s = self._pause_s(response, waited_s)
            if pause_s is None:
                return self._read(call, response)
            time.sleep(pause_s)
            waited_s += pause_s

    def _of_scene(self, call: Call[T], scene: str | None) -> T:
        return self._answer(call.at(scene or self.scene or self._only(self.scenes())))

    def get(self, path: str, **query: Any) -> Any:
        """Whatever JSON a path of the server answers, such as ``/api/v1/atmospheres``."""
        return self._answer(calls.get(path, query))

    def parameters(self, operation: str = "get_sky") -> pandas.DataFrame:
        """The parameters that an operation takes, with their defaults and meanings, as the server tells them."""
        if self._document is None:
            self._document = self.get(DOCUMENT)
        return calls.parameters(self._document or {}, operation)

    def scenes(self) -> list[Answer]:
        """The scenes of the server."""
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
        scene: str | None = None,
        **asked: Any,
    ) -> xarray.Dataset:
        """A sky by direction: ``luminance`` and ``brightness`` by elevation and azimuth, ``radiance`` by band.

        ``response=`` asks what one eye or instrument sees; ``responses=`` several, along a dimension
        ``response``. Below the observer's horizon all is NaN.
        """
        if responses is None:
            return self._of_scene(calls.panorama(lat, lon, asked), scene)
        each = [calls.panorama(lat, lon, {**asked, "response": name}) for name in responses]
        return datasets.together([self._of_scene(call, scene) for call in each])

    def picture(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> bytes:
        """A sky as the server draws it, as PNG: ``style="eye"``, ``projection="fisheye"`` and others."""
        return self._of_scene(calls.picture(lat, lon, asked), scene)

    def influence(
        self, lat: float, lon: float, *, boundary: Any = None, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """Which lights cause a sky: the ``limit`` most influential pixels as points.

        ``boundary`` is an area, as GeoJSON, of shapely or of geopandas. ``frame.attrs`` has the rest of the
        answer: ``total``, ``rings``, ``sectors``, ``boundary`` with its share, and the assumptions.
        """
        return self._of_scene(calls.influence(lat, lon, boundary, asked), scene)

    def influence_map(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> xarray.DataArray:
        """The influence of every lit pixel, on the scene's own grid (needs rasterio)."""
        return self._of_scene(calls.influence_map(lat, lon, asked), scene)

    def layer(self, name: str, *, scene: str | None = None, **asked: Any) -> xarray.DataArray:
        """``brightness``, ``radiance`` or ``elevation`` on the scene's own grid (needs rasterio)."""
        return self._of_scene(calls.layer(name, asked), scene)

    def plan(self, request: Mapping[str, Any], *, scene: str | None = None, **asked: Any) -> Plan:
        """What to dim: ``request`` is the body of the server's ``POST .../plans``; areas may be of geopandas.

        ``.frame()`` lists the dimmed pixels; ``.sites`` has each sky before and after.
        """
        return self._of_scene(calls.plan(request, asked), scene)

    def scenario(self, request: Mapping[str, Any], *, scene: str | None = None, **asked: Any) -> Answer:
        """Other lights: ``request`` is the body of the server's ``POST .../scenarios``.

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
        self, places: batches.Places, *, keep_problems: bool = False, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """The numbers of the skies of many places, ``concurrency`` at a time, as a table of points.

        ``places`` are pairs of latitude and longitude, points of geopandas, or a table with ``latitude_deg`` and
        ``longitude_deg``; a column ``time`` says when, for each. With ``keep_problems`` a place without an
        answer has the reason in a column ``problem``; otherwise the first one is raised.
        """
        table = batches.table(places)
        if scene is None and self.scene is None:
            self._only(self.scenes())

        def ask(where: Mapping[str, Any]) -> Answer | ProblemError:
            try:
                return self.sky(scene=scene, **{**asked, **where})
            except ProblemError as problem:
                if keep_problems:
                    return problem
                raise

        with ThreadPoolExecutor(self.concurrency) as threads:
            waiting = [threads.submit(ask, where) for where in batches.questions(table)]
            try:
                found = [one.result() for one in waiting]
            except BaseException:
                threads.shutdown(cancel_futures=True)
                raise
        return batches.frame(table, found)


class AsyncClient(_Settings):
    """A Skyglow server, for asyncio: the methods of :class:`Client`, each to be awaited."""

    def __init__(
        self,
        url: str = "http://127.0.0.1:8080",
        *,
        scene: str | None = None,
        key: str | None = None,
        owner: str | None = None,
        timeout_s: float = 120.0,
        patience_s: float = 300.0,
        concurrency: int = 4,
    ) -> None:
        super().__init__(scene, key, owner, patience_s, concurrency)
        self._http = httpx.AsyncClient(base_url=url, timeout=timeout_s)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """Closes the connections."""
        await self._http.aclose()

    async def _answer(self, call: Call[T]) -> T:
        waited_s = 0.0
        while True:
            try:
                response = await self._http.request(**self._request(call))
            except httpx.TransportError as error:
                raise UnreachableError(f"no answer from {self._http.base_url}: {error!r}") from error
            pause_s = self._pause_s(response, waited_s)
            if pause_s is None:
                return self._read(call, response)
            await asyncio.sleep(pause_s)
            waited_s += pause_s

    async def _of_scene(self, call: Call[T], scene: str | None) -> T:
        return await self._answer(call.at(scene or self.scene or self._only(await self.scenes())))

    async def get(self, path: str, **query: Any) -> Any:
        """See :meth:`Client.get`."""
        return await self._answer(calls.get(path, query))

    async def parameters(self, operation: str = "get_sky") -> pandas.DataFrame:
        """See :meth:`Client.parameters`."""
        if self._document is None:
            self._document = await self.get(DOCUMENT)
        return calls.parameters(self._document or {}, operation)

    async def scenes(self) -> list[Answer]:
        """See :meth:`Client.scenes`."""
        return list(await self.get("/api/v1/scenes"))

    async def atmospheres(self) -> list[Answer]:
        """See :meth:`Client.atmospheres`."""
        return list(await self.get("/api/v1/atmospheres"))

    async def places(self, *, scene: str | None = None) -> geopandas.GeoDataFrame:
        """See :meth:`Client.places`."""
        return await self._of_scene(calls.places(), scene)

    async def sky(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> Answer:
        """See :meth:`Client.sky`."""
        return await self._of_scene(calls.sky(lat, lon, asked), scene)

    async def panorama(
        self,
        lat: float,
        lon: float,
        *,
        responses: Iterable[str] | None = None,
        scene: str | None = None,
        **asked: Any,
    ) -> xarray.Dataset:
        """See :meth:`Client.panorama`."""
        if responses is None:
            return await self._of_scene(calls.panorama(lat, lon, asked), scene)
        each = [calls.panorama(lat, lon, {**asked, "response": name}) for name in responses]
        return datasets.together([await self._of_scene(call, scene) for call in each])

    async def picture(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> bytes:
        """See :meth:`Client.picture`."""
        return await self._of_scene(calls.picture(lat, lon, asked), scene)

    async def influence(
        self, lat: float, lon: float, *, boundary: Any = None, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """See :meth:`Client.influence`."""
        return await self._of_scene(calls.influence(lat, lon, boundary, asked), scene)

    async def influence_map(
        self, lat: float, lon: float, *, scene: str | None = None, **asked: Any
    ) -> xarray.DataArray:
        """See :meth:`Client.influence_map`."""
        return await self._of_scene(calls.influence_map(lat, lon, asked), scene)

    async def layer(self, name: str, *, scene: str | None = None, **asked: Any) -> xarray.DataArray:
        """See :meth:`Client.layer`."""
        return await self._of_scene(calls.layer(name, asked), scene)

    async def plan(self, request: Mapping[str, Any], *, scene: str | None = None, **asked: Any) -> Plan:
        """See :meth:`Client.plan`."""
        return await self._of_scene(calls.plan(request, asked), scene)

    async def scenario(self, request: Mapping[str, Any], *, scene: str | None = None, **asked: Any) -> Answer:
        """See :meth:`Client.scenario`."""
        return await self._of_scene(calls.scenario(request, asked), scene)

    async def night(self, lat: float, lon: float, date: Any) -> Answer:
        """See :meth:`Client.night`."""
        return await self._answer(calls.night(lat, lon, date))

    async def nights(self, lat: float, lon: float, month: str) -> pandas.DataFrame:
        """See :meth:`Client.nights`."""
        return await self._answer(calls.nights(lat, lon, month))

    async def skies(
        self, places: batches.Places, *, keep_problems: bool = False, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """See :meth:`Client.skies`."""
        table = batches.table(places)
        if scene is None and self.scene is None:
            self._only(await self.scenes())
        room = asyncio.Semaphore(self.concurrency)

        async def ask(where: Mapping[str, Any]) -> Answer | ProblemError:
            async with room:
                try:
                    return await self.sky(scene=scene, **{**asked, **where})
                except ProblemError as problem:
                    if keep_problems:
                        return problem
                    raise

        asking = [asyncio.ensure_future(ask(where)) for where in batches.questions(table)]
        try:
            return batches.frame(table, await asyncio.gather(*asking))
        except BaseException:
            for one in asking:
                one.cancel()
            raise
