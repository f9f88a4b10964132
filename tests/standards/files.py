"""Files: Cloud-Optimized GeoTIFFs by rio-cogeo, and the Python package's netCDF by compliance-checker."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import rasterio
import skyglow
import xarray
from api import Api
from report import Report
from rio_cogeo.cogeo import cog_validate
from skyglow import datasets

VALLEY = (46.53, 8.61)
LAYERS = ["layers/radiance.tif", "layers/elevation.tif", "layers/brightness.tif", "influence.tif?lat=46.53&lon=8.61"]
CF_VERSION = "cf:1.11"
# The checker takes names along a dimension, such as those of bands, for numbers that must grow.
NO_NUMBERS = "check_coordinate_variables_strict_monotonicity"
COG, CF = "COG (rio cogeo validate --strict)", f"CF (compliance-checker --test {CF_VERSION} --criteria strict)"
NIGHT = "2026-08-12T23:00:00Z"


def _is_cog(path: str) -> None:
    is_valid, errors, warnings = cog_validate(path, strict=True, quiet=True)
    assert is_valid and not errors and not warnings, f"{path}: {errors} {warnings}"


def cogs(api: Api, report: Report, folder: Path) -> None:
    """The server's rasters, downloaded and by range, and one that is none."""
    for layer in LAYERS:
        url = f"{api.url}/api/v1/scenes/demo/{layer}"
        path = folder / f"{layer.partition('.')[0].replace('/', '-')}.tif"
        path.write_bytes(api.get(url).content)
        report.run(COG, layer, lambda path=path: _is_cog(str(path)))
        report.run(COG, f"{layer} by range", lambda url=url: _is_cog(f"/vsicurl/{url}"))
    plain = folder / "plain.tif"
    with rasterio.open(plain, "w", driver="GTiff", width=2000, height=2000, count=1, dtype="float32") as file:
        file.write(np.ones((2000, 2000), np.float32), 1)
    report.finds(COG, "one without tiles", lambda: _is_cog(str(plain)))


def exported(report: Report, given: list[Path]) -> None:
    """GeoTIFFs that `skyglow.export.cogs` wrote, where they are given."""
    for path in given:
        report.run(COG, f"exported {path.name}", lambda path=path: _is_cog(str(path)))


def _is_cf(path: Path) -> None:
    checker = str(Path(sys.executable).with_name("compliance-checker"))
    command = [checker, "--test", CF_VERSION, "--criteria", "strict", str(path)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert CF_VERSION in run.stdout, run.stderr[-1500:]
    said = [line for line in run.stdout.splitlines() if line.startswith("* ")]
    # Where a check fails by itself it says so in a line of its own.
    said += [line for line in run.stderr.splitlines() if line.startswith(f"{CF_VERSION}.") and NO_NUMBERS not in line]
    assert not said, f"{path.name}: {' '.join(said)[:2000]}"


def netcdf(api: Api, report: Report, folder: Path) -> None:
    """What the datasets of the package become as netCDF."""
    with skyglow.Client(api.url, scene="demo") as client:
        made = {
            "panorama": client.panorama(*VALLEY),
            "panorama at a time": client.panorama(*VALLEY, time=NIGHT),
            "several responses": client.panorama(*VALLEY, responses=["photopic", "scotopic", "sqm"]),
            "radiance seen": client.panorama(*VALLEY, response="dnb"),
            "influence map": datasets.of_layer(client.influence_map(*VALLEY)),
            "radiance": datasets.of_layer(client.layer("radiance")),
            "elevation": datasets.of_layer(client.layer("elevation")),
            "brightness": datasets.of_layer(client.layer("brightness")),
        }
    for name, dataset in made.items():
        path = folder / f"{name.replace(' ', '-')}.nc"
        dataset.to_netcdf(path)
        report.run(CF, name, lambda path=path: _is_cf(path))
    broken = xarray.open_dataset(folder / "panorama.nc")
    broken["luminance"].attrs["units"] = "candles"
    broken.to_netcdf(folder / "broken.nc")
    report.finds(CF, "a unit that is none", lambda: _is_cf(folder / "broken.nc"))
