"""The widget's Python side; tests/browser/widget.test.mjs has the browser's."""

import subprocess
import sys

import pytest
from conftest import TOWN, VALLEY

import skyglow
import skyglow.widget

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def sky(client):
    sky = skyglow.widget.Sky(client, lat=TOWN[0], lon=TOWN[1])
    sky.sent = []
    sky.send = lambda content, buffers=None: sky.sent.append((content, buffers))
    return sky


def tell(sky, **said):
    """As the browser does."""
    sky._handle_custom_msg(said, [])


def test_a_place_has_a_sky_at_once(client, sky):
    assert sky.sky == client.sky(*TOWN)
    assert sky.picture.startswith(PNG)
    assert sky.title
    assert sky.bounds == client.get("/api/v1/scenes/demo")["bounds"]
    state = sky.get_state()
    assert "SkyMap" in state["_esm"]
    assert ".skyglow-widget" in state["_css"]


def test_a_click_is_observed(client, sky):
    seen = []
    sky.observe(lambda change: seen.append((change.name, change.new)), ["lat", "lon", "sky", "is_busy"])
    tell(sky, kind="place", lat=VALLEY[0], lon=VALLEY[1])
    assert (sky.lat, sky.lon) == VALLEY
    assert sky.sky == client.sky(*VALLEY)
    assert [name for name, _ in seen] == ["lat", "lon", "is_busy", "sky", "is_busy"], "one sky"
    with sky.hold_trait_notifications():
        sky.lat, sky.lon = TOWN
    assert sky.sky == client.sky(*TOWN)


def test_parameters_may_change(client, sky):
    sky.ask(turbidity=4, picture={"style": "eye"})
    assert sky.sky == client.sky(*TOWN, turbidity=4)
    assert sky.picture == client.picture(
        *TOWN, turbidity=4, projection="fisheye", width=560, height_px=560, style="eye"
    )
    assert sky.sent[-1][0] == {"kind": "map-changed"}
    sky.ask(turbidity=None)
    assert sky.sky == client.sky(*TOWN)


def test_what_is_wrong_is_said(client, sky):
    tell(sky, kind="place", lat=0.0, lon=0.0)
    assert sky.sky is None
    assert "outside" in sky.problem
    assert not sky.picture
    assert not sky.is_busy
    sky.go(*TOWN)
    assert sky.sky is not None
    assert not sky.problem
    for said in ({"kind": "place", "lat": None, "lon": 8.0}, {"kind": "map", "bounds": [1]}, {}, "hello"):
        sky._handle_custom_msg(said, [])
    assert (sky.lat, sky.lon) == TOWN
    with pytest.raises(skyglow.OutsideSceneError):
        skyglow.widget.Sky(client, lat=0.0, lon=0.0)
    with pytest.raises(ValueError, match="lat and lon"):
        skyglow.widget.Sky(client, lat=0.0)
    with pytest.raises(TypeError, match="awaited"):
        skyglow.widget.Sky(skyglow.AsyncClient())


def test_a_map_has_the_names_within(client, sky):
    bounds = [8.0, 46.0, 9.0, 46.5]
    tell(sky, kind="map", bounds=bounds, size_px=[300, 200])
    content, (picture,) = sky.sent[-1]
    assert content["bounds"] == bounds
    assert picture.startswith(PNG)
    assert (int.from_bytes(picture[16:20]), int.from_bytes(picture[20:24])) == (300, 200)
    names = [place["name"] for place in content["places"]]
    assert "Locarno" in names
    assert "Milano" not in names
    tell(sky, kind="map", bounds=[8.0, 46.0, 8.0, 46.5], size_px=[300, 200])
    content, buffers = sky.sent[-1]
    assert content["kind"] == "map-problem"
    assert content["text"]
    assert buffers is None
    # What maps do not go by is not asked of them.
    of_a_time = skyglow.widget.Sky(client, lat=TOWN[0], lon=TOWN[1], time="2026-08-12T23:00:00Z")
    of_a_time.send = sky.send
    tell(of_a_time, kind="map", bounds=bounds, size_px=[300, 200])
    assert sky.sent[-1][1] == [picture]


def test_without_anywidget_it_says_what_is_missing():
    code = "import sys; sys.modules['anywidget'] = None; import skyglow, skyglow.widget"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert said.returncode == 1
    assert "skyglow[widget]" in said.stderr
