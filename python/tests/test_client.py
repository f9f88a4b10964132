"""Both clients against a real server, and what they do when it is busy against a made-up one."""

import asyncio
import inspect
import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import geopandas
import geopandas.testing
import httpx
import numpy as np
import pandas
import pytest
import shapely
from conftest import TOWN, VALLEY

import skyglow

NIGHT = "2026-08-12T23:00:00Z"


def test_scenes_and_places(client):
    scenes = client.scenes()
    assert [scene.id for scene in scenes] == ["demo"]
    assert scenes[0]["illustrative"] is True
    places = client.places()
    assert places.crs == "EPSG:4326"
    assert "Locarno" in set(places["name"])
    assert {pack.scattering for pack in client.atmospheres()} == {"multiple"}


def test_sky_has_the_servers_names(client):
    sky = client.sky(*TOWN, turbidity=3, lamp={"hps": 0.7, "led_4000k": 0.3}, terrain=False)
    assert sky.sky.zenith_luminance_cd_m2 == sky["sky"]["zenith_luminance_cd_m2"] > 1e-4
    assert sky.turbidity == 3
    assert sky.terrain_occlusion is False
    assert sky.lamp.mix == {"hps": pytest.approx(0.7), "led_4000k": pytest.approx(0.3)}
    with pytest.raises(AttributeError, match="the answer has no 'brightness'"):
        _ = sky.brightness


def test_both_clients_have_one_interface():
    def methods(of):
        return {name: method for name, method in inspect.getmembers(of, callable) if not name.startswith("_")}

    waiting, asynchronous = methods(skyglow.Client), methods(skyglow.AsyncClient)
    assert waiting.keys() == asynchronous.keys()
    for name, method in waiting.items():
        assert inspect.signature(method) == inspect.signature(asynchronous[name]), name
        assert inspect.iscoroutinefunction(asynchronous[name]), name
    assert inspect.signature(skyglow.Client.__init__) == inspect.signature(skyglow.AsyncClient.__init__)


def test_async_answers_are_those_of_the_other_client(client, url):
    async def ask():
        async with skyglow.AsyncClient(url) as other:
            return await asyncio.gather(
                other.sky(*TOWN),
                other.panorama(*TOWN, responses=["photopic", "scotopic"], times=[NIGHT]),
                other.influence(*VALLEY, limit=3),
                other.nights(*TOWN, "2026-08"),
                other.skies([TOWN, VALLEY]),
            )

    sky, panorama, influence, nights, skies = asyncio.run(ask())
    assert sky == client.sky(*TOWN)
    assert panorama.identical(client.panorama(*TOWN, responses=["photopic", "scotopic"], times=[NIGHT]))
    geopandas.testing.assert_geodataframe_equal(influence, client.influence(*VALLEY, limit=3))
    pandas.testing.assert_frame_equal(nights, client.nights(*TOWN, "2026-08"))
    geopandas.testing.assert_geodataframe_equal(skies, client.skies([TOWN, VALLEY]))


def test_wrong_parameters_are_listed(client):
    with pytest.raises(skyglow.InvalidRequestError) as caught:
        client.sky(*TOWN, turbidity=99, lamp="candle")
    problem = caught.value
    assert problem.status == 400
    assert {error.parameter for error in problem.errors} == {"turbidity", "lamp"}
    assert "allowed: 1.5 to 6" in str(problem)
    assert any(error.allowed.startswith("1.5 to 6") for error in problem.errors)
    with pytest.raises(skyglow.InvalidRequestError) as caught:
        client.sky(*TOWN, turbidty=3)
    assert caught.value.kind == "unknown-parameter"
    assert "turbidity" in str(caught.value)


def test_kinds_of_problems_are_exceptions_of_their_own(client, url):
    with pytest.raises(skyglow.OutsideSceneError) as caught:
        client.sky(0.0, 0.0)
    west, south, east, north = caught.value.bounds
    assert west < TOWN[1] < east
    assert south < TOWN[0] < north
    with pytest.raises(skyglow.NotFoundError, match="no such scene"):
        client.sky(*TOWN, scene="nowhere")
    with pytest.raises(skyglow.NotFoundError):
        client.get("/api/v1/nothing")
    with pytest.raises(skyglow.NotAllowedError), skyglow.Client(url, key="wrong") as wrong:
        wrong.scenes()
    with (
        pytest.raises(skyglow.UnreachableError, match="no answer from"),
        skyglow.Client("http://127.0.0.1:1") as nobody,
    ):
        nobody.scenes()


def test_parameters_come_from_the_servers_document(client):
    sky = client.parameters()
    assert "turbidity" in sky.index
    assert sky.loc["lat", "required"]
    assert "measure" in client.parameters("get_influence").index
    with pytest.raises(KeyError, match="get_influence"):
        client.parameters("get_weather")


def test_influences_are_points_with_shares(client):
    frame = client.influence(*VALLEY, limit=5, measure="horizontal")
    assert len(frame) == 5
    assert frame["share"].is_monotonic_decreasing
    assert frame.geometry.x.to_numpy() == pytest.approx(frame["longitude_deg"].to_numpy())
    assert frame.attrs["measure"] == "horizontal"
    sky = client.sky(*VALLEY)
    assert frame.attrs["total"] == pytest.approx(sky.sky.horizontal_illuminance_lx, rel=1e-3)
    none = client.influence(*VALLEY, limit=0)
    assert none.empty
    assert none.crs == "EPSG:4326"


def test_a_boundary_may_be_of_geopandas_in_any_projection(client):
    area = shapely.box(8.6, 45.9, 9.1, 46.3)
    of_shapely = client.influence(*VALLEY, boundary=area, limit=0).attrs["boundary"]
    projected = geopandas.GeoDataFrame(geometry=[area.segmentize(0.01)], crs="EPSG:4326").to_crs("EPSG:2056")
    of_geopandas = client.influence(*VALLEY, boundary=projected, limit=0).attrs["boundary"]
    assert 0.0 < of_shapely["share"] < 1.0
    assert of_geopandas["share"] == pytest.approx(of_shapely["share"], rel=0.02)


def test_shares_are_of_places_and_of_areas(client):
    towns = client.shares(*VALLEY, limit=5)
    assert len(towns) == 5
    assert towns["share"].is_monotonic_decreasing
    rest = towns.attrs["elsewhere"].share + towns.attrs["other_places"].share
    assert towns["share"].sum() + rest == pytest.approx(1.0)
    boxes = [shapely.box(8.7, 46.1, 8.9, 46.2), shapely.box(8.5, 46.0, 9.2, 46.4)]
    areas = geopandas.GeoDataFrame({"town": ["inner", "outer"]}, geometry=boxes, crs="EPSG:4326").to_crs("EPSG:3857")
    frame = client.shares(*VALLEY, areas=areas, name_field="town", measure="horizontal")
    assert list(frame["name"]) == ["outer", "inner"]
    assert frame.crs == "EPSG:4326"
    assert frame.geometry.iloc[1].equals_exact(boxes[0], 1e-9)
    assert frame.attrs["measure"] == "horizontal"
    with pytest.raises(skyglow.InvalidRequestError):
        client.shares(*VALLEY, areas=areas, name_field="mayor")


def test_shares_are_kept_as_geojson(url, client, tmp_path):
    """In one line, with the same areas and numbers as the server's own file."""
    boxes = [shapely.box(8.7, 46.1, 8.9, 46.2), shapely.box(8.5, 46.0, 9.2, 46.4)]
    areas = geopandas.GeoDataFrame({"town": ["inner", "outer"]}, geometry=boxes, crs="EPSG:4326")
    client.shares(*VALLEY, areas=areas, name_field="town").to_file(tmp_path / "shares.geojson")
    ours = geopandas.read_file(tmp_path / "shares.geojson")
    query = {"lat": VALLEY[0], "lon": VALLEY[1], "name_field": "town"}
    answer = httpx.post(f"{url}/api/v1/scenes/demo/shares.geojson", params=query, content=areas.to_json())
    assert answer.headers["content-type"] == "application/geo+json"
    (tmp_path / "theirs.geojson").write_bytes(answer.content)
    theirs = geopandas.read_file(tmp_path / "theirs.geojson")
    assert list(theirs["name"]) == list(theirs["town"]) == list(ours["name"]) == ["outer", "inner"]
    assert theirs.geometry.normalize().equals(ours.geometry.normalize())
    for name in ("rank", "share", "influence", "pixels"):
        assert list(theirs[name]) == list(ours[name]), name
    assert all(theirs.geometry.exterior.is_ccw)


def test_tables_are_kept_as_parquet(client, tmp_path):
    """In one line, with what the numbers depend on."""
    tables = {
        "skies": client.skies([TOWN, (0.0, 0.0)], keep_problems=True),
        "shares": client.shares(*VALLEY),
        "influence": client.influence(*VALLEY, limit=5),
        "none": client.influence(*VALLEY, limit=0),
    }
    for name, table in tables.items():
        table.to_parquet(tmp_path / f"{name}.parquet")
        again = geopandas.read_parquet(tmp_path / f"{name}.parquet")
        geopandas.testing.assert_geodataframe_equal(again, table, check_index_type=False)
        assert again.attrs == table.attrs, name
        assert again.attrs["scene"]["id"] == "demo"


def test_a_region_may_be_corners(client):
    frame = client.influence(*VALLEY, region=[(100, 10), (200, 10), (150, 50)], limit=1)
    assert frame.attrs["measure"] == "region"


def test_scenarios_and_plans_change_the_sky(client):
    before = client.sky(*TOWN).sky.zenith_luminance_cd_m2
    brush = {"points": [[TOWN[1], TOWN[0]]], "radius_m": 5000}
    dimmed = client.scenario({"edits": [{"brush": brush, "factor": 0.5}]}, listed=False)
    assert client.sky(*TOWN, scenario=dimmed.id).sky.zenith_luminance_cd_m2 < 0.9 * before
    assert client.owner, "the secret of what is kept stays with the client"
    site = {"lat": TOWN[0], "lon": TOWN[1], "reduce_by": 0.2}
    plan = client.plan({"method": "target", "sites": [site], "max_cut": 0.5}, limit=5)
    assert plan.sites[0].after == pytest.approx(0.8 * plan.sites[0].before, rel=0.01)
    assert client.sky(*TOWN, scenario=plan.id).sky.zenith_luminance_cd_m2 == pytest.approx(0.8 * before, rel=0.01)
    pixels = plan.frame()
    assert len(pixels) == 5
    assert pixels["cut"].between(0, 0.5).all()


def test_nights_are_tables_by_date(client):
    night = client.night(*TOWN, "2026-08-12")
    assert night.dark_hours == pytest.approx(sum(part.hours for part in night.dark_intervals))
    month = client.nights(*TOWN, "2026-08")
    assert len(month) == 31
    assert month.loc["2026-08-12", "dark_hours"] == pytest.approx(night.dark_hours, abs=1e-9)
    assert month.attrs["month"] == "2026-08"


def test_a_batch_keeps_order_and_columns(client):
    places = client.places().head(3)
    table = client.skies(places, turbidity=3)
    assert list(table["name"]) == list(places["name"])
    alone = client.sky(places.geometry.y.iloc[2], places.geometry.x.iloc[2], turbidity=3)
    assert table["zenith_luminance_cd_m2"].iloc[2] == alone.sky.zenith_luminance_cd_m2
    assert table.attrs["turbidity"] == 3
    timed = client.skies(pandas.DataFrame({"latitude_deg": [TOWN[0]], "longitude_deg": [TOWN[1]], "time": [NIGHT]}))
    assert timed["visible_stars"].iloc[0] > 0


def test_a_batch_can_keep_problems(client, url):
    places = [TOWN, (0.0, 0.0)]
    table = client.skies(places, keep_problems=True)
    assert pandas.isna(table["problem"].iloc[0])
    assert "outside" in table["problem"].iloc[1].lower()
    assert np.isnan(table["zenith_luminance_cd_m2"].iloc[1])
    with pytest.raises(skyglow.OutsideSceneError) as caught:
        client.skies(places)
    assert caught.value.bounds[0] < TOWN[1] < caught.value.bounds[2]

    async def ask():
        async with skyglow.AsyncClient(url) as other:
            await other.skies(places)

    with pytest.raises(skyglow.OutsideSceneError):
        asyncio.run(ask())
    with pytest.raises(ValueError, match="latitude_deg"):
        client.skies(pandas.DataFrame({"lat": [46.0]}))


class BusyServer:
    """Answers `status` with Retry-After so many times, then skies, of a batch at most so many; counts them."""

    def __init__(self, status, times, retry_after="0", at_most=1000):
        self.asked, self.batches = 0, []

        class Handler(BaseHTTPRequestHandler):
            def do_GET(handler):  # noqa: N805 - self is the server
                self.asked += 1
                is_busy = self.asked <= times
                handler.send_response(status if is_busy else 200)
                if is_busy and retry_after is not None:
                    handler.send_header("Retry-After", retry_after)
                handler.end_headers()
                handler.wfile.write(b'{"title": "Busy", "type": "/problems/busy"}' if is_busy else SKY)

            def do_POST(handler):  # noqa: N805 - self is the server
                body = json.loads(handler.rfile.read(int(handler.headers["Content-Length"])))
                self.batches.append(len(body["places"]))
                handler.send_response(200)
                handler.end_headers()
                handler.wfile.write((SKY + b"\n") * min(len(body["places"]), at_most))

            def log_message(self, *_):
                pass

        self._http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self._http.server_address[1]}"
        threading.Thread(target=self._http.serve_forever, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._http.shutdown()
        self._http.server_close()


SKY = b'{"sky": {"zenith_luminance_cd_m2": 1}, "observer": {"altitude_m": 0}, "coverage": 1, "warnings": []}'


@pytest.mark.parametrize("status", [429, 503])
def test_a_busy_server_is_asked_again(status):
    with BusyServer(status, 2) as busy, skyglow.Client(busy.url, scene="x") as client:
        assert client.sky(0, 0).coverage == 1
        assert busy.asked == 3

    async def ask(url):
        async with skyglow.AsyncClient(url, scene="x") as client:
            return await client.sky(0, 0)

    with BusyServer(status, 2) as busy:
        assert asyncio.run(ask(busy.url)).coverage == 1
        assert busy.asked == 3


def test_patience_ends():
    with BusyServer(503, 9, "5") as busy, skyglow.Client(busy.url, scene="x", patience_s=4) as client:
        with pytest.raises(skyglow.BusyError) as caught:
            client.sky(0, 0)
        assert caught.value.retry_after_s == 5
        assert busy.asked == 1
    with BusyServer(503, 9, None) as busy, skyglow.Client(busy.url, scene="x") as client:
        with pytest.raises(skyglow.BusyError):
            client.sky(0, 0)
        assert busy.asked == 1, "without Retry-After asking again does not help"


def test_a_batch_is_asked_by_the_thousand():
    places = pandas.DataFrame({"latitude_deg": range(700), "longitude_deg": 0.0, "name": "x"})
    with BusyServer(200, 0) as server, skyglow.Client(server.url, scene="x") as client:
        table = client.skies(places, times=["2026-08-12T22:00:00Z", "2026-08-12T23:00:00Z", NIGHT])
        assert server.batches == [1000, 1000, 100]
        assert list(table.index[:4]) == [0, 0, 0, 1]
        assert list(table["time"].iloc[:2]) == ["2026-08-12T22:00:00Z", "2026-08-12T23:00:00Z"]
        with pytest.raises(ValueError, match="times of their own"):
            client.skies(places.assign(time=NIGHT), times=[NIGHT])
    with BusyServer(200, 0, at_most=2) as server, skyglow.Client(server.url, scene="x") as client:
        assert len(client.skies([(0, 0), (0, 1)])) == 2
        with pytest.raises(skyglow.UnreachableError, match="after 2 of 3 skies"):
            client.skies([(0, 0), (0, 1), (0, 2)])
