"""Where maps in shards are kept: a folder and a bucket have the same files, and mend the same damage."""

import numpy as np
import obstore
import pyproj
import pytest
import xarray

import skyglow
from skyglow import stores
from skyglow.maps import Frame, Window
from skyglow.shards import open_shards

FRAME = Frame(
    shape=(100, 160),
    window=Window((0, 100), (0, 160)),
    patch=(8, 8),
    transform=(5.0, 0.1, 0.0, 50.0, 0.0, -0.1),
    crs_wkt=pyproj.CRS.from_epsg(4326).to_wkt(),
    bounds=(5.0, 40.0, 21.0, 50.0),
    unit="cd m-2",
    description="artificial luminance at the zenith",
    colour_range=(1e-6, 1e-2),
    attribution=None,
    date="2023",
    assumptions={"scene": {"id": "x", "version": "v", "illustrative": True}, "warnings": []},
    key="this map",
    atlas_key="this sky",
    query="",
)
TILE = (50, 80)


@pytest.fixture(params=["folder", "bucket"])
def place(request, tmp_path):
    """Where a map goes, with what is said to reach it, and the same for whoever damages it."""
    if request.param == "folder":
        return str(tmp_path / "map.zarr"), None, obstore.store.LocalStore(tmp_path / "map.zarr", mkdir=True)
    options = {"endpoint": request.getfixturevalue("bucket"), "client_options": {"allow_http": True}}
    return "s3://maps/map.zarr", options, obstore.store.from_url("s3://maps/map.zarr", **options)


def fill(shards, values):
    found = [shards.has(shard) for shard in shards.over(FRAME.window)]
    for shard in shards.over(FRAME.window):
        shards.write(shard, values[shards.at(shard).slices])
    return found


def test_a_damaged_map_is_mended(place):
    where, options, files = place
    values = np.random.default_rng(1).random(FRAME.shape, np.float32)
    assert fill(open_shards(where, FRAME, TILE, resume=True, options=options), values) == [False] * 4
    again = open_shards(where, FRAME, None, resume=True, options=options)
    assert all(again.has(shard) for shard in again.over(FRAME.window))
    keys = [again.key(shard) for shard in again.over(FRAME.window)]
    before = [bytes(obstore.get(files, key).bytes()) for key in keys]
    obstore.put(files, keys[0], before[0][:-9])
    obstore.put(files, keys[1], before[1][:100] + bytes(50) + before[1][150:])
    obstore.put(files, keys[2], b"")
    obstore.delete(files, keys[3])
    assert fill(again, values) == [False] * 4
    assert [bytes(obstore.get(files, key).bytes()) for key in keys] == before
    opened = xarray.open_zarr(stores.open_store(where, options), consolidated=False, chunks=None)
    assert np.array_equal(opened.luminance.values, values)
    assert opened.luminance.attrs["colour_range"] == [1e-6, 1e-2]
    assert opened.attrs["date"] == "2023"


def test_what_is_there_is_respected(place):
    where, options, files = place
    values = np.ones(FRAME.shape, np.float32)
    fill(open_shards(where, FRAME, TILE, resume=True, options=options), values)
    with pytest.raises(skyglow.SkyglowError, match="shards of"):
        open_shards(where, FRAME, (10, 10), resume=True, options=options)
    # Begun, and ended before its description was there: begun anew.
    obstore.delete(files, "zarr.json")
    assert fill(open_shards(where, FRAME, TILE, resume=True, options=options), values) == [False] * 4
    assert fill(open_shards(where, FRAME, TILE, resume=False, options=options), values) == [False] * 4
    # Somebody else's.
    obstore.delete(files, "zarr.json")
    obstore.delete(files, "luminance/zarr.json")
    with pytest.raises(skyglow.SkyglowError, match="no map of this program"):
        open_shards(where, FRAME, TILE, resume=False, options=options)
    assert bytes(obstore.get(files, "latitude/zarr.json").bytes())


def test_what_means_nothing_is_refused(tmp_path):
    with pytest.raises(ValueError, match="object storage alone"):
        stores.open_store(tmp_path, {"endpoint": "http://127.0.0.1:1"})
    assert stores.text("s3://maps/map.zarr") == "s3://maps/map.zarr"
    assert stores.text("map.zarr").startswith("/")
