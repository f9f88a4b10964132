"""The two clients of a server: `Client` waits for answers, `AsyncClient` is for asyncio; both have one interface."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterable, Mapping
from typing import Any, Self, TypeVar

import geopandas
import httpx
import pandas
import xarray

from . import batches, calls, datasets
from .answers import Answer, Plan
from .calls import Call
from .errors import UnreachableError, problem_of, retry_after_s
from .questions import DOCUMENT, Questions, Scenes

T = TypeVar("T")
OWNER = "Skyglow-Owner"


class _Settings(Scenes):
    """What both clients know of a server, and what they make of its responses."""

    def __init__(self, scene: str | None, key: str | None, owner: str | None, patience_s: float) -> None:
        self.scene = scene
        self.owner = owner
        self.patience_s = patience_s
        self._key = key

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


class Client(_Settings, Questions):
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
    ) -> None:
        super().__init__(scene, key, owner, patience_s)
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
    ) -> None:
        super().__init__(scene, key, owner, patience_s)
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
        times: Iterable[Any] | None = None,
        scene: str | None = None,
        **asked: Any,
    ) -> xarray.Dataset:
        """See :meth:`Client.panorama`."""
        asked_by = calls.panoramas(lat, lon, asked, responses, times)
        skies = [[await self._of_scene(call, scene) for call in of_response] for of_response in asked_by]
        return datasets.cube(skies, has_responses=responses is not None, has_times=times is not None)

    async def picture(self, lat: float, lon: float, *, scene: str | None = None, **asked: Any) -> bytes:
        """See :meth:`Client.picture`."""
        return await self._of_scene(calls.picture(lat, lon, asked), scene)

    async def influence(
        self, lat: float, lon: float, *, boundary: Any = None, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """See :meth:`Client.influence`."""
        return await self._of_scene(calls.influence(lat, lon, boundary, asked), scene)

    async def shares(
        self, lat: float, lon: float, *, areas: Any = None, scene: str | None = None, **asked: Any
    ) -> geopandas.GeoDataFrame:
        """See :meth:`Client.shares`."""
        return await self._of_scene(calls.shares(lat, lon, areas, asked), scene)

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
        self,
        places: batches.Places,
        *,
        times: Iterable[Any] | None = None,
        keep_problems: bool = False,
        scene: str | None = None,
        **asked: Any,
    ) -> geopandas.GeoDataFrame:
        """See :meth:`Client.skies`."""
        table = batches.table(places, times)
        parts = batches.parts(table)
        found = [sky for part in parts for sky in await self._of_scene(calls.skies(part, asked), scene)]
        return batches.frame(table, found, keep_problems=keep_problems)
