"""The server under test, and the places of the demo that it is asked about."""

from __future__ import annotations

import time
from typing import Any

import httpx

POINT = "POINT(8.79 46.17)"
LINE = "LINESTRING(8.79 46.17,8.61 46.53)"
AREA = "POLYGON((8.6 46,9 46,9 46.3,8.6 46))"
REL = "http://www.opengis.net/def/rel/ogc/1.0"


class Api:
    """Answers of a server by path below `/api/ogc`, or by address."""

    def __init__(self, url: str) -> None:
        self.url = url.rstrip("/")
        self.root = f"{self.url}/api/ogc"
        self._http = httpx.Client(timeout=180)

    def get(self, path: str, **query: Any) -> httpx.Response:
        """Waits where a map is being made."""
        url = path if path.startswith("http") else f"{self.root}{path}"
        for _ in range(120):
            answer = self._http.get(url, params=query or None)
            if answer.status_code != 503 or "being-made" not in answer.text:
                return answer
            time.sleep(float(answer.headers.get("retry-after", 1)))
        raise AssertionError(f"{url} is being made for too long")

    def status(self, path: str, **query: Any) -> int:
        """The status alone."""
        return self.get(path, **query).status_code

    def json(self, path: str, **query: Any) -> Any:
        """A document that must be there, as JSON."""
        answer = self.get(path, **query)
        assert answer.status_code == 200, f"{answer.url}: {answer.status_code} {answer.text[:200]}"
        kind = answer.headers["content-type"]
        assert "json" in kind, f"{answer.url} is {kind}"
        return answer.json()

    def execute(self, process: str, body: Any, **headers: str) -> httpx.Response:
        """Executes a process."""
        return self._http.post(f"{self.root}/processes/{process}/execution", json=body, headers=headers)

    def delete(self, path: str) -> httpx.Response:
        """Dismisses a job."""
        return self._http.delete(f"{self.root}{path}")

    def collections(self) -> list[Any]:
        """All collections."""
        return self.json("/collections")["collections"]


def links(document: Any, relation: str) -> list[Any]:
    """The links of a document with a relation."""
    return [link for link in document["links"] if link["rel"] == relation]


def link(document: Any, *relations: str) -> Any:
    """One link with one of the relations, which must be there."""
    found = [each for relation in relations for each in links(document, relation)]
    assert found, f"no link of {' or '.join(relations)}"
    return found[0]
