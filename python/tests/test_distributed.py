"""Maps by several processes, against the map of the program: `make wheel` runs it, as the engine's other tests."""

import os
import signal
import subprocess
import sys

import numpy as np
import obstore
import pytest
from baking import ASKED, DATA, PACKS, bits, by_the_program, made

import skyglow
import skyglow.distributed
import skyglow.maps
import skyglow.shards

TILES = (5, 6)


@pytest.fixture(scope="module")
def whole(client, tmp_path_factory):
    """The map as one process of the program makes it."""
    return by_the_program(client, tmp_path_factory.mktemp("whole") / "whole.tif")


@pytest.fixture(scope="module")
def engine(client):
    client.scenes()
    # The one that this process keeps when it bakes.
    return skyglow.distributed._engine(PACKS, DATA)


@pytest.fixture
def tile(whole):
    rows, columns = whole[0].shape
    return -(-rows // TILES[0]), -(-columns // TILES[1])


def files(out):
    return sorted(path for path in (out / "luminance" / "c").rglob("*") if path.is_file())


def test_a_part_has_the_numbers_of_the_whole(engine, whole):
    chart = skyglow.maps.BrightnessMap(engine, "demo", **ASKED)
    frame = chart.frame((8.5, 46.1, 9.1, 46.5))
    assert frame.shape == whole[0].shape
    assert frame.unit == "cd m-2"
    part = chart.part(frame.window)
    assert part.shape == frame.window.shape < frame.shape
    assert np.array_equal(bits(part), bits(whole[0][frame.window.slices]))
    with pytest.raises(skyglow.InvalidRequestError, match="no such places"):
        chart.part(skyglow.maps.Window((0, frame.shape[0] + 1), (0, 1)))
    with pytest.raises(skyglow.InvalidRequestError):
        skyglow.maps.BrightnessMap(engine, "demo", turbidity=99).frame()
    with pytest.raises(skyglow.SkyglowError, match="no place"):
        chart.frame((0.0, 0.0, 1.0, 1.0))
    other = skyglow.maps.BrightnessMap(engine, "demo", **{**ASKED, "turbidity": 3.4}).frame()
    assert other.key != frame.key == chart.frame().key


def test_a_killed_worker_changes_no_number(whole, tile, tmp_path):
    """Thirty shards, a worker killed in the middle, then a shard deleted and one cut short: the same bits each time."""
    from dask.distributed import Client, LocalCluster

    out, killed = tmp_path / "demo.zarr", []

    def kill_one(done, shards):
        if done == shards // 3 and not killed:
            killed.append(pids[0])
            os.kill(pids[0], signal.SIGKILL)

    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50)
    with cluster, Client(cluster) as workers:
        pids = list(workers.run(os.getpid).values())
        report = made(out, workers, tile=tile, progress=kill_one)
        assert (report.shards, report.found) == (30, 0)
        assert killed
        assert not set(killed) & set(workers.run(os.getpid).values()), "it was killed"
        assert np.array_equal(bits(report.open().luminance), bits(whole[0]))

        before = {path: path.read_bytes() for path in files(out)}
        assert len(before) == 30
        deleted, cut = files(out)[7], files(out)[19]
        deleted.unlink()
        cut.write_bytes(before[cut][:-9])
        again = made(out, workers)
        assert (again.shards, again.found) == (30, 28)
        assert {path: path.read_bytes() for path in files(out)} == before
        assert np.array_equal(bits(again.open().luminance), bits(whole[0]))


def test_a_map_describes_itself_and_grows(whole, tile, tmp_path):
    """By this process, part by part; as CF has it. What is another map is not gone on with."""
    out = tmp_path / "demo.zarr"
    part = made(out, tile=tile, bounds=(8.5, 46.1, 8.9, 46.3))
    assert 0 < part.shards < 30
    chart = part.open()
    values, transform = whole
    assert chart.luminance.dims == ("latitude", "longitude")
    assert chart.luminance.attrs["units"] == "cd m-2"
    assert chart.luminance.attrs["long_name"] == "artificial luminance at the zenith"
    assert chart.spatial_ref.attrs["grid_mapping_name"] == "latitude_longitude"
    assert chart.attrs["Conventions"].startswith("CF-")
    assert '"turbidity": 3.3' in chart.attrs["assumptions"]
    west, north = transform.c + 0.5 * transform.a, transform.f + 0.5 * transform.e
    assert float(chart.longitude[0]) == pytest.approx(west)
    assert float(chart.latitude[0]) == pytest.approx(north)
    is_there = ~np.isnan(chart.luminance.values)
    assert 0 < is_there.mean() < 1
    assert np.array_equal(bits(chart.luminance)[is_there], bits(values)[is_there])

    counts = []
    made(out, bounds=(8.5, 46.1, 8.9, 46.5), progress=lambda done, shards: counts.append((done, shards)))
    assert counts[0][0] == part.shards
    assert counts[-1][0] == counts[-1][1]
    with pytest.raises(skyglow.SkyglowError, match="resume=False"):
        made(out, turbidity=3.4)
    with pytest.raises(skyglow.SkyglowError, match="shards of"):
        made(out, tile=(7, 7))
    anew = made(out, tile=tile, bounds=(8.5, 46.1, 8.6, 46.2), resume=False)
    assert (anew.found, len(files(out))) == (0, anew.shards)
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "notes.txt").write_text("mine")
    with pytest.raises(skyglow.SkyglowError, match="no map of this program"):
        made(theirs, resume=False)
    assert (theirs / "notes.txt").read_text() == "mine"


def test_a_bucket_holds_a_map_too(whole, tile, bucket):
    """On object storage: part by part, by this process and a worker, with a shard deleted and one cut short."""
    from dask.distributed import Client, LocalCluster

    out, options = "s3://maps/demo.zarr", {"endpoint": bucket, "client_options": {"allow_http": True}}
    part = made(out, tile=tile, bounds=(8.5, 46.1, 8.9, 46.3), store=options)
    assert 0 < part.shards < 30
    first = "luminance/c/0/0"
    kept = obstore.store.from_url(out, **options)

    def shards():
        return {entry["path"] for page in obstore.list(kept, "luminance/c") for entry in page}

    assert len(shards()) == part.shards
    cluster = LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None, silence_logs=50)
    with cluster, Client(cluster) as workers:
        report = made(out, workers, store=options)
    assert (report.shards, report.found) == (30, part.shards)
    assert np.array_equal(bits(report.open().luminance), bits(whole[0]))
    before = {path: bytes(obstore.get(kept, path).bytes()) for path in shards()}
    obstore.delete(kept, "luminance/c/1/1")
    obstore.put(kept, first, before[first][:-9])
    again = made(out, store=options)
    assert (again.shards, again.found) == (30, 28)
    assert {path: bytes(obstore.get(kept, path).bytes()) for path in shards()} == before
    # A map that was begun and has no description yet is begun anew; what is of somebody else is left alone.
    obstore.delete(kept, "zarr.json")
    assert made(out, tile=tile, bounds=(8.5, 46.1, 8.6, 46.2), store=options).found == 0
    obstore.put(obstore.store.from_url("s3://maps/theirs", **options), "notes.txt", b"mine")
    with pytest.raises(skyglow.SkyglowError, match="no map of this program"):
        made("s3://maps/theirs", store=options, resume=False)


def test_shards_beyond_the_last_column():
    """Of a map around the Earth, whose last shard is narrow: bounds across its ends have shards of both, each once."""
    assert skyglow.shards._over((86_160, 86_640), 1024, 86_400) == [84, 0]
    assert skyglow.shards._over((1_000, 1_025), 1024, 86_400) == [0, 1]
    assert skyglow.shards._over((500, 86_700), 1024, 86_400) == list(range(85))


def test_without_zarr_it_says_what_is_missing():
    code = "import sys; sys.modules['zarr'] = None; import skyglow, skyglow.distributed"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert said.returncode == 1
    assert "skyglow[distributed]" in said.stderr
