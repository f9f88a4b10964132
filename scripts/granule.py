#!/usr/bin/env python3
"""Writes a granule of made-up lights: 2 400 x 2 400 pixels of 15″, 10 to 20° E, 40 to 50° N, 1.5 million of them lit.

    scripts/granule.py granule.tif

The brightness layer's figures are of it: `skyglow ingest granule.tif --terrain TERRAIN` with the terrain that `lab planet` makes, then
`lab brightness DATA PACKS granule 2.5 on 6000000 300 --way tree` and `--way convolution`. Needs numpy and rasterio.
"""

import sys

import numpy
import rasterio
from rasterio.transform import from_origin

SIDE = 2_400
STEP_DEG = 1 / 240
TOWNS = 2_150
# A town's light falls off exponentially from its middle and ends at 5 of its radii; below this a pixel is dark, nW cm⁻² sr⁻¹.
FAINTEST = 0.3


def main(path):
    random = numpy.random.default_rng(51)
    lights = numpy.zeros((SIDE, SIDE), dtype=numpy.float64)
    # Sizes by a power law, as towns have: radius 1.5 to 12 pixels.
    radii = 1.5 / numpy.maximum(random.random(TOWNS), 0.015) ** 0.5
    for radius in numpy.minimum(radii, 12.0):
        column, row = random.random(2) * SIDE
        reach = int(5 * radius) + 1
        rows = slice(max(0, int(row) - reach), min(SIDE, int(row) + reach + 1))
        columns = slice(max(0, int(column) - reach), min(SIDE, int(column) + reach + 1))
        y, x = numpy.mgrid[rows, columns]
        distance = numpy.hypot(x + 0.5 - column, y + 0.5 - row) / radius
        lights[rows, columns] += 8 * radius * numpy.exp(-distance) * (distance < 5)
    lights *= 3 ** (2 * random.random(lights.shape) - 1)
    lights[lights < FAINTEST] = 0
    profile = {
        "driver": "GTiff", "width": SIDE, "height": SIDE, "count": 1, "dtype": "float32", "compress": "deflate",
        "crs": "EPSG:4326", "transform": from_origin(10.0, 50.0, STEP_DEG, STEP_DEG),
    }  # fmt: skip
    with rasterio.open(path, "w", **profile) as raster:
        raster.write(lights.astype(numpy.float32), 1)
    print(f"{numpy.count_nonzero(lights)} of {lights.size} pixels are lit")


if __name__ == "__main__":
    main(sys.argv[1])
