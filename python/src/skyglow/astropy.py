"""Skies for astropy: places, times and targets in, quantities out.

Limiting magnitudes are those of a naked eye (Crumey 2014, eqs. 47 to 53, field factor 2), as the server has them for
the zenith; extinction is the server's vertical optical depth times the airmass of Kasten and Young (1989).
"""

from __future__ import annotations

import math
from typing import Any

import astropy.units as u
import numpy as np
import xarray
from astropy.coordinates import AltAz, EarthLocation, SkyCoord
from astropy.table import QTable
from astropy.time import Time

from . import datasets
from .questions import Questions

SURFACE_BRIGHTNESS = u.mag / u.arcsec**2
LUMINANCE = u.cd / u.m**2
MAGNITUDES_PER_OPTICAL_DEPTH = 2.5 * math.log10(math.e)
V_NM = 550.0


class NightSky:
    """The whole sky over a place: brightness where a target stands, and how faint a star may be there.

    ``asked`` are the server's parameters. The natural sky goes with each time, and the server is asked once for each
    step of ``time_step``: one that is well below the time in which Moon and Milky Way move by the distance between
    samples, 1.4 degrees, changes nothing.
    """

    def __init__(
        self, client: Questions, location: EarthLocation, *, time_step: u.Quantity | None = None, **asked: Any
    ) -> None:
        self.client = client
        self.location = location
        self.time_step = 5 * u.minute if time_step is None else time_step
        # To a millimetre: what astropy makes of geodetic coordinates has rounding errors.
        self._place = (round(float(location.lat.to_value(u.deg)), 8), round(float(location.lon.to_value(u.deg)), 8))
        of_location = {} if "height" in asked else {"altitude": round(float(location.height.to_value(u.m)), 3)}
        self._asked = {**of_location, **asked}
        self._skies: dict[str, xarray.Dataset] = {}

    def panorama(self, time: Time) -> xarray.Dataset:
        """The sky at the step of time that is nearest."""
        step_s = self.time_step.to_value(u.s)
        nearest = Time(np.round(time.utc.unix / step_s) * step_s, format="unix")
        key = str(nearest.utc.isot)
        if key not in self._skies:
            asked = {"time": nearest, "sky": "total", **self._asked}
            self._skies[key] = self.client.panorama(*self._place, **asked)
        return self._skies[key]

    def luminance(self, target: SkyCoord, times: Time) -> u.Quantity:
        """Luminance of all light where the target stands, its own not counted; NaN below the horizon."""
        return self.track(target, times)["luminance"].reshape(times.shape)

    def brightness(self, target: SkyCoord, times: Time) -> u.Quantity:
        """The same as surface brightness in magnitudes."""
        return self.track(target, times)["brightness"].reshape(times.shape)

    def limiting_magnitude(self, target: SkyCoord, times: Time) -> u.Quantity:
        """V outside the air of the faintest star that the naked eye sees where the target stands."""
        return self.track(target, times)["limiting_magnitude"].reshape(times.shape)

    def track(self, target: SkyCoord | AltAz, times: Time) -> QTable:
        """Where a target stands at each time, and what the sky is like there, a row for each time.

        ``target`` is in any frame of astropy; a direction (``AltAz``) is one for all times. Places of rows are those
        of an observer in vacuum, as astropy has them unless told the pressure.
        """
        moments = Time(np.atleast_1d(times.utc.isot).ravel(), format="isot", scale="utc")
        altitude, azimuth = self._directions(target, moments)
        rows = []
        for moment, up, around in zip(moments, altitude, azimuth, strict=True):
            sky = self.panorama(moment)
            luminance = float(sky.skyglow.at(around, up))
            extinction, at_zenith = extinction_mag(sky, np.array([up, 90.0]))
            limit = naked_eye_limit_mag(luminance) - (extinction - at_zenith)
            magnitude = float(datasets.brightness_mag_arcsec2(luminance))
            rows.append((luminance, magnitude, airmass(up), extinction, limit if np.isfinite(luminance) else np.nan))
        luminances, magnitudes, airmasses, extinctions, limits = np.array(rows, dtype=float).reshape(-1, 5).T
        return QTable(
            {
                "time": moments,
                "altitude": altitude * u.deg,
                "azimuth": azimuth * u.deg,
                "luminance": luminances * LUMINANCE,
                "brightness": magnitudes * SURFACE_BRIGHTNESS,
                "airmass": airmasses * u.one,
                "extinction": extinctions * u.mag,
                "limiting_magnitude": limits * u.mag,
            }
        )

    def _directions(self, target: Any, moments: Time) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
        # One that already is of the horizon, such as the zenith, needs no time.
        frame = getattr(target, "frame", target)
        if not isinstance(frame, AltAz):
            frame = target.transform_to(AltAz(obstime=moments, location=self.location))
        altitude, azimuth = np.atleast_1d(frame.alt.to_value(u.deg)), np.atleast_1d(frame.az.to_value(u.deg))
        shape = (len(moments),)
        return np.broadcast_to(altitude, shape), np.broadcast_to(azimuth, shape)


def location_of(place: Any) -> EarthLocation:
    """The place of a panorama's dataset, or of an answer of the server."""
    if isinstance(place, xarray.Dataset):
        longitude, latitude, altitude = place["longitude"], place["latitude"], place["altitude"]
        return EarthLocation.from_geodetic(float(longitude) * u.deg, float(latitude) * u.deg, float(altitude) * u.m)
    observer = place["observer"]
    return EarthLocation.from_geodetic(
        observer["longitude_deg"] * u.deg, observer["latitude_deg"] * u.deg, observer["altitude_m"] * u.m
    )


def quantity(variable: xarray.DataArray) -> u.Quantity:
    """A variable's values with its unit, magnitudes included (`astropy_unit`)."""
    unit = variable.attrs.get("astropy_unit") or variable.attrs["units"]
    return u.Quantity(variable.values, unit)


def airmass(altitude_deg: Any) -> Any:
    """Relative airmass of Kasten and Young (1989); NaN below the horizon."""
    altitude = np.asarray(altitude_deg, dtype=float)
    up = np.where(altitude >= 0, altitude, np.nan)
    return 1.0 / (np.sin(np.radians(up)) + 0.50572 * (up + 6.07995) ** -1.6364)


def extinction_mag(sky: xarray.Dataset, altitude_deg: Any) -> Any:
    """Magnitudes of V that the air takes in a direction, with the optical depth of the panorama's air at 550 nm."""
    depths = np.asarray(sky.skyglow.assumptions.local_optical_depth, dtype=float)
    nodes_nm = np.array([680.0, 590.0, 510.0, 440.0])
    depth = np.exp(np.interp(np.log(V_NM), np.log(nodes_nm[::-1]), np.log(depths[::-1])))
    return MAGNITUDES_PER_OPTICAL_DEPTH * depth * airmass(altitude_deg)


def naked_eye_limit_mag(luminance_cd_m2: Any) -> Any:
    """The faintest star against a background, as it arrives (Crumey 2014, field factor 2)."""
    background = np.maximum(np.asarray(luminance_cd_m2, dtype=float), 1e-5)
    root, fourth = np.sqrt(background), background**0.25
    inner = np.maximum(5.949e-8 * root - 2.389e-7 * root * fourth + 2.459e-7 * background, 0.0)
    threshold_lx = 2.0 * (np.sqrt(inner) + 4.120e-4 * fourth - 4.225e-4 * root) ** 2
    return -13.98 - 2.5 * np.log10(threshold_lx)
