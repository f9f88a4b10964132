"""What tests of baked maps have in common: a map of the demo, by the program and in shards."""

import os
import subprocess

import numpy as np
import rasterio

import skyglow.distributed

DATA = os.environ.get("SKYGLOW_ENGINE_DATA", "")
PACKS = os.environ.get("SKYGLOW_ENGINE_PACKS", "")
PLACES = 20_000
ASKED = {"turbidity": 3.3, "places": PLACES}


def by_the_program(client, path):
    """The map's numbers and its transform; of PMTiles the file alone."""
    client.scenes()
    asked = ["--scene", "demo", "--places", str(PLACES), "--turbidity", "3.3", "--device", "cpu", "-o", path]
    program = [os.environ["SKYGLOW_PROGRAM"], "atlas", "--data", DATA, "--packs", PACKS]
    subprocess.run([*program, *asked], check=True, stderr=subprocess.DEVNULL)
    if path.suffix != ".tif":
        return None
    with rasterio.open(path) as file:
        return file.read(1), file.transform


def made(out, client=None, **more):
    return skyglow.distributed.atlas("demo", out, client, packs=PACKS, data=DATA, **{**ASKED, **more})


def bits(values):
    return np.ascontiguousarray(values, np.float32).view(np.uint32)
