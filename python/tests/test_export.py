"""GeoTIFFs with their catalogue and PMTiles from a map in shards: `make wheel` runs it, as the engine's other tests."""

import io
import json

import matplotlib.pyplot as plt
import numpy as np
import pystac
import pytest
import rasterio
from baking import bits, by_the_program, made
from pmtiles.reader import MmapSource, Reader, all_tiles
from pystac.validation.stac_validator import JsonSchemaSTACValidator
from rasterio.merge import merge

import skyglow
import skyglow.export
import skyglow.grids
import skyglow.stac


@pytest.fixture(scope="module")
def map_in_shards(client, tmp_path_factory):
    client.scenes()
    out = tmp_path_factory.mktemp("baked") / "demo.zarr"
    made(out, tile=(48, 88))
    return out


@pytest.fixture(scope="module")
def mosaic(map_in_shards, tmp_path_factory):
    folder = tmp_path_factory.mktemp("mosaic")
    return folder, skyglow.export.cogs(map_in_shards, folder, side=50)


def test_geotiffs_are_the_map(client, mosaic, tmp_path):
    """Every number, and what GDAL and a web server need of a Cloud-Optimized GeoTIFF."""
    folder, paths = mosaic
    assert len(paths) > 1
    values, transform = by_the_program(client, tmp_path / "whole.tif")
    joined, of_joined = merge(paths, nodata=np.nan)
    assert of_joined.almost_equals(transform)
    assert np.array_equal(bits(joined[0]), bits(values))
    with rasterio.open(paths[0]) as file:
        assert file.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert file.units == ("cd m-2",)
        assert json.loads(file.tags()["ASSUMPTIONS"])["turbidity"] == 3.3
    assert not list(folder.glob("*.unfinished"))


def test_the_catalogue_is_valid(mosaic):
    """By the schemas of STAC, which pystac brings; links lead to the files from wherever the folder lies."""
    folder, paths = mosaic
    collection = pystac.Collection.from_file(str(folder / "collection.json"))
    items = list(collection.get_items())
    assert {item.assets["data"].get_absolute_href() for item in items} == {str(path) for path in paths}
    validator = JsonSchemaSTACValidator()
    for path in folder.glob("*.json"):
        said = json.loads(path.read_text())
        kind = pystac.STACObjectType.COLLECTION if path.name == "collection.json" else pystac.STACObjectType.ITEM
        validator.validate_core(said, kind, "1.1.0", href=str(path))
        assert all(not link["href"].startswith("/") for link in said["links"]), said["links"]
    for item in items:
        with rasterio.open(item.assets["data"].get_absolute_href()) as file:
            assert item.properties["proj:shape"] == [file.height, file.width]
            assert item.properties["proj:transform"] == list(file.transform)[:6]
            assert item.bbox == pytest.approx(list(file.bounds))
            assert item.properties["proj:code"] == file.crs.to_string()
    broken = json.loads((folder / "collection.json").read_text())
    del broken["extent"]
    with pytest.raises(pystac.STACValidationError):
        validator.validate_core(broken, pystac.STACObjectType.COLLECTION, "1.1.0")


def test_a_map_may_be_one_file(client, map_in_shards, tmp_path):
    """One file with every number, and a valid catalogue that names its box once."""
    (path,) = skyglow.export.cogs(map_in_shards, tmp_path / "one")
    values, transform = by_the_program(client, tmp_path / "whole.tif")
    with rasterio.open(path) as file:
        assert np.array_equal(bits(file.read(1)), bits(values))
        assert file.transform.almost_equals(transform)
        bounds = list(file.bounds)
    collection = pystac.Collection.from_file(str(path.parent / "collection.json"))
    assert [list(box) for box in collection.extent.spatial.bboxes] == [pytest.approx(bounds)]
    assert [item.id for item in collection.get_items()] == [f"demo-{path.stem}"]
    JsonSchemaSTACValidator().validate_core(
        json.loads((path.parent / "collection.json").read_text()),
        pystac.STACObjectType.COLLECTION,
        "1.1.0",
        href=str(path.parent / "collection.json"),
    )


def test_boxes_are_joined_across_the_antimeridian():
    """The narrowest box around all: one whose west is east of its east, or of all longitudes, or a plain one."""
    fiji, samoa, chukotka = (176.0, -20.0, 179.0, -15.0), (-173.0, -15.0, -171.0, -13.0), (170.0, 62.0, -170.0, 70.0)
    assert skyglow.stac.around([fiji, samoa]) == (176.0, -20.0, -171.0, -13.0)
    assert skyglow.stac.around([samoa, fiji, chukotka]) == (170.0, -20.0, -170.0, 70.0)
    assert skyglow.stac.around([(8.0, 46.0, 9.0, 47.0), (7.0, 45.0, 8.0, 46.0)]) == (7.0, 45.0, 9.0, 47.0)
    halves = [(-180.0, -60.0, 0.0, 75.0), (0.0, -60.0, 180.0, 75.0)]
    assert skyglow.stac.around(halves) == (-180.0, -60.0, 180.0, 75.0)
    assert skyglow.stac.around([(-180.0, -60.0, 180.0, 75.0)]) == (-180.0, -60.0, 180.0, 75.0)


def archive(path):
    with path.open("rb") as file:
        read = MmapSource(file)
        reader = Reader(read)
        return reader.header(), reader.metadata(), dict(all_tiles(read))


def test_tiles_are_those_of_the_program(client, map_in_shards, tmp_path):
    """At the deepest zoom the same picture but for rounding, above it nearly; the same tiles in the same order."""
    by_the_program(client, tmp_path / "theirs.pmtiles")
    counts = []
    skyglow.export.pmtiles(map_in_shards, tmp_path / "mine.pmtiles", progress=lambda *count: counts.append(count))
    header, about, mine = archive(tmp_path / "mine.pmtiles")
    their_header, their_about, theirs = archive(tmp_path / "theirs.pmtiles")
    assert counts[-1][0] == counts[-1][1] == len(counts)
    for name in ("min_zoom", "max_zoom", "tile_type", "clustered"):
        assert header[name] == their_header[name], name
    # The scene has pixels beyond its last whole row of places.
    place_e7 = 1e7 * skyglow.export.baked(map_in_shards).grid.transform[1]
    for name in ("min_lon_e7", "min_lat_e7", "max_lon_e7", "max_lat_e7"):
        assert header[name] == pytest.approx(their_header[name], abs=place_e7), name
    assert about["description"].startswith(their_about["description"].partition(";")[0].partition(".")[0])
    assert mine.keys() == theirs.keys()
    # A server takes either in place of what it would compute.
    assert [about[name] for name in ("atlas_key", "atlas_step")] == [
        their_about[name] for name in ("atlas_key", "atlas_step")
    ]
    assert about["atlas_extent"] == pytest.approx(their_about["atlas_extent"], abs=place_e7 / 1e7)
    for place, png in mine.items():
        drawn, other = (plt.imread(io.BytesIO(each)) for each in (png, theirs[place]))
        differs = np.abs(drawn - other).max(axis=2)
        if place[0] == header["max_zoom"]:
            assert (differs > 0.01).mean() < 0.002, place
        else:
            assert differs.mean() < 0.005, place


def test_what_is_no_map_is_refused(tmp_path):
    with pytest.raises(skyglow.SkyglowError, match="no map of"):
        skyglow.export.cogs(tmp_path, tmp_path / "out")


def test_numbers_between_places_are_the_programs():
    """Linear between places, of those that have a number; none where the nearest has none; none off the grid."""
    nan = float("nan")
    values = np.array([[1.0, 2.0], [3.0, nan]])
    columns, rows = np.array([0.0, 0.5, 0.4, 0.9, nan]), np.array([0.0, 0.0, 0.4, 0.9, nan])
    found = skyglow.grids.between(values, columns, rows)
    assert found[:2] == pytest.approx([1.0, 1.5])
    assert found[2] == pytest.approx((0.36 * 1 + 0.24 * 2 + 0.24 * 3) / 0.84)
    assert np.isnan(found[3:]).all()
    assert skyglow.grids.halved(values).tolist() == [[2.0]]
    # A grid across the antimeridian, and one of all longitudes.
    across = skyglow.grids.Grid((10, 20), (170.0, 1.0, 0.0, 5.0, 0.0, -1.0), "EPSG:4326")
    assert across.bounds == (170.0, -5.0, -170.0, 5.0)
    columns, rows = across.positions(np.array([-179.5, 170.5, 169.0]), np.array([4.5, -4.5, 0.0]))
    assert columns.tolist()[:2] == [10.0, 0.0]
    assert rows.tolist()[:2] == [0.0, 9.0]
    assert np.isnan(columns[2])
    assert skyglow.grids.Grid((180, 360), (-180.0, 1.0, 0.0, 90.0, 0.0, -1.0), "EPSG:4326").bounds[::2] == (-180, 180)
    metres = skyglow.grids.Grid((10, 10), (400_000.0, 100.0, 0.0, 5_100_000.0, 0.0, -100.0), "EPSG:32632")
    assert metres.step_m == pytest.approx(100.0)
    columns, rows = metres.positions(np.array([metres.bounds[0] + 0.005]), np.array([metres.bounds[3] - 0.003]))
    assert 0 < columns[0] < 9
    assert 0 < rows[0] < 9
