"""The Kubernetes job that bakes a map in strips: its document, and what its shell does in a pod."""

import itertools
import os
import pathlib
import subprocess

import numpy as np
import pytest
import rasterio
import yaml

JOB = pathlib.Path(__file__).parents[2] / "deploy/kubernetes/atlas-job.yaml"
SIDES = ("WEST", "SOUTH", "EAST", "NORTH")


@pytest.fixture(scope="module")
def job():
    return yaml.safe_load(JOB.read_text())


@pytest.fixture(scope="module")
def container(job):
    (container,) = job["spec"]["template"]["spec"]["containers"]
    return container


@pytest.fixture(scope="module")
def variables(container):
    return {entry["name"]: entry["value"] for entry in container["env"]}


def bake(container, variables, program, folder, index, **more):
    """What a pod does, with `skyglow` found in a folder."""
    path = f"{program.parent}:{os.environ['PATH']}"
    environment = {**variables, "PATH": path, "FOLDER": str(folder), "JOB_COMPLETION_INDEX": str(index), **more}
    subprocess.run([*container["command"], *container["args"]], env=environment, check=True, capture_output=True)
    return folder / f"strip-{index}.tif"


def test_a_pod_bakes_each_strip(job, container, variables):
    spec = job["spec"]
    assert (job["apiVersion"], job["kind"], spec["completionMode"]) == ("batch/v1", "Job", "Indexed")
    assert spec["completions"] == int(variables["STRIPS"])
    # What a limit of tries for each index goes with.
    assert spec["template"]["spec"]["restartPolicy"] == "Never"
    assert all(isinstance(value, str) for value in variables.values()), "Kubernetes refuses numbers here"
    mounted = {mount["name"] for mount in container["volumeMounts"]}
    assert mounted == {volume["name"] for volume in spec["template"]["spec"]["volumes"]}


def test_strips_meet_and_are_the_whole(container, variables, tmp_path):
    """A program in the place of `skyglow` writes down what it is asked for."""
    program = tmp_path / "skyglow"
    program.write_text('#!/bin/sh\nfor last; do :; done\necho "$2" >"$last"\n')
    program.chmod(0o755)
    found = []
    for index in range(int(variables["STRIPS"])):
        said = bake(container, variables, program, tmp_path / "atlas", index).read_text()
        assert said.startswith("--bounds=")
        found.append([float(part) for part in said.removeprefix("--bounds=").split(",")])
    west, south, east, north = (float(variables[side]) for side in SIDES)
    assert {(strip[0], strip[2]) for strip in found} == {(west, east)}
    assert (found[0][3], found[-1][1]) == (north, south)
    for upper, lower in itertools.pairwise(found):
        assert upper[1] == lower[3] < upper[3]


def test_a_strip_is_baked_once(client, container, variables, tmp_path):
    """The first of three strips of the demo has the first third of its places, and is kept when it is there."""
    bounds = client.get("/api/v1/scenes/demo")["bounds"]
    program = pathlib.Path(os.environ["SKYGLOW_PROGRAM"])
    more = {
        "SKYGLOW_DATA": os.environ["SKYGLOW_ENGINE_DATA"],
        "SKYGLOW_PACKS": os.environ["SKYGLOW_ENGINE_PACKS"],
        "SKYGLOW_PLACES": "20000",
        "STRIPS": "3",
        **{side: str(bound) for side, bound in zip(SIDES, bounds, strict=True)},
    }
    strip = bake(container, variables, program, tmp_path / "atlas", 0, **more)
    with rasterio.open(strip) as file:
        values, edges, place_deg = file.read(1), file.bounds, file.res[1]
    assert values.shape[1] > 2 * values.shape[0] > 40
    assert np.all(values > 0)
    assert edges.top == pytest.approx(bounds[3])
    assert edges.bottom == pytest.approx(bounds[3] - (bounds[3] - bounds[1]) / 3, abs=place_deg)
    written_ns = strip.stat().st_mtime_ns
    bake(container, variables, program, tmp_path / "atlas", 0, **more)
    assert strip.stat().st_mtime_ns == written_ns
