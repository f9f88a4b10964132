"""The server's problem documents (RFC 9457) in plain words, with what to do."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

SETTINGS = "Settings › Options › Skyglow"

# What helps, by the kind of problem; the server's own words come first.
_HELP = {
    "unreachable": f"Is the server running, and is its address right? It is set in {SETTINGS}.",
    "no-skyglow": f"Is this the address of a Skyglow server, without a path? It is set in {SETTINGS}.",
    "outside-scene": "Choose a place within the scene, or another scene.",
    "unknown-scenario": "Scenarios and plans that are old are forgotten: make it again.",
    "stale-plan": "Make the plan again: the scene's lights were replaced since.",
    "unauthorized": f"Check the API key in {SETTINGS}, or remove it: a key is never needed.",
    "quota-used": "Wait until tomorrow (UTC), or ask the server's operator for more.",
    "kept-enough": "Wait, or make plans without keeping them.",
    "too-many-requests": "Wait a little and run it again.",
    "busy": "Wait a little and run it again.",
    "timeout": "Ask for less at once: fewer places, or a smaller area.",
    "body-too-long": "Send less: fewer features, or simpler outlines (Vector › Geometry tools › Simplify).",
    "not-found": "The server may be of another version than this plugin.",
}


class ProblemError(Exception):
    """Why there is no answer. ``kind`` is the server's name for it, such as ``outside-scene``."""

    def __init__(self, status: int, document: Mapping[str, Any], retry_after_s: float | None = None) -> None:
        self.status = status
        self.document = dict(document)
        self.kind = str(document.get("type", "")).rsplit("/", 1)[-1]
        self.progress = float(document.get("progress") or 0.0)
        self.retry_after_s = retry_after_s
        super().__init__(self.words())

    def words(self) -> str:
        """Sentences that say what is wrong and what to do."""
        # What a program would send instead helps nobody here.
        detail = "" if self.kind == "unauthorized" else str(self.document.get("detail", "")).strip()
        sentences = [_sentence(str(self.document.get("title", f"The server answered {self.status}")))]
        errors = self.document.get("errors") or []
        if detail:
            # A detail that begins with a parameter's name keeps its case.
            sentences.append(detail if errors else _sentence(detail))
        for error in errors:
            if str(error.get("message")) not in detail:
                sentences.append(f"{error.get('parameter')}: {error.get('message')}; allowed: {error.get('allowed')}.")
        if self.kind in _HELP:
            sentences.append(_HELP[self.kind])
        return " ".join(sentences)


def _sentence(text: str) -> str:
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else f"{text}."


def unknown_scene(scene: str, known: list[str]) -> str:
    """What to say where the server has no such scene."""
    has = f"It has: {', '.join(known)}." if known else "It has none yet."
    return f"The server has no scene “{scene}”. {has} The default is set in {SETTINGS}."


def unreachable(address: str, reason: str) -> ProblemError:
    """No answer came at all."""
    return ProblemError(0, {"type": "unreachable", "title": f"No answer from {address}", "detail": reason})


def of_answer(status: int, body: bytes, retry_after: str) -> ProblemError:
    """The problem that an unsuccessful answer stands for."""
    try:
        document = json.loads(body)
    except ValueError:
        document = None
    if not isinstance(document, dict) or "title" not in document:
        document = {"type": "no-skyglow", "title": f"The server answered {status}, not as Skyglow would"}
    try:
        retry_after_s = float(retry_after)
    except ValueError:
        retry_after_s = None
    return ProblemError(status, document, retry_after_s)
