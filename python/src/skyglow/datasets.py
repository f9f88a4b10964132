"""Panoramas and map layers as xarray objects with CF metadata."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas
import pyproj
import xarray

if TYPE_CHECKING:
    from .calls import Response

CONVENTIONS = "CF-1.11"
# Of the magnitudes of all luminances, by definition of the server (docs/model.md, photometry).
ZERO_POINT_CD_M2 = 1.08e5
FORMULA = "brightness = -2.5 log10(luminance / 1.08e5 cd m-2); none where no light is seen"
# UDUNITS knows no magnitudes; astropy does.
MAGNITUDE = {"units": "1", "comment": FORMULA, "astropy_unit": "mag / arcsec2"}


def brightness_mag_arcsec2(luminance_cd_m2: Any) -> Any:
    """Magnitudes of a luminance; NaN where there is no light."""
    values = np.asarray(luminance_cd_m2, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(values > 0, -2.5 * np.log10(values / ZERO_POINT_CD_M2), np.nan)


def luminance_cd_m2(brightness_mag_arcsec2: Any) -> Any:
    """The inverse of :func:`brightness_mag_arcsec2`."""
    return ZERO_POINT_CD_M2 * 10 ** (-0.4 * np.asarray(brightness_mag_arcsec2, dtype=float))


def panorama(said: Mapping[str, Any]) -> xarray.Dataset:
    """The server's panorama as a dataset: what the response sees, and radiance in three bands.

    Directions below the observer's horizon are NaN: terrain is seen there, and no sky.
    """
    grid, response, light = said["grid"], said["response"], said["light"]
    azimuth = grid["azimuth_first_deg"] + grid["azimuth_step_deg"] * np.arange(grid["azimuth_count"])
    elevation = grid["elevation_first_deg"] + grid["elevation_step_deg"] * np.arange(grid["elevation_count"])
    horizon = np.asarray(said["horizon_deg"])
    is_hidden = elevation[:, np.newaxis] < horizon[np.newaxis, :]
    seen = np.where(is_hidden, np.nan, np.asarray(said["values"], dtype=np.float32))
    of_light = f"{'artificial light' if light == 'artificial' else 'artificial and natural light'}"
    name = response["name"]
    is_luminance = response["unit"] == "cd m-2"
    quantity = "luminance" if is_luminance else "radiance_seen"
    variables: dict[str, Any] = {
        quantity: (
            ("elevation", "azimuth"),
            seen,
            {
                "long_name": f"{quantity.replace('_', ' ')} of the sky, {of_light}, {name} response",
                "units": response["unit"],
            },
        ),
        "radiance": (
            ("band", "elevation", "azimuth"),
            np.where(is_hidden, np.nan, np.asarray(said["radiance"], dtype=np.float32)),
            {"long_name": f"radiance of the sky in a band, {of_light}", "units": said["unit"]},
        ),
        "horizon": (
            ("azimuth",),
            horizon,
            {"long_name": "elevation below which terrain hides the sky", "units": "degree"},
        ),
    }
    if is_luminance and _has_magnitude(said["sky"], name):
        magnitude = {"long_name": f"surface brightness of the sky, {of_light}, {name} response", **MAGNITUDE}
        variables["brightness"] = (
            ("elevation", "azimuth"),
            brightness_mag_arcsec2(seen).astype(np.float32),
            magnitude,
        )
    return xarray.Dataset(variables, _coordinates(said, azimuth, elevation), _attributes(said))


def _has_magnitude(sky: Mapping[str, Any], response: str) -> bool:
    # The total has natural light in it, so that its magnitude is missing only where the response has none.
    return any(
        entry["response"] == response and entry["total_brightness_mag_arcsec2"] is not None
        for entry in sky["zenith_by_response"]
    )


def _coordinates(
    said: Mapping[str, Any], azimuth: np.ndarray[Any, Any], elevation: np.ndarray[Any, Any]
) -> dict[str, Any]:
    observer, bands = said["observer"], np.asarray(said["bands_nm"], dtype=float)
    coordinates: dict[str, Any] = {
        "azimuth": (
            "azimuth",
            azimuth,
            {"long_name": "azimuth, clockwise from true north", "units": "degree"},
        ),
        "elevation": (
            "elevation",
            elevation,
            {"long_name": "elevation above the horizontal plane", "units": "degree"},
        ),
        "band": ("band", ["R", "G", "B"], {"long_name": "band"}),
        "wavelength": (
            "band",
            bands.mean(axis=1),
            {"standard_name": "radiation_wavelength", "units": "nm", "bounds": "wavelength_bounds"},
        ),
        "wavelength_bounds": (("band", "bounds"), bands),
        "response": ((), said["response"]["name"], {"long_name": "what sees the sky"}),
        "latitude": (
            (),
            observer["latitude_deg"],
            {"standard_name": "latitude", "units": "degrees_north"},
        ),
        "longitude": (
            (),
            observer["longitude_deg"],
            {"standard_name": "longitude", "units": "degrees_east"},
        ),
        "altitude": (
            (),
            observer["altitude_m"],
            {"standard_name": "altitude", "units": "m", "positive": "up"},
        ),
    }
    if said.get("time"):
        instant = pandas.Timestamp(said["time"]).tz_convert("UTC").tz_localize(None)
        said_of_time = {"standard_name": "time", "units_metadata": "leap_seconds: none"}
        coordinates["time"] = ((), instant.to_datetime64(), said_of_time)
    return {name: without_fill_value(*one) for name, one in coordinates.items()}


def without_fill_value(
    dims: Any, values: Any, attributes: Mapping[str, Any] | None = None
) -> tuple[Any, Any, Mapping[str, Any], dict[str, Any]]:
    """A coordinate: CF has no missing values in it, and xarray writes none where it is told so."""
    return dims, values, attributes or {}, {"_FillValue": None}


def _attributes(said: Mapping[str, Any]) -> dict[str, Any]:
    """Global attributes of CF, and what the numbers depend on: scalars that netCDF can hold, all of it as JSON."""
    scene = said["scene"]
    samples = {"grid", "radiance", "values", "horizon_deg", "bands_nm", "unit", "light"}
    assumptions = {name: value for name, value in said.items() if name not in samples}
    attributes = {
        "Conventions": CONVENTIONS,
        "title": f"Night sky at {place(said['observer'])}",
        "history": f"computed by Skyglow from scene {scene['id']}, version {scene['version']}",
        "comment": "Illustrative light, not measured." if scene["illustrative"] else "",
        "light": said["light"],
        "scene": scene["id"],
        "scene_version": scene["version"],
        "attribution": scene.get("attribution") or "",
        "scenario": said.get("scenario") or "",
        "turbidity": said["turbidity"],
        "scattering": said["scattering"],
        "clouds": said["clouds"],
        "cloud_cover": said.get("cloud_cover", "") if said["clouds"] != "none" else "",
        "lamp": _named(said["lamp"]),
        "emission": _named(said["emission"]),
        "calibration": said["calibration"],
        "coverage": said["coverage"],
        "warnings": "\n".join(said["warnings"]),
        "assumptions": json.dumps(assumptions, ensure_ascii=False),
    }
    return {name: value for name, value in attributes.items() if value != ""}


def _named(said: Mapping[str, Any]) -> str:
    name = said.get("preset") or said.get("mix") or "custom"
    return name if isinstance(name, str) else json.dumps(name)


def place(observer: Mapping[str, Any]) -> str:
    """A place in words: `46.1700° N, 8.7900° E`."""
    latitude, longitude = observer["latitude_deg"], observer["longitude_deg"]
    north, east = "N" if latitude >= 0 else "S", "E" if longitude >= 0 else "W"
    return f"{abs(latitude):.4f}° {north}, {abs(longitude):.4f}° {east}"


def cube(skies: Sequence[Sequence[xarray.Dataset]], *, has_responses: bool, has_times: bool) -> xarray.Dataset:
    """Skies of one place by response and time, along the dimensions that were asked for."""
    by_response = [over_time(each) if has_times else each[0] for each in skies]
    return together(by_response) if has_responses else by_response[0]


def over_time(skies: Sequence[xarray.Dataset]) -> xarray.Dataset:
    """Skies of one place at several times, along a dimension `time`; attributes have what holds for all times."""
    seen = [name for name, variable in skies[0].data_vars.items() if "elevation" in variable.dims]
    first, parts = skies[0], [sky[seen] for sky in skies]
    whole = xarray.concat(
        parts, dim="time", coords="minimal", compat="override", join="exact", combine_attrs="override"
    )
    # No variable that changes has the second dimension of the bounds, so none brings them along.
    whole = whole.assign(horizon=first["horizon"]).assign_coords(wavelength_bounds=first["wavelength_bounds"].variable)
    same = {name: value for name, value in first.attrs.items() if all(sky.attrs.get(name) == value for sky in skies)}
    said: list[dict[str, Any]] = [json.loads(sky.attrs["assumptions"]) for sky in skies]
    of_all = {name: value for name, value in said[0].items() if all(one.get(name) == value for one in said)}
    warnings = dict.fromkeys(warning for one in said for warning in one["warnings"])
    same["assumptions"] = json.dumps({**of_all, "warnings": list(warnings)}, ensure_ascii=False)
    if warnings:
        same["warnings"] = "\n".join(warnings)
    whole.attrs = same
    return whole


def together(skies: Sequence[xarray.Dataset]) -> xarray.Dataset:
    """Skies of one place as several responses see them, along a dimension `response`."""
    units = {sky[name].attrs["units"] for sky in skies for name in ("luminance", "radiance_seen") if name in sky}
    if len(units) > 1:
        raise ValueError(f"responses in different units ({', '.join(sorted(units))}): ask for each by itself")
    first = skies[0]
    seen = [name for name in ("luminance", "radiance_seen", "brightness") if any(name in sky for sky in skies)]
    parts = []
    for sky in skies:
        part = sky[[name for name in seen if name in sky]]
        if "brightness" in seen and "brightness" not in part:
            part = part.assign(brightness=part["luminance"] * np.nan)
        parts.append(part)
    whole = xarray.concat(
        parts, dim="response", combine_attrs="override", coords="minimal", compat="override", join="exact"
    )
    for name in seen:
        # Parts of a name that tells one response are told by the coordinate now.
        long_name = next(sky[name].attrs["long_name"] for sky in skies if name in sky)
        attributes = next(sky[name].attrs for sky in skies if name in sky)
        whole[name].attrs = {**attributes, "long_name": long_name.rsplit(", ", 1)[0]}
    whole = whole.assign(radiance=first["radiance"], horizon=first["horizon"])
    # No variable has its second dimension, so none brings it along.
    return whole.assign_coords(wavelength_bounds=first["wavelength_bounds"].variable)


def of_layer(layer: xarray.DataArray) -> xarray.Dataset:
    """A layer with the global attributes of CF, which an array has no place for: for netCDF."""
    name, tags = str(layer.name), layer.attrs
    title = str(tags.get("long_name", name)).partition(";")[0]
    made = {
        "Conventions": CONVENTIONS,
        "title": title,
        "history": f"computed by {tags.get('TIFFTAG_SOFTWARE', 'Skyglow')}",
    }
    return layer.to_dataset(name=name).assign_attrs(made)


def raster(name: str) -> Callable[[Response], xarray.DataArray]:
    """Reads a GeoTIFF as a grid with its coordinate reference system as CF has it (`spatial_ref`)."""

    def read(response: Response) -> xarray.DataArray:
        try:
            import rasterio
        except ImportError as error:
            raise ImportError("map layers need rasterio: pip install 'skyglow[raster]'") from error
        with rasterio.MemoryFile(response.content) as memory, memory.open() as file:
            values = file.read(1, masked=True)
            columns, rows = np.arange(file.width) + 0.5, np.arange(file.height) + 0.5
            transform, crs, tags = file.transform, file.crs, {**file.tags(), **file.tags(1)}
            unit, description = file.units[0], file.descriptions[0]
        if values.dtype.kind == "f":
            values = values.filled(np.nan)
        elif np.ma.is_masked(values):
            values = values.astype(float).filled(np.nan)
        is_geographic = crs is not None and crs.is_geographic
        names = ("latitude", "longitude") if is_geographic else ("y", "x")
        y_attributes = {"standard_name": "latitude", "units": "degrees_north"}
        x_attributes = {"standard_name": "longitude", "units": "degrees_east"}
        if not is_geographic:
            y_attributes = {"standard_name": "projection_y_coordinate", "units": "m"}
            x_attributes = {"standard_name": "projection_x_coordinate", "units": "m"}
        # With the name and the parameters that CF has for it.
        reference = {} if crs is None else pyproj.CRS.from_wkt(crs.to_wkt()).to_cf()
        reference["long_name"] = "coordinate reference system"
        attributes = {"long_name": description or name, "grid_mapping": "spatial_ref", **tags}
        if unit:
            attributes["units"] = unit
        return xarray.DataArray(
            np.asarray(values),
            dims=names,
            coords={
                names[0]: without_fill_value(names[0], transform.f + transform.e * rows, y_attributes),
                names[1]: without_fill_value(names[1], transform.c + transform.a * columns, x_attributes),
                "spatial_ref": ((), 0, reference),
            },
            name=name,
            attrs=attributes,
        )

    return read
