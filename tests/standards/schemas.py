"""The official JSON schemas, as scripts/standards.sh lays them into one folder; nothing is fetched here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import jsonschema
import yaml
from referencing import Registry, Resource
from referencing.jsonschema import DRAFT4, DRAFT7

# Addresses that schemas name others by, and the files that hold them.
ELSEWHERE = {
    "https://proj.org/schemas/v0.7/projjson.schema.json": "tms/projJSON.json",
    "https://stac-extensions.github.io/projection/v2.0.0/schema.json": "projection/schema.json",
    "https://stac-extensions.github.io/raster/v2.0.0/schema.json": "raster/schema.json",
}


class Schemas:
    """Schemas by their path in the folder, such as `edr/collections/collection.yaml`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder.resolve()
        self._registry = Registry(retrieve=self._retrieve)  # type: ignore[call-arg]

    def faults(self, path: str, document: Any) -> list[str]:
        """What the schema finds wrong with a document."""
        uri = (self._folder / path).as_uri()
        of_yaml = path.endswith(".yaml")
        kind = jsonschema.Draft4Validator if of_yaml else jsonschema.Draft202012Validator
        if not of_yaml:
            kind = jsonschema.validators.validator_for(self._read(uri), default=jsonschema.Draft7Validator)
        validator = kind({"$ref": uri}, registry=self._registry)
        found = sorted(validator.iter_errors(document), key=lambda error: list(map(str, error.absolute_path)))
        return [f"{'/'.join(map(str, error.absolute_path)) or '(all)'}: {error.message[:300]}" for error in found]

    def check(self, path: str, document: Any) -> None:
        """Raises where a document does not pass."""
        found = self.faults(path, document)
        assert not found, f"by {path}: {'; '.join(found[:4])}"

    def document(self, path: str) -> Any:
        """Any file of the folder."""
        return self._read((self._folder / path).as_uri())

    def _retrieve(self, uri: str) -> Resource[Any]:
        known = ELSEWHERE.get(uri.removesuffix("#"))
        uri = (self._folder / known).as_uri() if known else uri
        if uri.startswith("https://geojson.org/schema/"):
            return Resource.from_contents(_of_geojson(uri), default_specification=DRAFT7)
        default = DRAFT4 if uri.endswith(".yaml") else DRAFT7
        return Resource.from_contents(self._read(uri), default_specification=default)

    def _read(self, uri: str) -> Any:
        path = Path(urlsplit(uri).path)
        assert path.is_file(), f"{uri} was not fetched"
        text = path.read_text(encoding="utf-8")
        return _as_draft4(yaml.safe_load(text)) if path.suffix == ".yaml" else json.loads(text)


def _of_geojson(uri: str) -> Any:
    """Those of geojson.org, which pystac brings."""
    from importlib.resources import files

    name = uri.rsplit("/", 1)[-1].lower()
    found = [
        file
        for file in files("pystac.validation.jsonschemas").joinpath("geojson").iterdir()
        if file.name.lower() == name
    ]
    assert found, f"pystac has no {uri}"
    return json.loads(found[0].read_text(encoding="utf-8"))


def _as_draft4(schema: Any) -> Any:
    """A schema of OpenAPI 3.0 as one of JSON Schema: what may be null says so in its type."""
    if isinstance(schema, list):
        return [_as_draft4(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    made = {name: _as_draft4(part) for name, part in schema.items() if name not in ("nullable", "example", "examples")}
    if schema.get("nullable") is True and isinstance(schema.get("type"), str):
        made["type"] = [schema["type"], "null"]
    return made
