"""The engine in this process: `Engine` answers what a server would."""

from __future__ import annotations

import dataclasses
import json
import os
import sys
import urllib.parse
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, TypeVar

from .calls import Call
from .errors import SkyglowError, problem_in
from .questions import Questions

T = TypeVar("T")
Device = Literal["auto", "gpu", "lavapipe", "cpu"]
# Where the Debian package has the table packs, below a prefix.
SHARED_PACKS = "share/skyglow/precomputed"


@dataclasses.dataclass(frozen=True)
class _Bytes:
    content: bytes

    def json(self) -> Any:
        return json.loads(self.content)


class Engine(Questions):
    """The engine in this process, with the methods and the answers of :class:`skyglow.Client`, without a server.

    ``packs`` is the folder of the table packs that come with the program (``precomputed`` in its folder): without it
    ``SKYGLOW_PACKS`` says where, or they are where the Debian package has them. ``data`` is the folder of the scenes:
    without it ``SKYGLOW_DATA`` says where, or it is ``~/.local/share/skyglow``, as for the program. ``demo=True``
    makes the demo scene there if it is missing. ``device`` is what renders: ``cpu``, ``gpu``, ``lavapipe``, or the
    best there is.

    It takes a second or two to open and a gigabyte of memory for the packs: make one and keep it. Threads may share it,
    and while it works other Python threads go on; Ctrl-C ends what it does. A process that is forked from this one
    makes its own. Scenarios and plans are kept in the folder of the scenes. Needs ``skyglow-engine``.
    """

    def __init__(
        self,
        packs: str | os.PathLike[str] | None = None,
        data: str | os.PathLike[str] | None = None,
        *,
        device: Device = "auto",
        scene: str | None = None,
        demo: bool = False,
    ) -> None:
        try:
            import skyglow_engine
        except ModuleNotFoundError as error:
            raise ImportError(
                "skyglow.Engine needs the compiled package skyglow-engine: `make wheel` in the project's folder builds "
                "it, then pip install target/wheels/skyglow_engine-*.whl"
            ) from error
        self._refused = skyglow_engine.RefusedError
        self.scene = scene
        folder = Path(data) if data is not None else _data_folder()
        try:
            if demo:
                skyglow_engine.make_demo(folder)
            self._engine = skyglow_engine.Engine(Path(packs) if packs is not None else _packs_folder(), folder, device)
        except OSError as error:
            raise SkyglowError(str(error)) from error

    @property
    def device(self) -> str:
        """What renders, in words."""
        return f"{self._engine.executor}: {self._engine.adapter}"

    def _answer(self, call: Call[T]) -> T:
        body = None if call.json is None else json.dumps(call.json).encode()
        query = urllib.parse.urlencode(call.query)
        return call.read(_Bytes(self._asked(lambda engine: engine.answer(call.path, query, body))))

    def _asked(self, ask: Callable[[Any], T]) -> T:
        """What the compiled engine answers: :mod:`skyglow.maps` asks what the HTTP interface has not."""
        try:
            return ask(self._engine)
        except self._refused as refused:
            raise problem_in(json.loads(refused.args[0])) from None


def _data_folder() -> Path:
    """As the program has it: `server/cli/src/folders.rs`."""
    if named := os.environ.get("SKYGLOW_DATA"):
        return Path(named)
    shared = os.environ.get("XDG_DATA_HOME", "")
    # The XDG specification says that a relative path there counts as none.
    return (Path(shared) if os.path.isabs(shared) else Path.home() / ".local/share") / "skyglow"


def _packs_folder() -> Path:
    if named := os.environ.get("SKYGLOW_PACKS"):
        return Path(named)
    for prefix in (sys.prefix, "/usr/local", "/usr"):
        folder = Path(prefix) / SHARED_PACKS
        if folder.is_dir():
            return folder
    raise SkyglowError(
        "no table packs: Engine(packs=...) or SKYGLOW_PACKS names their folder, `precomputed` in the project's folder"
    )
