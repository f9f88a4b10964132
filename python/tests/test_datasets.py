"""Panoramas and layers as xarray objects."""

import json

import astropy.units as u
import numpy as np
import pytest
import xarray
from conftest import TOWN, VALLEY

from skyglow.astropy import quantity
from skyglow.datasets import brightness_mag_arcsec2, luminance_cd_m2


def test_a_panorama_is_a_cf_dataset(town):
    assert dict(town.sizes) == {"elevation": 64, "azimuth": 256, "band": 3, "bounds": 2}
    assert town["luminance"].attrs["units"] == "cd m-2"
    assert town["radiance"].attrs["units"] == "W m-2 sr-1"
    assert town["brightness"].attrs["units"] == "1"
    assert town["brightness"].attrs["astropy_unit"] == "mag / arcsec2"
    assert "1.08e5" in town["brightness"].attrs["comment"]
    assert town.attrs["Conventions"] == "CF-1.11"
    assert town["wavelength"].attrs["standard_name"] == "radiation_wavelength"
    assert town.attrs["comment"] == "Illustrative light, not measured."
    for variable in town.variables.values():
        assert (
            variable.attrs.get("long_name") or variable.attrs.get("standard_name") or variable.dims[-1:] == ("bounds",)
        )
    assert json.loads(town.attrs["assumptions"])["turbidity"] == town.attrs["turbidity"] == 2.5


def test_samples_give_the_servers_own_numbers(town):
    sky = town.skyglow.assumptions.sky
    azimuth, elevation = sky.brightest_azimuth_deg, sky.brightest_elevation_deg
    assert town.skyglow.at(azimuth, elevation) == pytest.approx(sky.brightest_luminance_cd_m2, rel=1e-3)
    assert float(town["luminance"].max()) == pytest.approx(sky.brightest_luminance_cd_m2, rel=1e-3)
    # A sample stands for the solid angle of its cell.
    weight = np.sin(np.radians(town["elevation"])) * np.cos(np.radians(town["elevation"]))
    cell_sr = np.radians(360 / 256) * np.radians(90 / 64)
    illuminance = float((town["luminance"].fillna(0) * weight).sum() * cell_sr)
    assert illuminance == pytest.approx(sky.horizontal_illuminance_lx, rel=2e-3)


def test_magnitudes_follow_the_formula(client, town):
    sky = client.sky(*TOWN).sky
    magnitude = brightness_mag_arcsec2(sky.zenith_total_luminance_cd_m2)
    assert magnitude == pytest.approx(sky.zenith_total_brightness_mag_arcsec2, abs=1e-9)
    assert luminance_cd_m2(magnitude) == pytest.approx(sky.zenith_total_luminance_cd_m2)
    assert quantity(town["brightness"]).unit == u.mag / u.arcsec**2
    assert quantity(town["luminance"]).unit == u.cd / u.m**2


def test_ground_is_no_sky(client):
    valley = client.panorama(*VALLEY)
    is_ground = valley["elevation"] < valley["horizon"]
    assert 100 < int(is_ground.sum()) < is_ground.size / 2
    assert bool(valley["luminance"].where(is_ground).isnull().all())
    assert bool((valley["luminance"].where(~is_ground, 1.0) > 0).all())
    assert np.isnan(valley.skyglow.at(0.0, -5.0))


def test_directions_wrap_around_north(town):
    around = town.skyglow.at([359.9, 360.0, 0.0, 0.1], 45.0)
    assert around[1] == around[2]
    assert np.ptp(around) < 0.05 * around[0]
    sample = town["luminance"].values[10, 20]
    assert town.skyglow.at(float(town["azimuth"][20]), float(town["elevation"][10])) == pytest.approx(sample)


def test_several_responses_have_a_dimension(client):
    sky = client.panorama(*TOWN, responses=["photopic", "scotopic", "sqm"])
    assert list(sky["response"].values) == ["photopic", "scotopic", "sqm"]
    assert sky["luminance"].dims[0] == "response"
    assert sky["radiance"].dims == ("band", "elevation", "azimuth")
    assert bool(sky["brightness"].sel(response="scotopic").isnull().all()), "it has no system of magnitudes"
    alone = client.panorama(*TOWN, response="sqm")
    np.testing.assert_array_equal(sky["luminance"].sel(response="sqm"), alone["luminance"])
    np.testing.assert_array_equal(sky["brightness"].sel(response="sqm"), alone["brightness"])
    with pytest.raises(ValueError, match="different units"):
        client.panorama(*TOWN, responses=["photopic", "dnb"])
    assert client.panorama(*TOWN, response="dnb")["radiance_seen"].attrs["units"] == "nW cm-2 sr-1"


def test_a_night_is_a_cube_for_zarr(client, tmp_path):
    """Times are a dimension, numbers those of single skies; attributes and assumptions hold for all times."""
    times = ["2026-08-12T21:00:00Z", "2026-08-12T23:00:00Z"]
    night = client.panorama(*TOWN, times=times, responses=["photopic", "sqm"])
    assert night["luminance"].dims == ("response", "time", "elevation", "azimuth")
    assert night["radiance"].dims == ("time", "band", "elevation", "azimuth")
    assert night["horizon"].dims == ("azimuth",)
    late = client.panorama(*TOWN, time=times[1], response="sqm")
    of_late = night.isel(time=1).sel(response="sqm")
    for name in ("luminance", "brightness", "radiance"):
        np.testing.assert_array_equal(of_late[name], late[name])
    assert of_late["time"] == late["time"]
    said = night.skyglow.assumptions
    assert said.turbidity == 2.5
    assert "time" not in said
    assert "sky" not in said
    night.to_zarr(tmp_path / "night.zarr", zarr_format=2)
    with xarray.open_zarr(tmp_path / "night.zarr") as read:
        xarray.testing.assert_allclose(read.load(), night)
    with pytest.raises(ValueError, match="several times"):
        night.sel(response="sqm").skyglow.fisheye()
    with pytest.raises(ValueError, match="no time"):
        client.panorama(*TOWN, times=[])


def test_a_dataset_survives_netcdf(client, tmp_path):
    sky = client.panorama(*TOWN, time="2026-08-12T23:00:00Z")
    assert sky["time"].values == np.datetime64("2026-08-12T23:00:00")
    assert sky.attrs["light"] == "total"
    sky.to_netcdf(tmp_path / "sky.nc")
    with xarray.open_dataset(tmp_path / "sky.nc") as read:
        xarray.testing.assert_allclose(read.load(), sky)
        assert read.attrs["assumptions"] == sky.attrs["assumptions"]


def test_layers_lie_on_the_scenes_grid(client):
    scene = client.scenes()[0]
    radiance = client.layer("radiance")
    assert radiance.shape == (scene.grid.height, scene.grid.width)
    west, south, east, north = scene.bounds
    assert west < float(radiance["longitude"].min()) < float(radiance["longitude"].max()) < east
    assert south < float(radiance["latitude"].min()) < float(radiance["latitude"].max()) < north
    assert "WGS 84" in radiance["spatial_ref"].attrs["crs_wkt"]
    influence = client.influence_map(*VALLEY)
    assert influence.shape == radiance.shape
    most = client.influence(*VALLEY, limit=1).iloc[0]
    row, column = np.unravel_index(np.nanargmax(influence.values), influence.shape)
    assert (row, column) == (most["row"], most["column"])
    assert float(influence.latitude[row]) == pytest.approx(most["latitude_deg"])
