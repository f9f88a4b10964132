"""The engine of Skyglow: skyglow.Engine is how to ask it."""

from pathlib import Path
from typing import final

class RefusedError(Exception):
    """Why there is no answer; its one argument is a problem document (RFC 9457) as JSON text."""

@final
class Engine:
    """An engine with its table packs, before the scenes of a folder."""

    def __init__(self, packs: str | Path, data: str | Path, device: str) -> None: ...
    def answer(self, address: str, query: str = "", body: bytes | None = None) -> bytes:
        """What the HTTP interface answers a GET at an address, or with a body a POST: the same bytes."""

    def map_frame(
        self, scene: str, query: str, places: int, bounds: tuple[float, float, float, float] | None = None
    ) -> str:
        """What a map of brightness will be, as JSON, and which places lie within bounds; nothing of it is found."""

    def map_part(self, scene: str, query: str, places: int, columns: tuple[int, int], rows: tuple[int, int]) -> bytes:
        """The numbers of a part of that map: float32 of this machine, row by row from the north, NaN for none."""

    @property
    def executor(self) -> str:
        """What renders: ``gpu``, ``lavapipe`` or ``cpu``."""

    @property
    def adapter(self) -> str:
        """The device's name."""

def make_demo(data: str | Path) -> bool:
    """Makes the demo scene in a folder where there is none, or an older one; whether it did."""

def brightness_png(
    values: bytes, size_px: tuple[int, int], colour_range: tuple[float, float], description: str
) -> bytes:
    """Numbers of a map of brightness (float32 of this machine, row by row) in the colours of map tiles, as PNG."""
