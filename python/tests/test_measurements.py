"""Files of measured skies, and the model beside them."""

import io
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pandas
import pytest
from conftest import VALLEY

from skyglow import datasets, measurements

DATA = Path(__file__).parent / "data"
SQM, TESS = ((DATA / name).read_text(encoding="utf-8") for name in ("valley-sqm.dat", "stars1-tess.dat"))
GLOBE = (
    "ID,ObsType,ObsID,Latitude,Longitude,Elevation(m),LocalDate,LocalTime,UTDate,UTTime,LimitingMag,SQMReading,"
    "SQMSerial,CloudCover,Constellation,SkyComment,LocationComment,Country\n"
    '1,GAN,10,46.17,8.79,200,2026-08-13,01:00,2026-08-12,23:00,4,19.87,3456,clear,Cygnus,"haze, low",,Switzerland\n'
    "2,GAN,11,46.18,8.80,200,2026-08-13,01:00,2026-08-12,23:00,5,,,clear,Cygnus,,,Switzerland\n"
    "3,SQM,12,46.53,8.61,1500,2026-08-13,01:05,2026-08-12,23:05,-9999,21.2,,clear,,,,Switzerland\n"
)


def test_files_of_sky_quality_meters_are_read():
    table = measurements.read_sqm(DATA / "valley-sqm.dat")
    assert list(table["brightness_mag_arcsec2"]) == [21.40, 21.42], "a reading of 0 is none"
    assert table["time"].iloc[1] == pandas.Timestamp("2026-08-12T23:10:00.5Z")
    assert set(table["latitude_deg"]) == {46.53}
    assert set(table["altitude_m"]) == {1500}
    assert list(table["temperature"]) == [11.2, 11.0]
    assert table.attrs["SQM serial number"] == "3456"
    assert table.attrs["Comment"] == ["seen: dew"]


def test_files_of_tess_are_read():
    table = measurements.read_tess(io.StringIO(TESS))
    assert table["brightness_mag_arcsec2"].tolist() == [20.21]
    assert table["instrument"].tolist() == ["stars1"]
    assert table["sky_temperature"].tolist() == [-8.1]
    assert np.isnan(table["altitude_m"].iloc[0])
    assert "license" not in "".join(table.columns)


def test_files_of_globe_at_night_are_read():
    table = measurements.read_globe_at_night(io.StringIO(GLOBE))
    assert table["brightness_mag_arcsec2"].tolist() == [19.87, 21.2]
    assert table["instrument"].tolist() == ["SQM 3456", "SQM"]
    assert table["time"].iloc[1] == pandas.Timestamp("2026-08-12T23:05:00Z")
    assert table["observation"].tolist() == [10, 12]


def test_files_of_other_kinds_are_refused():
    with pytest.raises(ValueError, match="does not name the standard"):
        measurements.read_ida(io.StringIO(GLOBE))
    with pytest.raises(ValueError, match="lacks Latitude"):
        measurements.read_globe_at_night(io.StringIO("a,b\n1,2\n"))
    with pytest.raises(ValueError, match="END OF HEADER"):
        measurements.read_ida(io.StringIO(SQM.partition("# END")[0]))
    with pytest.raises(ValueError, match="Position"):
        measurements.read_ida(io.StringIO(SQM.replace("46.53, 8.61, 1500", "the valley")))


def readings_of(skies, factor, spread_mag):
    """What meters would read if a scene's light were brighter by a factor, with an error of so many magnitudes."""
    natural = datasets.luminance_cd_m2(skies["sqm_total_brightness_mag_arcsec2"]) - skies["sqm_luminance_cd_m2"]
    exact = datasets.brightness_mag_arcsec2(factor * skies["sqm_luminance_cd_m2"] + natural)
    return exact + spread_mag * np.random.default_rng(4).standard_normal(len(exact))


def test_residuals_are_readings_less_the_model(client):
    table = pandas.concat([measurements.read_sqm(io.StringIO(SQM)), measurements.read_tess(io.StringIO(TESS))])
    compared = measurements.residuals(client, table.reset_index(drop=True))
    model = client.sky(*VALLEY, time="2026-08-12T23:00:00Z").sky.sqm_total_brightness_mag_arcsec2
    assert compared["residual_mag_arcsec2"].iloc[0] == pytest.approx(21.40 - model)
    assert compared["instrument"].tolist() == ["SQM-Valley", "SQM-Valley", "stars1"]
    assert (compared["model_natural_cd_m2"] > 1e-4).all()
    with pytest.raises(ValueError, match=r"lacks brightness.*, time"):
        measurements.residuals(client, pandas.DataFrame({"latitude_deg": [1.0]}))


def test_a_calibration_that_is_known_is_found(client):
    places = client.places().head(6)[["name", "geometry"]].assign(time="2026-08-12T23:00:00Z")
    skies = client.skies(places)
    for factor, spread_mag in [(1.0, 0.0), (1.6, 0.0), (0.4, 0.08)]:
        table = pandas.DataFrame(skies[["latitude_deg", "longitude_deg", "time"]])
        table["brightness_mag_arcsec2"] = readings_of(skies, factor, spread_mag)
        fit = measurements.fit_calibration(measurements.residuals(client, table))
        assert fit.places == fit.readings == 6
        assert fit.calibration == pytest.approx(fit.factor)
        assert fit.rms_after_mag <= fit.rms_before_mag + 1e-9
        if spread_mag == 0.0:
            assert fit.factor == pytest.approx(factor, rel=1e-6)
            assert fit.log_standard_error < 1e-6
        else:
            assert abs(np.log(fit.factor / factor)) < 3 * fit.log_standard_error
            assert 0.01 < fit.log_standard_error < 0.2
            low, high = fit.interval
            assert low < fit.factor < high


def test_one_place_and_too_little_to_fit():
    table = pandas.DataFrame(
        {
            "latitude_deg": 46.0,
            "longitude_deg": 8.0,
            "brightness_mag_arcsec2": [20.0, 20.1, 19.9],
            "residual_mag_arcsec2": [0.0, 0.1, -0.1],
            "model_artificial_cd_m2": 9e-4,
            "model_natural_cd_m2": 1.8e-4,
        }
    )
    fit = measurements.fit_calibration(table)
    assert fit.places == 1
    assert fit.calibration is None
    assert fit.log_standard_error > 0.02
    with pytest.raises(ValueError, match="two or more"):
        measurements.fit_calibration(table.head(1))
    dark = table.assign(brightness_mag_arcsec2=25.0)
    with pytest.raises(ValueError, match="no factor fits"):
        measurements.fit_calibration(dark)


def test_the_program_compares_alike(client, tmp_path):
    """`skyglow compare` has the residuals and the fit of this package."""
    files = [tmp_path / "sqm.dat", tmp_path / "tess.dat"]
    # Brighter than the natural sky is there, so that a factor fits each place.
    for file, text in zip(files, [SQM.replace(";21.4", ";21.0"), TESS], strict=True):
        file.write_text(text, encoding="utf-8")
    program = [os.environ["SKYGLOW_PROGRAM"], "compare", "--scene", "demo", "--device", "cpu", "--json"]
    folders = ["--data", os.environ["SKYGLOW_ENGINE_DATA"], "--packs", os.environ["SKYGLOW_ENGINE_PACKS"]]
    given = [f"--measurements={file}" for file in files]
    run = subprocess.run([*program, *folders, *given], capture_output=True, text=True, check=True)
    said = json.loads(run.stdout)
    table = pandas.concat([measurements.read_ida(file) for file in files]).reset_index(drop=True)
    compared = measurements.residuals(client, table)
    assert [row["instrument"] for row in said["readings"]] == compared["instrument"].tolist()
    for name in ("residual_mag_arcsec2", "model_artificial_cd_m2", "model_natural_cd_m2"):
        found = [row[name] for row in said["readings"]]
        assert found == pytest.approx(compared[name].tolist(), rel=1e-6, abs=1e-9), name
    fit = measurements.fit_calibration(compared)
    for name in ("factor", "log_standard_error", "calibration", "rms_before_mag", "rms_after_mag"):
        assert said["calibration"][name] == pytest.approx(getattr(fit, name), rel=1e-5), name
    assert (said["calibration"]["readings"], said["calibration"]["places"]) == (fit.readings, fit.places) == (3, 2)
