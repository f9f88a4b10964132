"""What can go wrong: problem documents (RFC 9457) of the server and of the engine as exceptions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import httpx


class SkyglowError(Exception):
    """Anything that this package raises about a server or an engine."""


class UnreachableError(SkyglowError):
    """No answer came: no server there, or the connection broke."""


@dataclass(frozen=True)
class FieldError:
    """One wrong parameter, in the server's words."""

    parameter: str
    message: str
    allowed: str
    code: str
    value: str | None = None


class ProblemError(SkyglowError):
    """The program's reason not to answer as asked.

    ``status`` is that of HTTP, None where the problem came without: of one of many skies, or of the engine.
    ``kind`` is its stable name, such as ``unknown-parameter``; ``errors`` lists every wrong parameter; ``bounds`` are
    west, south, east and north of the scene where a place lies outside it; ``progress`` is the part that is done of
    what is being made; ``document`` is all that was said.
    """

    def __init__(self, status: int | None, document: Mapping[str, Any], retry_after_s: float | None = None) -> None:
        self.status = status
        self.document = dict(document)
        self.kind = str(document.get("type", "about:blank")).rsplit("/", 1)[-1]
        self.title = str(document.get("title", "a problem" if status is None else f"HTTP status {status}"))
        self.detail = str(document.get("detail", ""))
        self.errors = [
            FieldError(
                parameter=str(error.get("parameter", "")),
                message=str(error.get("message", "")),
                allowed=str(error.get("allowed", "")),
                code=str(error.get("code", "")),
                value=error.get("value"),
            )
            for error in document.get("errors") or []
        ]
        self.bounds: list[float] | None = document.get("bounds")
        self.progress: float | None = document.get("progress")
        self.retry_after_s = retry_after_s
        super().__init__(status, document, retry_after_s)

    def __str__(self) -> str:
        return f"{self.title}: {self.detail}" if self.detail else self.title


class InvalidRequestError(ProblemError):
    """Parameters or a body that cannot be right."""


class OutsideSceneError(InvalidRequestError):
    """The place lies outside the scene; ``bounds`` has its edges."""


class NotFoundError(ProblemError):
    """No such scene, scenario, plan or path."""


class NotAllowedError(ProblemError):
    """A key is missing, wrong, or not enough."""


class ConflictError(ProblemError):
    """What is stored does not go with what is asked, such as a plan for a replaced raster."""


class BusyError(ProblemError):
    """The server had no room for longer than the client was willing to wait."""


_BY_STATUS: dict[int, type[ProblemError]] = {
    400: InvalidRequestError,
    401: NotAllowedError,
    403: NotAllowedError,
    404: NotFoundError,
    409: ConflictError,
    413: InvalidRequestError,
    422: InvalidRequestError,
    429: BusyError,
    503: BusyError,
}

_BY_KIND: dict[str, type[ProblemError]] = {
    "bad-parameters": InvalidRequestError,
    "unknown-parameter": InvalidRequestError,
    "out-of-range": InvalidRequestError,
    "not-resident": InvalidRequestError,
    "outside-scene": OutsideSceneError,
    "unknown-scene": NotFoundError,
    "unknown-scenario": NotFoundError,
    "unknown-tile": NotFoundError,
    "not-found": NotFoundError,
    "not-owner": NotAllowedError,
    "stale-plan": ConflictError,
    "draft-plan": ConflictError,
    "pins-full": ConflictError,
    "busy": BusyError,
    "damaged-scene": BusyError,
    "engine-down": BusyError,
    "scene-too-large": BusyError,
    "storage": BusyError,
    "store-away": BusyError,
}


def problem_in(document: Mapping[str, Any]) -> ProblemError:
    """The exception that a problem document without a status stands for."""
    kind = str(document.get("type", "")).rsplit("/", 1)[-1]
    return _BY_KIND.get(kind, ProblemError)(None, document)


def problem_of(response: httpx.Response) -> ProblemError:
    """The exception that an unsuccessful response stands for."""
    try:
        document = response.json()
    except ValueError:
        document = None
    if not isinstance(document, dict):
        document = {"title": f"HTTP status {response.status_code}", "detail": response.text[:500]}
    kind = _BY_STATUS.get(response.status_code, ProblemError)
    if str(document.get("type", "")).endswith("/outside-scene"):
        kind = OutsideSceneError
    return kind(response.status_code, document, retry_after_s(response))


def retry_after_s(response: httpx.Response) -> float | None:
    """Seconds to wait before asking again, where the server says that this would help."""
    if response.status_code not in (429, 503):
        return None
    try:
        return max(float(response.headers["retry-after"]), 0.0)
    except (KeyError, ValueError):
        return None
