"""Pictures have what they say; how they look is for eyes."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from conftest import TOWN, VALLEY

import skyglow


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


def drawn(ax):
    """The colours of a picture's samples, by their values."""
    return next(each for each in ax.collections if each.get_array() is not None)


def test_a_fisheye_is_brightest_where_the_sky_is(town):
    ax = town.skyglow.fisheye()
    assert ax.name == "polar"
    assert ax.get_theta_direction() == 1, "east is left of north"
    values = np.asarray(drawn(ax).get_array()).reshape(64, 256)
    brightest = float(town["brightness"].min())
    assert -values.max() == brightest
    assert (values == -brightest).any(axis=0)[int(np.nanargmin(town["brightness"].values)) % 256]
    ax.figure.canvas.draw()
    ticks = [label.get_text() for label in drawn(ax).colorbar.ax.get_yticklabels()]
    assert ticks == ["16", "18", "20", "22", "24"]
    assert "Illustrative" in ax.get_title(loc="left")
    narrow = town.skyglow.fisheye(limits=(17, 22))
    assert [label.get_text() for label in drawn(narrow).colorbar.ax.get_yticklabels()] == [
        "17",
        "18",
        "19",
        "20",
        "21",
        "22",
    ]
    assert drawn(town.skyglow.fisheye(colorbar=False)).colorbar is None


def test_a_strip_has_the_horizon(client):
    valley = client.panorama(*VALLEY)
    ax = skyglow.plot.panorama(valley)
    ground = ax.collections[-1].get_paths()[0].vertices
    assert ground[:, 1].max() == pytest.approx(float(valley["horizon"].max()))


def test_a_sky_without_magnitudes_has_its_own_unit(client):
    for response, unit in [("scotopic", "cd/m²"), ("dnb", "nW/(cm² sr)")]:
        ax = client.panorama(*TOWN, response=response).skyglow.panorama()
        assert unit in drawn(ax).colorbar.ax.get_ylabel()
    with pytest.raises(ValueError, match="several responses"):
        client.panorama(*TOWN, responses=["photopic", "sqm"]).skyglow.fisheye()
    with pytest.raises(ValueError, match="polar axes"):
        skyglow.plot.fisheye(client.panorama(*TOWN), ax=plt.gca())


def test_maps_of_points_and_layers(client):
    frame = client.influence(*VALLEY, limit=30)
    ax = skyglow.plot.map(frame)
    assert drawn(ax).colorbar.ax.get_ylabel() == "share of zenith"
    # Pixels lie beside each other, the strongest on top.
    pixels = [path.vertices[:4] for path in drawn(ax).get_paths()]
    strongest = (frame["longitude_deg"].iloc[0], frame["latitude_deg"].iloc[0])
    assert tuple(pixels[-1].mean(axis=0)) == pytest.approx(strongest)
    assert np.ptp(pixels[-1], axis=0) == pytest.approx([1 / 120, 1 / 120], rel=1e-5)
    ax = skyglow.plot.map(client.skies([TOWN, VALLEY]))
    assert "mag/arcsec²" in drawn(ax).colorbar.ax.get_ylabel()
    layer = client.layer("radiance")
    ax = skyglow.plot.map(layer)
    assert np.nanmax(drawn(ax).get_array()) == pytest.approx(float(layer.max()))
    assert skyglow.plot.map(client.influence(*VALLEY, limit=0)).collections
