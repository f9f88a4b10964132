"""STAC 1.1: every document of the catalogue by the schemas of the core, which pystac brings, and of its extensions."""

from __future__ import annotations

import copy
from typing import Any

import pystac
from api import Api, link, links
from pystac.validation.stac_validator import JsonSchemaSTACValidator
from report import Report
from schemas import Schemas

VERSION = "1.1.0"
KINDS = {
    "Catalog": pystac.STACObjectType.CATALOG,
    "Collection": pystac.STACObjectType.COLLECTION,
    "Feature": pystac.STACObjectType.ITEM,
}
EXTENSIONS = {
    "https://stac-extensions.github.io/projection/v2.0.0/schema.json": "projection/schema.json",
    "https://stac-extensions.github.io/raster/v2.0.0/schema.json": "raster/schema.json",
}


def _by_core(document: dict[str, Any]) -> None:
    try:
        JsonSchemaSTACValidator().validate_core(document, KINDS[document["type"]], VERSION)
    except pystac.STACValidationError as error:
        raise AssertionError(str(error)) from error


def _by_extensions(schemas: Schemas, document: dict[str, Any]) -> None:
    assert set(document.get("stac_extensions", [])) <= set(EXTENSIONS), document["stac_extensions"]
    for name in document.get("stac_extensions", []):
        schemas.check(EXTENSIONS[name], document)


def _by_links(api: Api, document: dict[str, Any], url: str) -> None:
    assert link(document, "self")["href"] == url
    for each in document["links"]:
        answer = api.get(each["href"])
        assert answer.status_code == 200 and answer.headers["content-type"].split(";")[0] == each["type"], each


def check(api: Api, schemas: Schemas, report: Report) -> None:
    """Follows the catalogue from its root."""
    waiting, seen, items = [f"{api.url}/api/stac"], set(), []
    while waiting:
        url = waiting.pop()
        if url in seen:
            continue
        seen.add(url)
        document = api.json(url)
        name = url.removeprefix(api.url)
        report.run("STAC core 1.1.0", name, lambda document=document: _by_core(document))
        report.run("STAC links", name, lambda document=document, url=url: _by_links(api, document, url))
        if document["type"] == "Feature":
            items.append(document)
            report.run(
                "STAC projection 2.0.0, raster 2.0.0", name, lambda document=document: _by_extensions(schemas, document)
            )
        waiting += [each["href"] for each in links(document, "child") + links(document, "item")]
    assert items, "a catalogue without items"
    for member in ("geometry", "properties", "assets", "links"):
        broken = copy.deepcopy(items[0])
        del broken[member]
        report.finds("STAC core 1.1.0", f"an item without {member}", lambda broken=broken: _by_core(broken))
    for member, value in (("proj:shape", "wide"), ("proj:transform", [1]), ("proj:code", 4326)):
        broken = copy.deepcopy(items[0])
        broken["properties"][member] = value
        report.finds(
            "STAC projection 2.0.0, raster 2.0.0",
            f"{member} {value}",
            lambda broken=broken: _by_extensions(schemas, broken),
        )
