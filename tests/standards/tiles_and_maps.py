"""OGC API - Tiles 1 (20-057), tile matrix sets (17-083r4), and Maps 1 (20-058): their abstract tests, one by one."""

from __future__ import annotations

import struct

from api import REL, Api, link, links
from requirements_of import requirement
from schemas import Schemas

TILES, TMS, MAPS = "ogcapi-tiles-1/1.0", "tms/2.0", "ogcapi-maps-1/1.0"
SCHEME = f"{REL}/tiling-scheme"


def _tilesets(api: Api):
    for one in api.collections():
        listed = api.json(link(one, f"{REL}/tilesets-map", f"{REL}/tilesets-coverage")["href"])
        for head in listed["tilesets"]:
            yield one, head, api.json(link(head, "self")["href"])


def _tile(api: Api, tileset, matrix: str, column: int, row: int):
    (template,) = links(tileset, "item")
    address = template["href"].replace("{tileMatrix}", matrix)
    return api.get(address.replace("{tileCol}", str(column)).replace("{tileRow}", str(row)))


def _size(png: bytes) -> tuple[int, int]:
    assert png.startswith(b"\x89PNG\r\n\x1a\n"), "no PNG"
    return struct.unpack(">II", png[16:24])


@requirement(TILES, "core", "tc-op")
@requirement(TILES, "core", "tc-success")
@requirement(TILES, "core", "tc-tilematrix-definition")
@requirement(TILES, "core", "tc-tilerow-definition")
@requirement(TILES, "core", "tc-tilecol-definition")
@requirement(TILES, "png", "content")
def tiles(api: Api, schemas: Schemas) -> None:
    for _, _, tileset in _tilesets(api):
        matrices = {each["id"]: each for each in api.json(link(tileset, SCHEME)["href"])["tileMatrices"]}
        for limits in tileset["tileMatrixSetLimits"][:: len(tileset["tileMatrixSetLimits"]) - 1]:
            matrix = matrices[limits["tileMatrix"]]
            answer = _tile(api, tileset, matrix["id"], limits["minTileCol"], limits["minTileRow"])
            assert answer.status_code == 200, answer.text[:200]
            assert answer.headers["content-type"] == links(tileset, "item")[0]["type"] == "image/png"
            assert _size(answer.content) == (matrix["tileWidth"], matrix["tileHeight"])


@requirement(TILES, "core", "tc-error")
def beyond(api: Api, schemas: Schemas) -> None:
    for _, _, tileset in _tilesets(api):
        last = tileset["tileMatrixSetLimits"][-1]
        column, row = last["maxTileCol"], last["maxTileRow"]
        outside = [(column + 1, row), (column, row + 1), (last["minTileCol"] - 1, row), (2**30, row), (-1, row)]
        for at in outside:
            assert _tile(api, tileset, last["tileMatrix"], *at).status_code in (400, 404), at
        assert _tile(api, tileset, "99", 0, 0).status_code in (400, 404)
        for corner in ((column, row), (last["minTileCol"], last["minTileRow"])):
            assert _tile(api, tileset, last["tileMatrix"], *corner).status_code in (200, 204), corner


@requirement(TILES, "core", "conformance-success")
def tiles_are_declared(api: Api, schemas: Schemas) -> None:
    assert f"http://www.opengis.net/spec/{TILES}/conf/core" in api.json("/conformance")["conformsTo"]


@requirement(TILES, "tileset", "description")
@requirement(TMS, "json-tilesetmetadata", "encoding")
@requirement(TMS, "json-tilematrixsetlimits", "encoding")
def descriptions(api: Api, schemas: Schemas) -> None:
    for _, _, tileset in _tilesets(api):
        schemas.check("tms/tileSet.json", tileset)
        schemas.check("tiles/schemas/tms/tileSet.yaml", tileset)
        for limits in tileset["tileMatrixSetLimits"]:
            schemas.check("tms/tileMatrixLimits.json", limits)
        name = tileset["tileMatrixSetURI"].rsplit("/", 1)[-1]
        assert tileset["tileMatrixSetURI"] == f"http://www.opengis.net/def/tilematrixset/OGC/1.0/{name}"
        for item in links(tileset, "item"):
            assert item["templated"] is True and item["type"]
            assert all("{" + variable + "}" in item["href"] for variable in ("tileMatrix", "tileRow", "tileCol"))


@requirement(TILES, "tilesets-list", "tileset-path")
@requirement(TILES, "tilesets-list", "tileset-links")
@requirement(TILES, "geodata-tilesets", "operation")
@requirement(TILES, "geodata-tilesets", "desc-links")
def lists(api: Api, schemas: Schemas) -> None:
    for one in api.collections():
        address = link(one, f"{REL}/tilesets-map")["href"]
        assert address.endswith("/tiles")
        listed = api.json(address)
        assert listed["tilesets"]
        for head in listed["tilesets"]:
            schemas.check("tiles/schemas/tms/tileSet-item.yaml", head)
            assert {"dataType", "crs", "tileMatrixSetURI"} <= set(head)
            link(head, "self")
            link(head, SCHEME)


@requirement(TMS, "json-tilematrixset", "encoding")
def matrix_sets(api: Api, schemas: Schemas) -> None:
    for head in api.json("/tileMatrixSets")["tileMatrixSets"]:
        schemas.check("tiles/schemas/tms/tileMatrixSet-item.yaml", head)
        one = api.json(link(head, "self")["href"])
        schemas.check("tms/tileMatrixSet.json", one)
        registered = schemas.document(f"tms/examples/tilematrixset/{one['id']}.json")
        known = {each["id"]: each for each in registered["tileMatrices"]}
        for matrix in one["tileMatrices"]:
            for name, value in known[matrix["id"]].items():
                same = matrix[name] == value
                if isinstance(value, float):
                    same = abs(matrix[name] / value - 1) < 1e-9
                if name == "pointOfOrigin":
                    same = all(abs(a / b - 1) < 1e-9 for a, b in zip(matrix[name], value, strict=True))
                assert same, f"{matrix['id']} {name}: {matrix[name]}, registered {value}"


@requirement(MAPS, "core", "conformance-success")
def maps_are_declared(api: Api, schemas: Schemas) -> None:
    declared = api.json("/conformance")["conformsTo"]
    assert f"https://www.opengis.net/spec/{MAPS}/conf/core" in declared


@requirement(MAPS, "core", "map-op")
@requirement(MAPS, "core", "map-response")
@requirement(MAPS, "collection-map", "desc-links")
@requirement(MAPS, "collection-map", "map-operation")
@requirement(MAPS, "png", "content")
def maps(api: Api, schemas: Schemas) -> None:
    for one in api.collections():
        address = link(one, "https://www.opengis.net/def/rel/ogc/1.0/map")["href"]
        assert address.endswith(f"/collections/{one['id']}/map")
        answer = api.get(address)
        assert answer.status_code == 200 and answer.headers["content-type"] == "image/png"
        _size(answer.content)
        shown = [float(side) for side in answer.headers["content-bbox"].split(",")]
        assert len(shown) == 4 and all(
            abs(a - b) < 1e-9 for a, b in zip(shown, one["extent"]["spatial"]["bbox"][0], strict=True)
        )
        part = api.get(address, bbox="8.5,46,9,46.5", width=64)
        assert part.headers["content-bbox"] == "8.5,46,9,46.5" and _size(part.content)[0] == 64
        # In CRS84 nothing need be said of the system; without a temporal extent nothing of a time.
        assert "temporal" not in one["extent"]


@requirement(MAPS, "collection-map", "desc-crs")
def systems(api: Api, schemas: Schemas) -> None:
    assert all(any("CRS84" in system for system in one["crs"]) for one in api.collections())
