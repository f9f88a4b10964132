"""The Kubernetes job that bakes a map in strips: its document, and what its shell does for two of its pods."""

import os
import pathlib
import subprocess

import numpy as np
import pytest
import rasterio
import yaml

JOB = pathlib.Path(__file__).parents[2] / "deploy/kubernetes/atlas-job.yaml"


@pytest.fixture(scope="module")
def job():
    return yaml.safe_load(JOB.read_text())


@pytest.fixture(scope="module")
def container(job):
    (container,) = job["spec"]["template"]["spec"]["containers"]
    return container


def test_a_pod_bakes_each_strip(job, container):
    spec = job["spec"]
    variables = {entry["name"]: entry["value"] for entry in container["env"]}
    assert (job["apiVersion"], job["kind"], spec["completionMode"]) == ("batch/v1", "Job", "Indexed")
    assert spec["completions"] == int(variables["STRIPS"])
    # What an indexed job with a limit for each index must have.
    assert spec["template"]["spec"]["restartPolicy"] == "Never"
    assert all(isinstance(value, str) for value in variables.values()), "Kubernetes refuses numbers here"
    mounted = {mount["name"] for mount in container["volumeMounts"]}
    assert mounted == {volume["name"] for volume in spec["template"]["spec"]["volumes"]}


def test_its_strips_make_the_whole_map(client, container, tmp_path):
    """Two strips of the demo, as two pods make them, have all of its places and the same numbers where they meet."""
    west, south, east, north = client.get("/api/v1/scenes/demo")["bounds"]
    program = pathlib.Path(os.environ["SKYGLOW_PROGRAM"])
    variables = {entry["name"]: entry["value"] for entry in container["env"]} | {
        "PATH": f"{program.parent}:{os.environ['PATH']}",
        "SKYGLOW_DATA": os.environ["SKYGLOW_ENGINE_DATA"],
        "SKYGLOW_PACKS": os.environ["SKYGLOW_ENGINE_PACKS"],
        "SKYGLOW_PLACES": "20000",
        "FOLDER": str(tmp_path / "atlas"),
        "STRIPS": "2",
        **{
            name: str(value)
            for name, value in zip(("WEST", "SOUTH", "EAST", "NORTH"), (west, south, east, north), strict=True)
        },
    }

    def bake(**more):
        command = [*container["command"], *container["args"]]
        subprocess.run(command, env={**variables, **more}, check=True, capture_output=True)

    for index in (0, 1):
        bake(JOB_COMPLETION_INDEX=str(index))
    bake(JOB_COMPLETION_INDEX="0", STRIPS="1", FOLDER=str(tmp_path / "whole"))
    strips, whole = [], None
    for index in (0, 1):
        with rasterio.open(tmp_path / f"atlas/strip-{index}.tif") as file:
            strips.append(file.read(1))
    with rasterio.open(tmp_path / "whole/strip-0.tif") as file:
        whole = file.read(1)
    assert np.array_equal(np.concatenate(strips), whole, equal_nan=True)
    # What is there is kept.
    there = tmp_path / "atlas/strip-0.tif"
    written_ns = there.stat().st_mtime_ns
    bake(JOB_COMPLETION_INDEX="0")
    assert there.stat().st_mtime_ns == written_ns
