"""The HTTP interface of a Skyglow server, through the network of QGIS: its proxies, certificates and sign-ins."""

from __future__ import annotations

import dataclasses
import json
import time
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote, urlencode

from qgis.core import QgsBlockingNetworkRequest, QgsFeedback
from qgis.PyQt.QtCore import QByteArray, QUrl
from qgis.PyQt.QtNetwork import QNetworkReply, QNetworkRequest

from . import problems, settings
from .problems import ProblemError

# Answers of these kinds are asked for again: the work goes on, or there was no room just now.
_WAIT_FOR = {"being-made", "busy", "too-many-requests"}
_PATIENCE_S = 600.0
_STATUS = QNetworkRequest.Attribute.HttpStatusCodeAttribute


class CancelledError(Exception):
    """The user no longer wants it."""


@dataclasses.dataclass(frozen=True)
class Answer:
    """What came back."""

    status: int
    body: bytes
    location: str = ""
    owner: str = ""

    def json(self) -> Any:
        """The body as JSON."""
        return json.loads(self.body)


@dataclasses.dataclass(frozen=True)
class Server:
    """A server by its address, and who asks it."""

    address: str
    key: str = ""
    authentication: str = ""

    @staticmethod
    def of_settings(address: str = "") -> Server:
        """The server of the settings; the key and the sign-in go to no other address."""
        set_up = settings.read()
        given = address.strip().rstrip("/")
        own = set_up.address.strip().rstrip("/")
        if given and given != own:
            return Server(given)
        return Server(own, set_up.key, set_up.authentication)

    def url(self, path: str, query: Mapping[str, Any] | None = None) -> str:
        """The address of a path below the server's own; what is None or empty is left out of the query."""
        pairs = {name: _text(value) for name, value in (query or {}).items() if value not in (None, "")}
        return f"{self.address}{path}" + (f"?{urlencode(pairs, quote_via=quote)}" if pairs else "")

    def scene_url(self, scene: str, path: str, query: Mapping[str, Any] | None = None) -> str:
        """The address of something of a scene."""
        return self.url(f"/api/v1/scenes/{quote(scene, safe='')}{path}", query)

    def request(self, url: str) -> QNetworkRequest:
        """A request as QGIS sends them, with the key if there is one."""
        request = QNetworkRequest(QUrl(url))
        if self.key and url.startswith(f"{self.address}/"):
            request.setRawHeader(b"X-Api-Key", self.key.encode())
        return request

    def get(self, url: str, feedback: QgsFeedback | None = None) -> Answer:
        """The answer of an address; waits, with progress, for what is being made."""
        return self._patiently(lambda: self._send(self.request(url), None, feedback), feedback)

    def when_ready(self, url: str, feedback: QgsFeedback | None = None) -> Any:
        """TileJSON once what it describes is found, with progress until then; after some minutes as it is."""
        end = time.monotonic() + _PATIENCE_S
        while True:
            described = self.get(url, feedback).json()
            if described["ready"] or time.monotonic() > end:
                return described
            if feedback is not None:
                feedback.setProgress(100 * (described.get("progress") or 0.0))
            _pause(0.5, feedback)

    def scene_ids(self) -> list[str]:
        """The scenes that the server has."""
        return [scene["id"] for scene in self.get(self.url("/api/v1/scenes")).json()]

    def post(self, url: str, body: Any, feedback: QgsFeedback | None = None, owner: str = "") -> Answer:
        """The answer to a body of JSON, waited for as a job of the server, so that no time limit ends it."""

        def send() -> Answer:
            request = self.request(url)
            request.setHeader(QNetworkRequest.KnownHeaders.ContentTypeHeader, "application/json")
            request.setRawHeader(b"Prefer", b"respond-async")
            if owner:
                request.setRawHeader(b"Skyglow-Owner", owner.encode())
            return self._send(request, json.dumps(body).encode(), feedback)

        answer = self._patiently(send, feedback)
        return self._job(answer, feedback) if answer.status == 202 else answer

    def _job(self, begun: Answer, feedback: QgsFeedback | None) -> Answer:
        job = begun.location if begun.location.startswith("http") else f"{self.address}{begun.location}"
        while True:
            try:
                said = self._send(self.request(job), None, feedback).json()
                _pause(0.2, feedback)
            except CancelledError:
                QgsBlockingNetworkRequest().deleteResource(self.request(job))
                raise
            if feedback is not None and said.get("progress") is not None:
                feedback.setProgress(100 * said["progress"])
            if said["state"] not in ("queued", "running"):
                answer = self._send(self.request(f"{job}/result"), None, feedback)
                return dataclasses.replace(answer, owner=answer.owner or begun.owner)

    def _patiently(self, send: Any, feedback: QgsFeedback | None) -> Answer:
        end = time.monotonic() + _PATIENCE_S
        while True:
            try:
                return send()
            except ProblemError as problem:
                if problem.kind not in _WAIT_FOR or time.monotonic() > end:
                    raise
                if feedback is not None and problem.kind == "being-made":
                    feedback.setProgress(100 * problem.progress)
                _pause(min(problem.retry_after_s or 1.0, 30.0), feedback)

    def _send(self, request: QNetworkRequest, body: bytes | None, feedback: QgsFeedback | None) -> Answer:
        sender = QgsBlockingNetworkRequest()
        if self.authentication:
            sender.setAuthCfg(self.authentication)
        if body is None:
            outcome = sender.get(request, True, feedback)
        else:
            outcome = sender.post(request, QByteArray(body), True, feedback)
        if feedback is not None and feedback.isCanceled():
            raise CancelledError()
        reply = sender.reply()
        status = int(reply.attribute(_STATUS) or 0)
        content = bytes(reply.content())
        if status == 0:
            raise problems.unreachable(self.address, sender.errorMessage())
        if outcome != QgsBlockingNetworkRequest.ErrorCode.NoError or status >= 400:
            raise problems.of_answer(status, content, _header(reply, b"Retry-After"))
        return Answer(status, content, _header(reply, b"Location"), _header(reply, b"Skyglow-Owner"))


def problem_of(reply: QNetworkReply, address: str) -> ProblemError | None:
    """Why a reply that came on its own has no answer; None where it has."""
    status = int(reply.attribute(_STATUS) or 0)
    if status == 0:
        return problems.unreachable(address, reply.errorString())
    if status >= 400:
        return problems.of_answer(status, bytes(reply.readAll()), _header(reply, b"Retry-After"))
    return None


def _header(reply: Any, name: bytes) -> str:
    # By hand: replies of QgsBlockingNetworkRequest know a header in the case that it came in alone.
    written = [key for key in reply.rawHeaderList() if bytes(key).lower() == name.lower()]
    return bytes(reply.rawHeader(written[0])).decode("latin-1") if written else ""


def _text(value: Any) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def _pause(seconds: float, feedback: QgsFeedback | None) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if feedback is not None and feedback.isCanceled():
            raise CancelledError()
        time.sleep(0.05)
