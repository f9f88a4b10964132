"""OGC API - Processes 1.0 (18-062r2): its abstract tests, one by one."""

from __future__ import annotations

import base64
import json
import time
from typing import Any

from api import REL, Api, link
from requirements_of import requirement
from schemas import Schemas

PROCESSES = "ogcapi-processes-1/1.0"
EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0"
SITE = {"lat": 46.53, "lon": 8.61, "reduce_by": 0.3}
INPUTS: dict[str, dict[str, Any]] = {
    "influence": {"scene": "demo", "lat": 46.53, "lon": 8.61, "limit": 3},
    "plan": {"scene": "demo", "method": "target", "max_cut": 0.8, "sites": [SITE]},
}
ASYNC = {"prefer": "respond-async"}
SQUARE = {"type": "Polygon", "coordinates": [[[8.6, 45.9], [9.1, 45.9], [9.1, 46.3], [8.6, 46.3], [8.6, 45.9]]]}


def _begun(api: Api, schemas: Schemas, process: str, **more: Any) -> dict[str, Any]:
    answer = api.execute(process, {"inputs": INPUTS[process], **more}, **ASYNC)
    assert answer.status_code == 201, answer.text[:200]
    assert answer.headers["content-type"] == "application/json"
    job = answer.json()
    schemas.check("processes/statusInfo.yaml", job)
    assert answer.headers["location"].endswith(f"/jobs/{job['jobID']}")
    return job


def _ended(api: Api, job: dict[str, Any]) -> dict[str, Any]:
    for _ in range(600):
        status = api.json(f"/jobs/{job['jobID']}")
        if status["status"] not in ("accepted", "running"):
            return status
        time.sleep(0.2)
    raise AssertionError("the job does not end")


@requirement(PROCESSES, "core", "landingpage-op")
@requirement(PROCESSES, "core", "landingpage-success")
@requirement(PROCESSES, "core", "conformance-op")
@requirement(PROCESSES, "core", "conformance-success")
@requirement(PROCESSES, "core", "api-definition-op")
@requirement(PROCESSES, "core", "api-definition-success")
@requirement(PROCESSES, "core", "http")
def landing(api: Api, schemas: Schemas) -> None:
    page = api.json("/")
    schemas.check("processes/landingPage.yaml", page)
    assert api.status(link(page, "service-desc")["href"]) == 200
    declared = api.json(link(page, f"{REL}/conformance")["href"])
    schemas.check("processes/confClasses.yaml", declared)
    assert f"http://www.opengis.net/spec/{PROCESSES}/conf/core" in declared["conformsTo"]
    assert api.json(link(page, f"{REL}/processes")["href"]) == api.json("/processes")


@requirement(PROCESSES, "core", "process-list")
@requirement(PROCESSES, "core", "process-list-success")
@requirement(PROCESSES, "core", "pl-links")
def listed(api: Api, schemas: Schemas) -> None:
    everything = api.json("/processes")
    schemas.check("processes/processList.yaml", everything)
    link(everything, "self")
    assert {one["id"] for one in everything["processes"]} == set(INPUTS)


@requirement(PROCESSES, "core", "pl-limit-definition")
@requirement(PROCESSES, "core", "pl-limit-response")
def limit(api: Api, schemas: Schemas) -> None:
    assert len(api.json("/processes", limit=1)["processes"]) == 1
    assert api.json("/processes", limit=10000) == api.json("/processes")
    assert api.status("/processes", limit=0) == 400


@requirement(PROCESSES, "core", "process-description")
@requirement(PROCESSES, "core", "process-description-success")
@requirement(PROCESSES, "ogc-process-description", "json-encoding")
@requirement(PROCESSES, "ogc-process-description", "inputs-def")
@requirement(PROCESSES, "ogc-process-description", "input-def")
@requirement(PROCESSES, "ogc-process-description", "input-mixed-type")
@requirement(PROCESSES, "ogc-process-description", "outputs-def")
@requirement(PROCESSES, "ogc-process-description", "output-def")
def described(api: Api, schemas: Schemas) -> None:
    for one in api.json("/processes")["processes"]:
        whole = api.json(link(one, "self")["href"])
        schemas.check("processes/process.yaml", whole)
        for name, value in whole["inputs"].items():
            schemas.check("processes/inputDescription.yaml", value)
            schemas.check("processes/schema.yaml", value["schema"])
            assert set(INPUTS[one["id"]]) <= set(whole["inputs"]), name
        for value in whole["outputs"].values():
            schemas.check("processes/outputDescription.yaml", value)


@requirement(PROCESSES, "core", "process-exception/no-such-process")
@requirement(PROCESSES, "core", "job-exception-no-such-job")
@requirement(PROCESSES, "core", "job-results-exception/no-such-job")
def nothing_there(api: Api, schemas: Schemas) -> None:
    asked = {"/processes/tea": "no-such-process", "/jobs/tea": "no-such-job", "/jobs/tea/results": "no-such-job"}
    for path, name in asked.items():
        answer = api.get(path)
        assert answer.status_code == 404 and answer.json()["type"] == f"{EXCEPTIONS}/{name}", answer.text
        schemas.check("processes/exception.yaml", answer.json())
    assert api.execute("tea", {"inputs": {}}).json()["type"] == f"{EXCEPTIONS}/no-such-process"


@requirement(PROCESSES, "core", "process-execute-op")
@requirement(PROCESSES, "core", "process-execute-request")
@requirement(PROCESSES, "core", "process-execute-inputs")
@requirement(PROCESSES, "core", "process-execute-default-execution-mode")
@requirement(PROCESSES, "core", "process-execute-default-outputs")
@requirement(PROCESSES, "core", "process-execute-sync-raw-value-one")
def executed(api: Api, schemas: Schemas) -> None:
    for process, inputs in INPUTS.items():
        request = {"inputs": inputs}
        answer = api.execute(process, request)
        assert (answer.status_code, answer.headers["content-type"]) == (200, "application/json"), answer.text[:200]
        (output,) = api.json(f"/processes/{process}")["outputs"]
        same = api.execute(process, {**request, "outputs": {output: {"transmissionMode": "value"}}, "response": "raw"})
        if process == "influence":
            assert same.json() == answer.json()


@requirement(PROCESSES, "core", "process-execute-sync-document")
@requirement(PROCESSES, "json", "definition")
def as_a_document(api: Api, schemas: Schemas) -> None:
    for process, inputs in INPUTS.items():
        answer = api.execute(process, {"inputs": inputs, "response": "document"})
        assert answer.headers["content-type"] == "application/json"
        schemas.check("processes/results.yaml", answer.json())
        assert set(answer.json()) == set(api.json(f"/processes/{process}")["outputs"])


@requirement(PROCESSES, "core", "process-execute-input-inline-object")
@requirement(PROCESSES, "core", "process-execute-input-mixed-type")
@requirement(PROCESSES, "core", "process-execute-input-ref")
def inputs_in_other_forms(api: Api, schemas: Schemas) -> None:
    plain = api.execute("influence", {"inputs": {**INPUTS["influence"], "boundary": SQUARE}}).json()
    assert plain["boundary"]["share"] > 0
    qualified = {"value": SQUARE, "mediaType": "application/geo+json"}
    text = json.dumps(SQUARE)
    encoded = base64.b64encode(text.encode()).decode()
    by_reference = {"href": f"data:application/geo+json;base64,{encoded}", "type": "application/geo+json"}
    for boundary in (qualified, by_reference):
        request = {
            "inputs": {**INPUTS["influence"], "boundary": boundary, "lat": {"href": "data:application/json,46.53"}}
        }
        assert api.execute("influence", request).json() == plain


@requirement(PROCESSES, "core", "process-execute-input-validation")
def wrong_inputs(api: Api, schemas: Schemas) -> None:
    for inputs in ({"lat": 95}, {"lat": "north"}, {"boundary": 3}, {"tea": 1}):
        answer = api.execute("influence", {"inputs": {**INPUTS["influence"], **inputs}})
        assert answer.status_code == 400, inputs
        schemas.check("processes/exception.yaml", answer.json())


@requirement(PROCESSES, "core", "process-execute-auto-execution-mode")
@requirement(PROCESSES, "core", "process-execute-success-async")
@requirement(PROCESSES, "core", "job")
@requirement(PROCESSES, "core", "job-success")
@requirement(PROCESSES, "core", "job-results")
@requirement(PROCESSES, "core", "job-results-async-raw-value-one")
@requirement(PROCESSES, "core", "job-results-async-document")
def jobs(api: Api, schemas: Schemas) -> None:
    for response in ("raw", "document"):
        job = _begun(api, schemas, "influence", response=response)
        ended = _ended(api, job)
        schemas.check("processes/statusInfo.yaml", ended)
        assert ended["status"] == "successful" and ended["progress"] == 100
        results = api.json(link(ended, f"{REL}/results")["href"])
        same = api.execute("influence", {"inputs": INPUTS["influence"], "response": response}).json()
        assert results == same
        if response == "document":
            schemas.check("processes/results.yaml", results)


@requirement(PROCESSES, "core", "job-results-exception/results-not-ready")
@requirement(PROCESSES, "dismiss", "job-dismiss-op")
@requirement(PROCESSES, "dismiss", "job-dismiss-success")
def dismissed(api: Api, schemas: Schemas) -> None:
    sites = [{"lat": 46.53 + 0.01 * at, "lon": 8.61 + 0.013 * at, "reduce_by": 0.31} for at in range(12)]
    answer = api.execute("plan", {"inputs": {**INPUTS["plan"], "sites": sites}}, **ASYNC)
    job = answer.json()
    early = api.get(f"/jobs/{job['jobID']}/results")
    if api.json(f"/jobs/{job['jobID']}")["status"] in ("accepted", "running"):
        assert early.status_code == 404 and early.json()["type"] == f"{EXCEPTIONS}/result-not-ready", early.text
    gone = api.delete(f"/jobs/{job['jobID']}")
    assert gone.status_code == 200 and gone.json()["status"] == "dismissed"
    schemas.check("processes/statusInfo.yaml", gone.json())
    assert api.status(f"/jobs/{job['jobID']}") == 404


@requirement(PROCESSES, "core", "job-results-failed")
def failed(api: Api, schemas: Schemas) -> None:
    inputs = {**INPUTS["influence"], "lat": 10.0, "lon": 10.0}
    answer = api.execute("influence", {"inputs": inputs}, **ASYNC)
    assert answer.status_code == 201, answer.text[:200]
    ended = _ended(api, answer.json())
    assert ended["status"] == "failed"
    results = api.get(link(ended, f"{REL}/exceptions")["href"])
    assert results.status_code == 404, results.text[:200]
    schemas.check("processes/exception.yaml", results.json())
