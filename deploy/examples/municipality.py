#!/usr/bin/env python3
"""What a municipality asks, with requests and rasterio: a plan, where it dims, and that it does what it says.

Usage: municipality.py [SERVER] [FOLDER], against the demo scene. On Debian: apt-get install python3-requests python3-rasterio
"""

import json
import pathlib
import sys

import numpy
import rasterio
import requests

SERVER = sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:8080"
FOLDER = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")
HERE = pathlib.Path(__file__).parent
SCENE = f"{SERVER}/api/v1/scenes/demo"


def ask(method, url, **arguments):
    """An answer, or what is wrong as the server says it."""
    answer = requests.request(method, url, timeout=120, **arguments)
    if not answer.ok:
        sys.exit(f"{url}: {answer.json()['detail']}")
    return answer


def main():
    plan = ask("POST", f"{SCENE}/plans", params={"limit": 5}, json=json.loads((HERE / "plan.json").read_text())).json()
    for site in plan["sites"]:
        observer, target = site["observer"], site["target"]
        print(
            f"{observer['latitude_deg']:.2f}, {observer['longitude_deg']:.2f}: {site['measure']} "
            f"{site['before']:.3e} -> {site['after']:.3e} {site['unit']}"
            + ("" if target["is_met"] else f" ({target['why_not']})")
        )
    print(f"{plan['dimmed_pixels']} pixels give up {100 * plan['flux_removed_share']:.2f} % of the light")
    print("first of all:", [(pixel["latitude_deg"], pixel["longitude_deg"]) for pixel in plan["pixels"]])

    # The plan and the influences lie on the scene's own grid, so they can be laid on each other as they are.
    rasters = {}
    for name, url in {
        "plan": f"{SERVER}/api/v1/plans/{plan['id']}.tif",
        "influence": f"{SCENE}/influence.tif",
    }.items():
        place = {"lat": 46.30, "lon": 8.79} if name == "influence" else {}
        path = FOLDER / f"{name}.tif"
        path.write_bytes(ask("GET", url, params=place).content)
        with rasterio.open(path) as raster:
            assert raster.crs.to_epsg() == 4326, raster.crs
            rasters[name] = (raster.read(1), raster.transform, raster.units[0])
    cut, transform, _ = rasters["plan"]
    influence, _, unit = rasters["influence"]
    assert cut.shape == influence.shape and transform == rasters["influence"][1]
    assert numpy.nanmax(cut) <= 0.8 + 1e-6, "max_cut"
    assert numpy.count_nonzero(cut > 0) == plan["dimmed_pixels"]

    # What the plan takes from the zenith of the first site is the sum over what it takes from each pixel.
    taken = float(numpy.nansum(numpy.nan_to_num(cut) * numpy.nan_to_num(influence)))
    site = plan["sites"][0]
    print(f"by the rasters {taken:.4e}, by the sky {site['before'] - site['after']:.4e} {unit}")
    assert abs(taken / (site["before"] - site["after"]) - 1) < 0.01

    # The pixel that does most, on the map.
    row, column = numpy.unravel_index(numpy.nanargmax(influence), influence.shape)
    longitude, latitude = rasterio.transform.xy(transform, row, column)
    print(f"the most influential pixel is at {latitude:.4f}, {longitude:.4f}")

    # What if all were amber and shielded, with the plan upon it?
    square = [[8.5, 46.0], [9.2, 46.0], [9.2, 46.4], [8.5, 46.4], [8.5, 46.0]]
    edit = {"polygon": {"type": "Polygon", "coordinates": [square]}, "lamp": "pc_amber", "emission": "full_cutoff"}
    amber = ask("POST", f"{SCENE}/scenarios", json={"title": "amber", "base": plan["id"], "edits": [edit]}).json()
    place = {"lat": 46.30, "lon": 8.79}
    for name, scenario in {"today": None, "plan": plan["id"], "plan and amber": amber["id"]}.items():
        query = place if scenario is None else {**place, "scenario": scenario}
        sky = ask("GET", f"{SCENE}/sky", params=query).json()["sky"]
        print(f"{name}: {sky['zenith_total_brightness_mag_arcsec2']:.3f} mag/arcsec2")


if __name__ == "__main__":
    main()
