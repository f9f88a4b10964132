"""OGC API - Common 1 (19-072) and 2 (20-024), and EDR 1.1 (19-086r6): their abstract tests, one by one."""

from __future__ import annotations

from api import AREA, LINE, POINT, REL, Api, link, links
from requirements_of import requirement
from schemas import Schemas

COMMON, COLLECTIONS, EDR = "ogcapi-common-1/1.0", "ogcapi-common-2/1.0", "ogcapi-edr-1/1.1"
CRS84 = "http://www.opengis.net/def/crs/OGC/1.3/CRS84"
QUERIES = {"position": POINT, "trajectory": LINE, "area": AREA}


def _query(api: Api, kind: str, **query: str):
    scene = api.collections()[0]["id"]
    return api.get(f"/collections/{scene}/{kind}", coords=QUERIES[kind], **query)


@requirement(COMMON, "core", "http")
@requirement(EDR, "core", "http")
def http(api: Api, schemas: Schemas) -> None:
    assert api.get("/").http_version == "HTTP/1.1"


@requirement(COMMON, "core", "query-param-name-unknown")
def unknown_names(api: Api, schemas: Schemas) -> None:
    for path in ("/", "/conformance", "/collections", "/processes", "/tileMatrixSets"):
        assert api.status(path, nonsense="1") == 400, path
    assert _query(api, "position", nonsense="1").status_code == 400


@requirement(COMMON, "core", "query-param-value-invalid")
def invalid_values(api: Api, schemas: Schemas) -> None:
    assert api.status("/", f="tea") == 400
    assert _query(api, "position", turbidity="much").status_code == 400


@requirement(COMMON, "core", "query-param-capitalization")
def capitals(api: Api, schemas: Schemas) -> None:
    assert api.status("/", F="json") == 400
    assert api.status("/", f="JSON") == 400
    paths = [
        f"/collections/demo/position?coords=POINT(8.79{space}46.17)%{comma}"
        for space, comma in (("%20", "0A"), ("%20", "0a"))
    ]
    assert len({api.status(path) for path in paths}) == 1


@requirement(COMMON, "core", "query-param-value-decimal")
@requirement(COMMON, "core", "query-param-value-double")
def numbers(api: Api, schemas: Schemas) -> None:
    answers = [
        _query(api, "position", turbidity=value).json()["ranges"] for value in ("3", "3.0", "03.00", "3e0", "0.3e1")
    ]
    assert all(answer == answers[0] for answer in answers)


@requirement(COMMON, "core", "query-param-list-delimiter")
def lists(api: Api, schemas: Schemas) -> None:
    two = _query(api, "position", **{"parameter-name": "bortle_class,zenith_luminance_cd_m2"}).json()
    assert set(two["ranges"]) == {"bortle_class", "zenith_luminance_cd_m2"}


@requirement(COMMON, "landing-page", "root-op")
@requirement(COMMON, "landing-page", "root-success")
@requirement(COMMON, "json", "definition")
@requirement(COMMON, "json", "content")
@requirement(EDR, "core", "root-op")
@requirement(EDR, "core", "root-success")
def landing(api: Api, schemas: Schemas) -> None:
    for path in ("", "/"):
        page = api.json(path)
        schemas.check("common/landingPage.yaml", page)
        schemas.check("edr/core/landingPage.yaml", page)
        link(page, "service-desc", "service-doc")
        link(page, f"{REL}/conformance")
        link(page, "conformance")
        link(page, "data")


@requirement(COMMON, "landing-page", "api-definition-op")
@requirement(COMMON, "landing-page", "api-definition-success")
@requirement(EDR, "core", "api-definition-op")
@requirement(EDR, "core", "api-definition-success")
def definitions(api: Api, schemas: Schemas) -> None:
    page = api.json("/")
    described = links(page, "service-desc") + links(page, "service-doc")
    assert described
    for each in described:
        answer = api.get(each["href"])
        assert answer.status_code == 200, each
        sent, said = (kind.split(";")[0] for kind in (answer.headers["content-type"], each["type"]))
        assert sent == said, f"{each['href']} is {sent}, not {said}"
        if each["rel"] == "service-desc":
            assert answer.json()["openapi"].startswith("3.")
            known = answer.json()["paths"]
            assert {"/api/ogc/conformance", "/api/ogc/collections/{scene}/position"} <= set(known)


@requirement(COMMON, "landing-page", "conformance-op")
@requirement(COMMON, "landing-page", "conformance-success")
@requirement(EDR, "core", "conformance")
@requirement(EDR, "core", "conformance-success")
def conformance(api: Api, schemas: Schemas) -> None:
    declared = api.json("/conformance")
    assert declared == api.json(link(api.json("/"), f"{REL}/conformance")["href"])
    schemas.check("common/confClasses.yaml", declared)
    schemas.check("edr/core/confClasses.yaml", declared)
    for wanted in (f"{COMMON}/conf/core", f"{COLLECTIONS}/conf/collections", f"{EDR}/conf/core"):
        assert f"http://www.opengis.net/spec/{wanted}" in declared["conformsTo"], wanted


@requirement(COLLECTIONS, "collections", "collections-list-op")
@requirement(COLLECTIONS, "collections", "collections-list-success")
@requirement(COLLECTIONS, "collections", "collections-list-links")
@requirement(COLLECTIONS, "collections", "collections-list-collections")
@requirement(COLLECTIONS, "json", "definition")
@requirement(COLLECTIONS, "json", "content")
@requirement(EDR, "collections", "rc-md-op")
@requirement(EDR, "collections", "rc-md-success")
def collections(api: Api, schemas: Schemas) -> None:
    listed = api.json("/collections")
    schemas.check("common-geodata/common-geodata/collections.yaml", listed)
    schemas.check("edr/collections/collections.yaml", listed)
    assert api.json(link(listed, "self")["href"]) == listed
    assert all("rel" in each and "type" in each for each in listed["links"])
    assert listed["collections"]


@requirement(COLLECTIONS, "collections", "description-op")
@requirement(COLLECTIONS, "collections", "description-success")
@requirement(COLLECTIONS, "collections", "description-links")
@requirement(EDR, "collections", "src-md-op")
@requirement(EDR, "collections", "src-md-success")
@requirement(EDR, "collections", "rc-collection-info-links")
@requirement(EDR, "json", "definition")
@requirement(EDR, "json", "content")
def collection(api: Api, schemas: Schemas) -> None:
    for listed in api.collections():
        one = api.json(f"/collections/{listed['id']}")
        schemas.check("common-geodata/common-geodata/collectionDesc.yaml", one)
        schemas.check("edr/collections/collection.yaml", one)
        assert all(one[name] == listed[name] for name in listed if name != "links")
        assert api.json(link(one, "self")["href"]) == one
        assert links(one, "data"), "no link to a query"
        assert all("rel" in each and "type" in each for each in one["links"])


@requirement(COLLECTIONS, "collections", "description-extent")
@requirement(COLLECTIONS, "collections", "description-extent-multi")
@requirement(EDR, "collections", "rc-extent")
@requirement(EDR, "collections", "crs")
def extent(api: Api, schemas: Schemas) -> None:
    for one in api.collections():
        spatial = one["extent"]["spatial"]
        (west, south, east, north) = spatial["bbox"][0]
        assert spatial["crs"] == CRS84
        # What lies outside is not answered, what lies inside is.
        place = f"POINT({(west + east) / 2} {(south + north) / 2})"
        inside = api.json(f"/collections/{one['id']}/position", coords=place)
        assert inside["domain"]["referencing"][0]["system"]["id"] == CRS84
        assert api.status(f"/collections/{one['id']}/position", coords=f"POINT({west - 1} {south})") == 404


@requirement(EDR, "collections", "rc-collection-info")
@requirement(EDR, "collections", "rc-data-queries")
@requirement(EDR, "collections", "rc-common-query-type")
@requirement(EDR, "collections", "rc-common-variables")
@requirement(EDR, "collections", "rc-md-query-links")
@requirement(EDR, "collections", "rc-crs")
def data_queries(api: Api, schemas: Schemas) -> None:
    everything = api.collections()
    assert len({one["id"] for one in everything}) == len(everything)
    for one in everything:
        assert {"title", "description", "keywords", "extent", "links", "crs", "output_formats"} <= set(one)
        assert set(one["data_queries"]) == set(QUERIES)
        for kind, query in one["data_queries"].items():
            described = query["link"]
            variables = described["variables"]
            assert {"href", "rel", "variables"} <= set(described) and variables["query_type"] == kind
            assert variables["default_output_format"] in variables["output_formats"]
            assert all(
                each["crs"] in one["crs"] and each["wkt"].startswith("GEOGCS[") for each in variables["crs_details"]
            )
            answer = api.get(described["href"], coords=QUERIES[kind])
            assert answer.status_code == 200, answer.text[:200]


@requirement(EDR, "collections", "rc-parameters")
def parameters(api: Api, schemas: Schemas) -> None:
    for one in api.collections():
        for name, parameter in one["parameter_names"].items():
            schemas.check("edr/collections/parameterNames.yaml", parameter)
            assert parameter["id"] == name and {"id", "label"} <= set(parameter["observedProperty"])
            symbol = parameter["unit"]["symbol"]
            assert isinstance(symbol, str) or symbol["type"] == "http://www.opengis.net/def/uom/UCUM/"


@requirement(EDR, "covjson", "definition")
@requirement(EDR, "covjson", "content")
def coverages(api: Api, schemas: Schemas) -> None:
    asked = [("position", {}), ("position", {"datetime": "2026-08-12T22:00:00Z"}), ("area", {}), ("trajectory", {})]
    for kind, query in [*asked, ("trajectory", {"datetime": "2026-08-12T22:00:00Z"})]:
        answer = _query(api, kind, **query)
        assert answer.status_code == 200, answer.text[:200]
        assert answer.headers["content-type"] == "application/prs.coverage+json"
        coverage = answer.json()
        if kind == "position":
            # That of EDR refuses every array with an axis: two of its alternatives hold at once.
            schemas.check("edr/covjson/coverageJSON.yaml", coverage)
        schemas.check("covjson/coveragejson.json", coverage)
        assert set(coverage["ranges"]) == set(coverage["parameters"])
        for name, values in coverage["ranges"].items():
            size = 1
            for length in values.get("shape", []):
                size *= length
            assert len(values["values"]) == size, name


@requirement(EDR, "collections", "coords, crs, f, parameter-name of queries")
def query_parameters(api: Api, schemas: Schemas) -> None:
    scene = api.collections()[0]["id"]
    for kind in QUERIES:
        assert api.status(f"/collections/{scene}/{kind}") == 400, "without coords"
        assert api.status(f"/collections/{scene}/{kind}", coords="CIRCLE(1 2)") == 400
        assert _query(api, kind, crs=CRS84, f="CoverageJSON").json() == _query(api, kind).json()
        assert _query(api, kind, crs="EPSG:3857").status_code == 400
        assert _query(api, kind, f="GRIB").status_code == 400
        one = _query(api, kind, **{"parameter-name": "zenith_luminance_cd_m2"}).json()
        assert list(one["ranges"]) == ["zenith_luminance_cd_m2"]
    assert set(_query(api, "position").json()["ranges"]) == set(api.collections()[0]["parameter_names"])
    assert _query(api, "position", datetime="2026-08-12T22:00:00Z").status_code == 200
