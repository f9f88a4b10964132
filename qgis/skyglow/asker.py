"""Questions whose answers come later, so that the window never waits."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from qgis.core import QgsApplication, QgsNetworkAccessManager
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtNetwork import QNetworkReply

from .problems import ProblemError
from .server import Server, problem_of


class Asker(QObject):
    """Sends questions and hands their answers on; a new question by the same name takes the old one's place."""

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._under_way: dict[str, QNetworkReply] = {}

    def ask(
        self,
        name: str,
        server: Server,
        url: str,
        then: Callable[[bytes], None],
        otherwise: Callable[[ProblemError], None],
    ) -> None:
        """Asks for an address; ``then`` gets the body, ``otherwise`` the reason why there is none."""
        self.drop(name)
        request = server.request(url)
        if server.authentication:
            QgsApplication.authManager().updateNetworkRequest(request, server.authentication)
        reply = QgsNetworkAccessManager.instance().get(request)
        self._under_way[name] = reply

        def finished() -> None:
            reply.deleteLater()
            if self._under_way.get(name) is not reply:
                return
            del self._under_way[name]
            problem = problem_of(reply, server.address)
            if problem is None:
                then(bytes(reply.readAll()))
            else:
                otherwise(problem)

        reply.finished.connect(finished)

    def drop(self, name: str) -> None:
        """Nobody wants this answer any more."""
        reply = self._under_way.pop(name, None)
        if reply is not None:
            reply.abort()

    def drop_all(self) -> None:
        """Nobody wants any."""
        for name in list(self._under_way):
            self.drop(name)

    def is_waiting(self) -> bool:
        """Whether an answer is still to come."""
        return bool(self._under_way)


def numbers(body: bytes) -> dict[str, Any]:
    """An answer of JSON."""
    return json.loads(body)
