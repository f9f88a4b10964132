"""A server with the demo scene: the one at SKYGLOW_URL, which scripts/python_package.sh starts."""

import logging
import os
import time

import httpx
import matplotlib as mpl
import pytest

import skyglow

mpl.use("Agg")
# A town of the demo, and a dark valley north of it.
TOWN, VALLEY = (46.17, 8.79), (46.53, 8.61)


@pytest.fixture(scope="session")
def url():
    where = os.environ.get("SKYGLOW_URL")
    if not where:
        pytest.exit("SKYGLOW_URL names no server: scripts/python_package.sh starts one", 1)
    for _ in range(600):
        if httpx.get(f"{where}/readyz").is_success:
            return where
        time.sleep(0.2)
    raise AssertionError(f"the server at {where} does not become ready")


@pytest.fixture(scope="session")
def client(url):
    with skyglow.Client(url) as client:
        yield client


@pytest.fixture(scope="session")
def town(client):
    return client.panorama(*TOWN)


@pytest.fixture
def bucket(monkeypatch):
    """The address of an S3 server of this process with a bucket `maps`."""
    from moto.server import ThreadedMotoServer

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    endpoint = "http://{}:{}".format(*server.get_host_and_port())
    for name, value in {"AWS_ACCESS_KEY_ID": "me", "AWS_SECRET_ACCESS_KEY": "mine", "AWS_REGION": "us-east-1"}.items():
        monkeypatch.setenv(name, value)
    httpx.put(f"{endpoint}/maps", timeout=120).raise_for_status()
    yield endpoint
    server.stop()
