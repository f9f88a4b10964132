"""A map in a notebook; a click gives the sky of the place. Needs ``pip install 'skyglow[widget]'``.

    sky = skyglow.widget.Sky(skyglow.Client("http://127.0.0.1:8080"), lat=46.17, lon=8.79)
    sky  # shows it
    sky.observe(lambda change: print(change.new["sky"]["bortle_class"]), "sky")

Pictures come through the notebook's own connection, so the browser need not reach the server.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import geopandas

from . import charts
from .errors import SkyglowError
from .maps import Bounds
from .questions import Questions

try:
    import anywidget
    import traitlets
except ModuleNotFoundError as error:
    raise ImportError("the widget needs anywidget: pip install 'skyglow[widget]'") from error

# Of a map's picture: what a server draws at most.
MAX_SIDE_PX = 2048
# Names on a map at most; the browser leaves out those without room.
MAX_NAMES = 40
# No larger, for the letters in it do not grow with it.
PICTURE = {"projection": "fisheye", "width": 560, "height_px": 560}


class Sky(anywidget.AnyWidget):
    """A map of a scene beside the sky of a place of it.

    ``source`` is a :class:`skyglow.Client` or a :class:`skyglow.Engine`; ``asked`` are the parameters of
    ``source.sky``. ``picture`` are those of a picture of the sky, such as ``{"style": "eye"}``.

    ``lat``, ``lon`` and ``sky`` (the answer as a dictionary, None where there is none) can be observed; so can
    ``problem``, which says why there is no sky. :meth:`go` goes to a place, as a click does, and :meth:`ask` changes
    the parameters.
    """

    _esm = Path(__file__).with_name("widget.js")
    _css = Path(__file__).with_name("widget.css")

    lat = traitlets.Float(None, allow_none=True, help="Latitude, degrees north.").tag(sync=True)
    lon = traitlets.Float(None, allow_none=True, help="Longitude, degrees east.").tag(sync=True)
    sky: Any = traitlets.Dict(None, allow_none=True, help="The numbers of the sky there.").tag(sync=True)
    problem = traitlets.Unicode("", help="Why there is no sky.").tag(sync=True)
    bounds = traitlets.List(traitlets.Float(), help="West, south, east and north of the scene.").tag(sync=True)
    title = traitlets.Unicode("", help="The scene's name.").tag(sync=True)
    picture = traitlets.Bytes(b"", help="The sky as PNG.").tag(sync=True)
    is_busy = traitlets.Bool(False, help="Whether a sky is being made.").tag(sync=True)

    def __init__(
        self,
        source: Questions,
        scene: str | None = None,
        lat: float | None = None,
        lon: float | None = None,
        *,
        picture: Mapping[str, Any] | None = None,
        **asked: Any,
    ) -> None:
        if (lat is None) != (lon is None):
            raise ValueError("a place has lat and lon")
        if not isinstance(source, Questions):
            raise TypeError("source: a skyglow.Client or a skyglow.Engine, which answer without being awaited")
        self._source = source
        self._scene = scene or source.scene or source._only(source.scenes())
        self._asked, self._picture = dict(asked), {**PICTURE, **(picture or {})}
        self._chart: charts.Chart | None = None
        self._places: geopandas.GeoDataFrame | None = None
        self._shown: tuple[float, float] | None = None
        self._failure: SkyglowError | None = None
        said = source.get(f"/api/v1/scenes/{self._scene}")
        super().__init__(bounds=[float(side) for side in said["bounds"]], title=said["title"])
        self.on_msg(self._told)
        self.observe(self._moved, ["lat", "lon"])
        if lat is not None and lon is not None:
            self.go(lat, lon)
            if self._failure is not None:
                raise self._failure

    def go(self, lat: float, lon: float) -> None:
        """Goes to a place, and asks for its sky; ``problem`` says why where there is none."""
        self._shown = (float(lat), float(lon))
        with self.hold_trait_notifications():
            self.lat, self.lon = self._shown
        self._ask()

    def ask(self, *, picture: Mapping[str, Any] | None = None, **asked: Any) -> None:
        """Changes parameters (None takes one away), and asks for the sky and the map again."""
        kept = {**self._asked, **asked}
        self._asked = {name: value for name, value in kept.items() if value is not None}
        self._picture.update(picture or {})
        self._chart = None
        if self._shown is not None:
            self._ask()
        self.send({"kind": "map-changed"})

    def _moved(self, _: Any) -> None:
        """By ``sky.lat = ...``, or a link to another widget."""
        if self.lat is not None and self.lon is not None and self._shown != (self.lat, self.lon):
            self._shown = (self.lat, self.lon)
            self._ask()

    def _ask(self) -> None:
        if self._shown is None:
            return
        lat, lon = self._shown
        self.is_busy, self._failure = True, None
        try:
            asked = {"scene": self._scene, **self._asked}
            sky = self._source.sky(lat, lon, **asked)
            picture = self._source.picture(lat, lon, **{**asked, **self._picture})
            with self.hold_sync():
                self.picture, self.problem = picture, ""
                self.sky = sky
        except SkyglowError as error:
            self._failure = error
            with self.hold_sync():
                self.sky, self.picture, self.problem = None, b"", str(error)
        finally:
            self.is_busy = False

    def _told(self, _: Any, said: Any, __: Any) -> None:
        """What the browser says: a place was chosen, or a part of the map is looked at."""
        match said:
            case {"kind": "place", "lat": int() | float() as lat, "lon": int() | float() as lon}:
                self.go(lat, lon)
            case {"kind": "map", "bounds": [_, _, _, _] as bounds, "size_px": [int() as width, int() as height]}:
                self._draw(bounds, (width, height))

    def _draw(self, bounds: list[float], size_px: tuple[int, int]) -> None:
        west, south, east, north = bounds
        width, height = (min(max(side, 1), MAX_SIDE_PX) for side in size_px)
        try:
            if self._chart is None:
                self._chart = charts.chart(self._source, self._scene, self._asked)
            picture = self._chart.draw((_turned(west), south, _turned(east), north), (width, height))
        except (SkyglowError, ImportError) as error:
            self.send({"kind": "map-problem", "text": str(error)})
            return
        names = self._names((west, south, east, north))
        self.send({"kind": "map", "bounds": bounds, "places": names}, buffers=[picture])

    def _names(self, bounds: Bounds) -> list[dict[str, Any]]:
        """The largest places within bounds, the largest first."""
        if self._places is None:
            found = self._source.places(scene=self._scene)
            if "population" in found:
                found = found.sort_values("population", ascending=False, na_position="last", kind="stable")
            self._places = found
        west, south, east, north = bounds
        frame = self._places
        is_within = ((frame["longitude_deg"] - west) % 360.0 <= east - west) & frame["latitude_deg"].between(
            south, north
        )
        rows = frame.loc[is_within, ["name", "latitude_deg", "longitude_deg"]].head(MAX_NAMES)
        return [
            {"name": row.name_, "lat": row.latitude_deg, "lon": row.longitude_deg}
            for row in rows.rename(columns={"name": "name_"}).itertuples(index=False)
        ]


def _turned(longitude_deg: float) -> float:
    """The same between -180 and 180 degrees."""
    turned = (longitude_deg + 180.0) % 360.0 - 180.0
    return 180.0 if turned == -180.0 and longitude_deg > 0 else turned
