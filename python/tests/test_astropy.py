"""Quantities for astropy, beside what the server says itself."""

import astropy.units as u
import numpy as np
import pytest
from astroplan import FixedTarget, Observer, is_observable
from astropy.coordinates import AltAz, EarthLocation, SkyCoord
from astropy.time import Time
from astropy.utils import iers
from conftest import TOWN, VALLEY

from skyglow.astroplan import SkyBrightnessConstraint
from skyglow.astropy import SURFACE_BRIGHTNESS, NightSky, airmass, location_of, naked_eye_limit_mag

# Nothing is downloaded: positions to an arc second are enough.
iers.conf.auto_download = False
TIME = "2026-08-12T23:00:00Z"


@pytest.fixture(scope="module")
def answer(client):
    return client.sky(*VALLEY, time=TIME)


@pytest.fixture(scope="module")
def night(client, answer):
    return NightSky(client, location_of(answer))


def test_limits_are_those_of_the_server(night, answer):
    time = Time("2026-08-12T23:00:00")
    compared = 0
    for limit in answer.night_sky.limits:
        direction = AltAz(alt=limit.elevation_deg * u.deg, az=limit.azimuth_deg * u.deg)
        row = night.track(direction, time)[0]
        if limit.naked_eye_limit_mag is None:
            assert np.isnan(row["limiting_magnitude"].value)
            continue
        if np.isnan(row["luminance"].value):
            continue  # Between samples the skyline is taken in between, too.
        # The server takes the nearest sample; this one lies between samples.
        assert row["luminance"].value == pytest.approx(limit.luminance_cd_m2, rel=0.06)
        assert row["limiting_magnitude"].value == pytest.approx(limit.naked_eye_limit_mag, abs=0.06)
        compared += 1
    assert compared >= 12


def test_crumeys_published_values():
    for sky, limit in [(22.0, 6.27), (20.0, 5.52), (18.0, 4.99)]:
        assert naked_eye_limit_mag(1.08e5 * 10 ** (-0.4 * sky)) == pytest.approx(limit, abs=0.006)


def test_airmass_is_that_of_kasten_and_young():
    assert airmass([90.0, 30.0, 10.0, 0.0]) == pytest.approx([1.0, 1.995, 5.59, 37.9], rel=2e-3)
    assert np.isnan(airmass(-1.0))


def test_a_track_follows_the_target(night):
    vega = SkyCoord("18h36m56s +38d47m01s")
    times = Time("2026-08-12T22:00:00") + np.array([0.0, 2.0, 4.0]) * u.hour
    track = night.track(vega, times)
    assert len(track) == 3
    assert track["altitude"].unit == u.deg
    assert np.all(np.diff(track["altitude"]) < 0), "it sets"
    assert np.all(np.diff(track["extinction"]) > 0)
    expected = vega.transform_to(AltAz(obstime=times[1], location=night.location))
    assert track["azimuth"][1].to_value(u.deg) == pytest.approx(expected.az.deg)
    brightness = night.brightness(vega, times)
    assert brightness.unit == SURFACE_BRIGHTNESS
    assert brightness.shape == times.shape
    assert night.limiting_magnitude(vega, times[0]).shape == ()
    below = SkyCoord("06h45m09s -16d42m58s")
    assert np.isnan(night.luminance(below, times[0]).value)


def test_skies_are_asked_for_once_a_step(client):
    night = NightSky(client, EarthLocation.from_geodetic(TOWN[1], TOWN[0], 200), time_step=10 * u.minute)
    start = Time("2026-08-12T23:00:00")
    assert night.panorama(start) is night.panorama(start + 4 * u.minute)
    assert night.panorama(start) is not night.panorama(start + 6 * u.minute)
    assert float(night.panorama(start)["altitude"]) == 200


def test_a_constraint_keeps_targets_out_of_glow(client):
    observer = Observer(EarthLocation.from_geodetic(VALLEY[1], VALLEY[0], 1500))
    times = Time("2026-08-12T23:00:00") + np.array([0.0, 1.0]) * u.hour
    targets = [FixedTarget(SkyCoord("18h36m56s +38d47m01s"), "Vega"), FixedTarget(SkyCoord("06h45m09s -16d42m58s"))]
    how = {"time_step": 60 * u.minute}
    dark = SkyBrightnessConstraint(client, 15 * SURFACE_BRIGHTNESS, **how)
    assert list(is_observable(dark, observer, targets, times=times)) == [True, False]
    darker = SkyBrightnessConstraint(client, 25 * SURFACE_BRIGHTNESS, **how)
    assert not any(is_observable(darker, observer, targets, times=times))
    faint = SkyBrightnessConstraint(client, limiting_magnitude=4 * u.mag, **how)
    assert list(is_observable(faint, observer, targets, times=times)) == [True, False]
    with pytest.raises(ValueError, match="either"):
        SkyBrightnessConstraint(client)
