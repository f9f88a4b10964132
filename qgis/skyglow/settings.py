"""What the user has set: the server, how to sign in to it, and the scene that is asked when none is named."""

from __future__ import annotations

import dataclasses

from qgis.core import QgsSettings

DEFAULT_ADDRESS = "http://127.0.0.1:8080"
DEFAULT_SCENE = "demo"


@dataclasses.dataclass(frozen=True)
class Settings:
    """The plugin's settings; ``authentication`` is the id of an authentication configuration of QGIS."""

    address: str = DEFAULT_ADDRESS
    key: str = ""
    authentication: str = ""
    scene: str = DEFAULT_SCENE


def read() -> Settings:
    """The settings of this user's profile."""
    stored = QgsSettings()
    found = {
        field.name: str(stored.value(f"skyglow/{field.name}", field.default) or field.default)
        for field in dataclasses.fields(Settings)
    }
    return Settings(**found)


def write(settings: Settings) -> None:
    """Stores them in this user's profile."""
    stored = QgsSettings()
    for name, value in dataclasses.asdict(settings).items():
        stored.setValue(f"skyglow/{name}", value)
