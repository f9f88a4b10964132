"""Measured skies beside the model's: readers of usual files, residuals, and a scene's calibration fitted to them.

Every reader gives a table with ``time`` (UTC), ``latitude_deg``, ``longitude_deg``, ``brightness_mag_arcsec2`` and
``instrument``; what else the file says stays in further columns and in ``attrs``.
"""

from __future__ import annotations

import dataclasses
import io
import os
from typing import Any, TextIO

import geopandas
import numpy as np
import pandas

from . import datasets
from .questions import Questions

Source = str | os.PathLike[str] | TextIO
# Of instruments that see what the model's Sky Quality Meter sees.
RESPONSE = "sqm"


def read_ida(source: Source) -> pandas.DataFrame:
    """Readings in the standard format for skyglow measurements (IDA/NSBM 1.0), as SQM and TESS loggers write them.

    The 35 or more lines of its header are in ``attrs``; fields are those that the header names. Readings of 0, which
    a meter gives when it saw nothing, are left out.
    """
    lines = _text(source).splitlines()
    header, end = _header(lines)
    attributes = _entries(header)
    fields = _fields(header)
    latitude, longitude, altitude = _position(attributes)
    rows = pandas.read_csv(
        io.StringIO("\n".join(lines[end:])),
        sep=";",
        header=None,
        names=fields,
        usecols=range(len(fields)),
        skip_blank_lines=True,
        comment="#",
    )
    if "MSAS" not in fields or "UTC Date & Time" not in fields:
        raise ValueError(f"the header names no fields `UTC Date & Time` and `MSAS`, but {', '.join(fields)}")
    brightness = pandas.to_numeric(rows["MSAS"])
    table = pandas.DataFrame(
        {
            "time": pandas.to_datetime(rows["UTC Date & Time"].str.strip(), utc=True, format="ISO8601"),
            "latitude_deg": latitude,
            "longitude_deg": longitude,
            "altitude_m": altitude,
            "brightness_mag_arcsec2": brightness,
            "instrument": attributes.get("Instrument ID") or attributes.get("Device type", ""),
        }
    )
    rest = rows.drop(columns=["UTC Date & Time", "Local Date & Time", "MSAS"], errors="ignore")
    table = pandas.concat([table, rest.rename(columns=_column)], axis=1)
    table = table[brightness > 0].reset_index(drop=True)
    table.attrs = attributes
    return table


read_sqm = read_ida
read_tess = read_ida


def read_globe_at_night(source: Source) -> pandas.DataFrame:
    """Reports of Globe at Night (CSV): those with a reading of a Sky Quality Meter, ``LimitingMag`` beside it."""
    rows = pandas.read_csv(io.StringIO(_text(source)), skipinitialspace=True, low_memory=False)
    rows.columns = [str(name).strip() for name in rows.columns]
    needed = {"Latitude", "Longitude", "UTDate", "UTTime", "SQMReading"}
    if missing := needed - set(rows.columns):
        raise ValueError(f"this is no file of Globe at Night: it lacks {', '.join(sorted(missing))}")
    reading = pandas.to_numeric(rows["SQMReading"], errors="coerce")
    rows, reading = rows[reading > 0].reset_index(drop=True), reading[reading > 0].reset_index(drop=True)
    when = rows["UTDate"].astype(str).str.strip() + " " + rows["UTTime"].astype(str).str.strip()
    table = pandas.DataFrame(
        {
            "time": pandas.to_datetime(when, utc=True, format="mixed"),
            "latitude_deg": pandas.to_numeric(rows["Latitude"]),
            "longitude_deg": pandas.to_numeric(rows["Longitude"]),
            "brightness_mag_arcsec2": reading,
            "instrument": "SQM" + rows.get("SQMSerial", pandas.Series("", rows.index)).map(_serial),
        }
    )
    rest = {"LimitingMag": "reported_limit_mag", "CloudCover": "cloud_cover", "ObsID": "observation"}
    for name, column in rest.items():
        if name in rows:
            table[column] = rows[name]
    return table


def residuals(client: Questions, readings: pandas.DataFrame, **asked: Any) -> geopandas.GeoDataFrame:
    """The model beside each reading: what a Sky Quality Meter would read there and then, and the difference.

    ``residual_mag_arcsec2`` is reading less model: positive where it is darker than the model. The model's meter looks
    at the zenith. A reading of another instrument is compared with what that meter sees: TESS sees more red, so that a
    constant difference between the two is the instruments'. ``keep_problems=True`` keeps readings without an answer.
    """
    needed = {"time", "latitude_deg", "longitude_deg", "brightness_mag_arcsec2"}
    if missing := needed - set(readings.columns):
        raise ValueError(f"the table of readings lacks {', '.join(sorted(missing))}")
    found = client.skies(readings, **asked)
    model = found["sqm_total_brightness_mag_arcsec2"].astype(float)
    artificial = found["sqm_luminance_cd_m2"].astype(float)
    found["model_mag_arcsec2"] = model
    found["model_artificial_cd_m2"] = artificial
    found["model_natural_cd_m2"] = datasets.luminance_cd_m2(model) - artificial
    found["residual_mag_arcsec2"] = found["brightness_mag_arcsec2"] - model
    return found


@dataclasses.dataclass(frozen=True)
class Calibration:
    """A factor on a scene's light with which the model agrees best with readings.

    ``factor`` is relative to the scene as it is; ``calibration`` is the factor to ingest it with. The standard error
    is of the natural logarithm, so that ``interval`` (68 %) is positive.
    """

    factor: float
    log_standard_error: float
    calibration: float | None
    rms_before_mag: float
    rms_after_mag: float
    readings: int
    places: int

    @property
    def interval(self) -> tuple[float, float]:
        """The factor less and more one standard error."""
        spread = float(np.exp(self.log_standard_error))
        return self.factor / spread, self.factor * spread


def fit_calibration(compared: pandas.DataFrame) -> Calibration:
    """The factor on artificial light that makes the residuals of :func:`residuals` smallest, by least squares.

    The model of a reading is factor × artificial + natural luminance, in magnitudes (Gauss-Newton in the logarithm of
    the factor). Readings of one place share what the model has wrong there, so the standard error is a jackknife over
    places; with one place alone it is that of readings that are independent, which is too small.
    """
    used = compared.dropna(subset=["residual_mag_arcsec2", "model_artificial_cd_m2"])
    used = used[used["model_artificial_cd_m2"] > 0]
    if len(used) < 2:
        raise ValueError(f"{len(used)} readings with artificial light in the model: a fit needs two or more")
    measured = used["brightness_mag_arcsec2"].to_numpy(float)
    artificial = used["model_artificial_cd_m2"].to_numpy(float)
    natural = used["model_natural_cd_m2"].to_numpy(float)
    place = used.groupby(["latitude_deg", "longitude_deg"], sort=False).ngroup().to_numpy()
    log_factor = _fit(measured, artificial, natural)
    left, slope = _misfit(log_factor, measured, artificial, natural)
    places = int(place.max()) + 1
    if places > 1:
        without = np.array(
            [_fit(measured[place != p], artificial[place != p], natural[place != p]) for p in range(places)]
        )
        error = float(np.sqrt((places - 1) / places * np.sum((without - without.mean()) ** 2)))
    else:
        error = float(np.sqrt(np.sum(left**2) / (len(left) - 1) / np.sum(slope**2)))
    before, _ = _misfit(0.0, measured, artificial, natural)
    factor = float(np.exp(log_factor))
    of_scene = compared.attrs.get("calibration")
    return Calibration(
        factor=factor,
        log_standard_error=error,
        calibration=None if of_scene is None else factor * float(of_scene),
        rms_before_mag=float(np.sqrt(np.mean(before**2))),
        rms_after_mag=float(np.sqrt(np.mean(left**2))),
        readings=len(used),
        places=places,
    )


def _misfit(log_factor: float, measured: Any, artificial: Any, natural: Any) -> tuple[Any, Any]:
    """Readings less model, and how the model's magnitudes change with the logarithm of the factor."""
    lit = np.exp(log_factor) * artificial
    return measured - datasets.brightness_mag_arcsec2(lit + natural), -2.5 / np.log(10) * lit / (lit + natural)


def _fit(measured: Any, artificial: Any, natural: Any) -> float:
    log_factor = 0.0
    for _ in range(100):
        left, slope = _misfit(log_factor, measured, artificial, natural)
        # A dark sky says little about the factor: a step is held to a factor of e.
        step = float(np.clip(np.sum(slope * left) / np.sum(slope**2), -1.0, 1.0))
        log_factor += step
        if abs(step) < 1e-10:
            return log_factor
        if abs(log_factor) > 20.0:
            break
    raise ValueError("no factor fits: the readings are as dark as the natural sky, or brighter than any light explains")


def _text(source: Source) -> str:
    if isinstance(source, str | os.PathLike):
        with open(source, encoding="utf-8-sig", errors="replace") as file:
            return file.read()
    return source.read()


def _header(lines: list[str]) -> tuple[list[str], int]:
    """The header's lines without their `#`, and where data begin."""
    if not lines or "skyglow" not in lines[0].lower():
        raise ValueError("this is no file of the IDA/NSBM format: its first line does not name the standard")
    for place, line in enumerate(lines):
        if line.strip().lstrip("#").strip().upper() == "END OF HEADER":
            return [each.lstrip("#").strip() for each in lines[:place]], place + 1
    raise ValueError("the header has no line `# END OF HEADER`")


def _entries(header: list[str]) -> dict[str, Any]:
    entries: dict[str, Any] = {}
    comments: list[str] = []
    for line in header[1:-2]:
        name, colon, value = line.partition(":")
        if name == "Comment":
            comments += [value.strip()] if value.strip() else []
        elif colon:
            entries[name.strip()] = value.strip()
    return {**entries, "Comment": comments}


def _fields(header: list[str]) -> list[str]:
    """Names of the fields: the last line but one before the end, after an optional `Field names:`."""
    for line in reversed(header):
        if "MSAS" in line and "," in line:
            return [name.strip() for name in line.removeprefix("Field names:").split(",")]
    raise ValueError("the header names no field `MSAS`")


def _position(entries: dict[str, Any]) -> tuple[float, float, float]:
    """The first entry that begins with `Position`: latitude, longitude, metres."""
    text = next((value for name, value in entries.items() if name.startswith("Position")), "")
    parts = text.replace("(", "").replace(")", "").split(",")
    try:
        latitude, longitude = float(parts[0]), float(parts[1])
    except (ValueError, IndexError):
        raise ValueError(f"the header's Position is no latitude and longitude: {text!r}") from None
    try:
        return latitude, longitude, float(parts[2])
    except (ValueError, IndexError):
        return latitude, longitude, float("nan")


def _column(name: str) -> str:
    return name.strip().lower().replace(" ", "_")


def _serial(value: Any) -> str:
    text = "" if pandas.isna(value) else str(value).strip().removesuffix(".0")
    return f" {text}" if text else ""
