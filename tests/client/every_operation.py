"""Calls every GET operation, and the POST operations that these need, by a client that openapi-python-client generated.

Arguments: the server's address, its OpenAPI document, and the folder that holds the generated package `skyglow_client`. The
client sends every default that the document has, as generated clients do.
"""

import importlib
import inspect
import json
import pathlib
import sys
import time

url, document_path, folder = sys.argv[1:]
sys.path.insert(0, folder)
from skyglow_client import Client  # noqa: E402
from skyglow_client.models import InfluenceBody, PlanBody, Problem, ScenarioBody  # noqa: E402

document = json.loads(pathlib.Path(document_path).read_text())
client = Client(base_url=url, timeout=120.0, raise_on_unexpected_status=True)


def operations(methods):
    for path, item in document["paths"].items():
        for method in methods:
            if method in item:
                yield path, item[method]


def call(operation, **given):
    """The answer of an operation, which must be good and of the type that the document says."""
    name = operation["operationId"]
    module = importlib.import_module(f"skyglow_client.api.{operation['tags'][0]}.{name}")
    needed = inspect.signature(module.sync_detailed).parameters
    arguments = {key: value for key, value in given.items() if key in needed}
    answer = module.sync_detailed(client=client, **arguments)
    # A map that takes longer than an answer may goes on being made.
    deadline = time.monotonic() + 600
    while isinstance(answer.parsed, Problem) and answer.parsed.type_ == "/problems/being-made":
        assert time.monotonic() < deadline, f"{name}: {answer.content[:500]!r}"
        time.sleep(int(answer.headers["retry-after"]))
        answer = module.sync_detailed(client=client, **arguments)
    assert int(answer.status_code) in (200, 201), f"{name} {given}: {answer.status_code} {answer.content[:500]!r}"
    assert answer.parsed is not None and not isinstance(answer.parsed, Problem), f"{name}: {answer.content[:200]!r}"
    if hasattr(answer.parsed, "payload"):
        assert len(answer.parsed.payload.read()) > 0, f"{name}: no bytes"
    return answer


by_id = {operation["operationId"]: operation for _, operation in operations(("get", "post"))}
names = [operation["operationId"] for _, operation in operations(("get", "post", "put", "delete"))]
assert len(names) == len(set(names)) and all(name.isidentifier() and name.islower() for name in names), names

scene = call(by_id["list_scenes"]).parsed[0].id
place = call(by_id["list_places"], scene=scene).parsed[0]
sites = {"scene": scene, "lat": place.latitude_deg, "lon": place.longitude_deg}
brush = {"points": [[place.longitude_deg, place.latitude_deg]], "radius_m": 5000.0}
edits = ScenarioBody.from_dict({"edits": [{"brush": brush, "factor": 0.5}]})
scenario = call(by_id["post_scenario"], scene=scene, body=edits).parsed.id
cut = {"lat": place.latitude_deg, "lon": place.longitude_deg, "reduce_by": 0.2}
plan = call(by_id["post_plan"], scene=scene, body=PlanBody.from_dict({"method": "target", "sites": [cut]})).parsed.id
job = client.get_httpx_client().post(
    f"/api/v1/scenes/{scene}/plans",
    headers={"Prefer": "respond-async"},
    json={"method": "target", "sites": [cut]},
).json()["id"]
while call(by_id["get_job"], job=job).parsed.state in ("queued", "running"):
    time.sleep(0.2)
region = InfluenceBody.from_dict({"region": [[0, 20], [90, 20], [45, 60]]})

given = {**sites, "plan": plan, "job": job, "scenario": scenario, "kind": "busy", "z": 7, "x": 67, "y": "45"}
given |= {"tile_matrix": 7, "tile_col": 67, "tile_row": 45}
given |= {"date": "2026-08-20", "month": "2026-08", "name": "Locarno"}
given |= {"tileset": "brightness", "tms": "WebMercatorQuad", "process": "plan", "item": "radiance"}
coords = {
    "position": "POINT(8.79 46.17)",
    "trajectory": "LINESTRING(8.79 46.17,8.61 46.53)",
    "area": "POLYGON((8.6 46,9 46,9 46.3,8.6 46))",
}
count = 0
for path, operation in operations(("get",)):
    # The operator's basemap, of which this server has none.
    if path.startswith("/api/v1/basemap/"):
        continue
    arguments = dict(given)
    arguments["coords"] = coords.get(path.rsplit("/", 1)[-1])
    if "{scenario}" not in path:
        del arguments["scenario"]
    layers = ["radiance", "elevation", "brightness", "influence"] if "{layer}" in path else [None]
    for layer in layers:
        of_layer = {**arguments, "layer": layer}
        if layer not in (None, "influence"):
            del of_layer["lat"], of_layer["lon"]
        call(operation, **of_layer)
        count += 1
for path, operation in operations(("post",)):
    if "/influence" in path:
        call(operation, **sites, body=region)
        count += 1

# What is excluded by another parameter is not sent unasked.
call(by_id["get_sky"], **sites, altitude=3000.0)
png = importlib.import_module("skyglow_client.models").GetPanoramaPngProjection
call(by_id["get_panorama_png"], **sites, projection=png.FISHEYE)
style = importlib.import_module("skyglow_client.models").GetPanoramaPngStyle
call(by_id["get_panorama_png"], **sites, style=style.REALISTIC, exposure=2.0)
call(by_id["get_panorama_png"], **sites, style=style.EYE, time="2026-08-20T23:16:00Z")
sky = call(by_id["get_sky"], **sites, time="2026-08-20T23:16:00Z").parsed
assert sky.night_sky, sky
print(f"{count} calls of the generated client are answered")
