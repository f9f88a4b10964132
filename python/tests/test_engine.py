"""The engine in this process against a server with the same scene and the same packs: `make wheel` runs it.

SKYGLOW_ENGINE_DATA and SKYGLOW_ENGINE_PACKS name the server's own folders.
"""

import inspect
import io
import multiprocessing
import os
import signal
import threading
import time

import geopandas
import geopandas.testing
import matplotlib.pyplot as plt
import numpy as np
import pandas
import pytest
import shapely
from conftest import TOWN, VALLEY

import skyglow
import skyglow.widget

NIGHT = "2026-08-12T23:00:00Z"


@pytest.fixture(scope="session")
def engine(client):
    """Beside a server, which `client` waits for: it has made the demo scene."""
    client.scenes()
    return skyglow.Engine(os.environ["SKYGLOW_ENGINE_PACKS"], os.environ["SKYGLOW_ENGINE_DATA"], device="cpu")


def test_engine_and_client_have_one_interface(engine):
    def methods(of):
        return {name: method for name, method in inspect.getmembers(of, callable) if not name.startswith("_")}

    of_client, of_engine = methods(skyglow.Client), methods(skyglow.Engine)
    assert of_client.keys() - of_engine.keys() == {"close"}
    for name, method in of_engine.items():
        assert inspect.signature(method) == inspect.signature(of_client[name]), name
    assert engine.device.startswith("cpu")


@pytest.mark.parametrize(
    "asked",
    [{}, {"turbidity": 3.3, "lamp": {"hps": 0.7, "led_4000k": 0.3}, "terrain": False}, {"time": NIGHT}],
    ids=["plain", "lamps", "night"],
)
def test_skies_are_those_of_a_server(engine, client, asked):
    assert engine.sky(*TOWN, **asked) == client.sky(*TOWN, **asked)
    assert engine.panorama(*TOWN, **asked).identical(client.panorama(*TOWN, **asked))
    assert engine.picture(*TOWN, **asked) == client.picture(*TOWN, **asked)


def test_responses_are_those_of_a_server(engine, client):
    of_engine, of_client = (who.panorama(*VALLEY, responses=["photopic", "scotopic"]) for who in (engine, client))
    assert of_engine.sizes["response"] == 2
    assert of_engine.identical(of_client)


def test_influences_are_those_of_a_server(engine, client):
    area = shapely.box(8.6, 45.9, 9.1, 46.3)
    of_engine = engine.influence(*VALLEY, limit=50, boundary=area, measure="mean")
    of_client = client.influence(*VALLEY, limit=50, boundary=area, measure="mean")
    geopandas.testing.assert_geodataframe_equal(of_engine, of_client)
    assert of_engine.attrs == of_client.attrs
    for areas in (
        None,
        {
            "type": "FeatureCollection",
            "features": [{"type": "Feature", "properties": {"name": "x"}, "geometry": area.__geo_interface__}],
        },
    ):
        of_engine, of_client = engine.shares(*VALLEY, areas=areas), client.shares(*VALLEY, areas=areas)
        geopandas.testing.assert_geodataframe_equal(of_engine, of_client)
        assert of_engine.attrs == of_client.attrs
    assert engine.influence_map(*VALLEY).identical(client.influence_map(*VALLEY))


@pytest.mark.parametrize("name", ["radiance", "elevation", "brightness"])
def test_layers_are_those_of_a_server(engine, client, name):
    of_engine = engine.layer(name)
    assert of_engine.identical(client.layer(name))
    assert float(of_engine.max()) > 0


def test_batches_are_those_of_a_server(engine, client):
    places = client.places().head(40)
    of_engine = engine.skies(places, turbidity=3, times=[NIGHT, "2026-12-01T00:00:00Z"])
    geopandas.testing.assert_geodataframe_equal(
        of_engine, client.skies(places, turbidity=3, times=[NIGHT, "2026-12-01T00:00:00Z"])
    )
    assert len(of_engine) == 80
    assert of_engine.attrs["turbidity"] == 3
    kept = engine.skies([TOWN, (0.0, 0.0)], keep_problems=True)
    geopandas.testing.assert_geodataframe_equal(kept, client.skies([TOWN, (0.0, 0.0)], keep_problems=True))
    with pytest.raises(skyglow.OutsideSceneError):
        engine.skies([TOWN, (0.0, 0.0)])


def test_the_rest_is_that_of_a_server(engine, client):
    for what in (
        lambda who: who.scenes(),
        lambda who: who.atmospheres(),
        lambda who: who.night(*TOWN, "2026-08-12"),
        lambda who: who.get("/api/v1/scenes/demo"),
        lambda who: who.get("/api/v1/scenes/demo/site", lat=TOWN[0], lon=TOWN[1]),
    ):
        assert what(engine) == what(client)
    geopandas.testing.assert_geodataframe_equal(engine.places(), client.places())
    pandas.testing.assert_frame_equal(engine.nights(*TOWN, "2026-08"), client.nights(*TOWN, "2026-08"))
    for operation in ("get_sky", "get_influence_json", "post_plan"):
        pandas.testing.assert_frame_equal(engine.parameters(operation), client.parameters(operation))


def test_a_widget_needs_no_server(engine, client):
    """Its map is drawn from an engine's numbers, of fewer places, in the colours of a server's."""
    maps = []
    for source in (engine, client):
        sky = skyglow.widget.Sky(source, "demo", *TOWN)
        assert sky.sky == client.sky(*TOWN)
        sky.send = lambda _, buffers: maps.append(buffers[0])
        sky._handle_custom_msg({"kind": "map", "bounds": [5.0, 43.0, 14.0, 49.0], "size_px": [90, 60]}, [])
    mine, theirs = (plt.imread(io.BytesIO(png)) for png in maps)
    assert mine.shape == theirs.shape == (60, 90, 4)
    assert np.ptp(mine[..., 0]) > 0.5
    assert np.abs(mine - theirs).mean() < 0.02


def test_scenarios_and_plans_are_those_of_a_server(engine, client):
    edits = {"edits": [{"brush": {"points": [[TOWN[1], TOWN[0]]], "radius_m": 4000}, "factor": 0.25}]}
    of_engine, of_client = engine.scenario(edits), client.scenario(edits)
    assert of_engine.id == of_client.id
    assert engine.sky(*TOWN, scenario=of_engine.id) == client.sky(*TOWN, scenario=of_client.id)
    site = {"lat": TOWN[0], "lon": TOWN[1], "reduce_by": 0.2}
    request = {"method": "target", "sites": [site], "max_cut": 0.5}
    of_engine, of_client = engine.plan(request), client.plan(request)
    geopandas.testing.assert_geodataframe_equal(of_engine.frame(), of_client.frame())
    assert of_engine.sites == of_client.sites


def test_problems_are_those_of_a_server(engine, client):
    for ask in (
        lambda who: who.sky(*TOWN, turbidity=99, lamp="candle"),
        lambda who: who.sky(*TOWN, turbidty=3),
        lambda who: who.sky(0.0, 0.0),
        lambda who: who.sky(*TOWN, altitude=90_000),
        lambda who: who.sky(*TOWN, scene="nowhere"),
        lambda who: who.sky(*TOWN, scenario="s-00000000000000000000"),
        lambda who: who.skies([TOWN], turbidity=99),
        lambda who: who.plan({"method": "magic"}),
        lambda who: who.get("/api/v1/nothing"),
    ):
        with pytest.raises(skyglow.ProblemError) as of_client:
            ask(client)
        with pytest.raises(type(of_client.value)) as of_engine:
            ask(engine)
        assert (of_engine.value.kind, of_engine.value.title) == (of_client.value.kind, of_client.value.title)
        assert (of_engine.value.errors, of_engine.value.bounds) == (of_client.value.errors, of_client.value.bounds)
        assert of_engine.value.status is None


def test_what_cannot_be_opened_is_said(tmp_path, monkeypatch):
    with pytest.raises(skyglow.SkyglowError, match="no table packs"):
        skyglow.Engine(tmp_path, tmp_path)
    monkeypatch.delenv("SKYGLOW_PACKS", raising=False)
    monkeypatch.setattr("skyglow.engine.SHARED_PACKS", "nowhere")
    with pytest.raises(skyglow.SkyglowError, match="SKYGLOW_PACKS"):
        skyglow.Engine(data=tmp_path)
    with pytest.raises(ValueError, match="lavapipe"):
        skyglow.Engine(os.environ["SKYGLOW_ENGINE_PACKS"], tmp_path, device="abacus")


def test_other_threads_go_on_meanwhile(engine):
    """A thread counts while a batch is made; with Python's lock held it would not get beyond the first few."""
    count, is_done = 0, threading.Event()

    def work():
        nonlocal count
        while not is_done.wait(0.001):
            count += 1

    counter = threading.Thread(target=work)
    counter.start()
    begun = time.perf_counter()
    engine.skies([TOWN] * 100)
    passed_s = time.perf_counter() - begun
    is_done.set()
    counter.join()
    assert count > 0.1 * passed_s / 0.001


def test_control_c_ends_a_batch(engine):
    """Long before a thousand skies would be there, by the time that a tenth as many take."""
    main = threading.main_thread().ident
    times = [f"2026-08-12T{hour:02d}:{minute:02d}:00Z" for hour in range(10) for minute in range(10)]
    begun = time.perf_counter()
    engine.skies([TOWN], times=times)
    a_tenth_s = time.perf_counter() - begun
    told = []

    def interrupt():
        told.append(time.perf_counter())
        signal.pthread_kill(main, signal.SIGINT)

    threading.Timer(0.2, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        engine.skies([TOWN] * 10, times=times)
    # By the machine's own speed at this moment: under load everything takes longer.
    assert time.perf_counter() - told[0] < max(2.0, 3.0 * a_tenth_s)
    assert engine.sky(*TOWN).sky.zenith_luminance_cd_m2 > 0


def _ask_in_a_fork(engine, answers):
    try:
        engine.sky(*TOWN)
    except RuntimeError as error:
        answers.put(str(error))


@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_forked_process_is_told_to_make_its_own(engine):
    context = multiprocessing.get_context("fork")
    answers = context.Queue()
    child = context.Process(target=_ask_in_a_fork, args=(engine, answers))
    child.start()
    assert "make an engine in each process" in answers.get(timeout=20)
    child.join(20)
    assert child.exitcode == 0
