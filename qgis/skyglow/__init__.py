"""Light pollution of the night sky in QGIS, by a Skyglow server."""

from __future__ import annotations

from typing import Any


def classFactory(iface: Any) -> Any:  # noqa: N802 (QGIS calls it so)
    """What QGIS calls to start the plugin; without a window (qgis_process) ``iface`` is None."""
    from .plugin import SkyglowPlugin

    return SkyglowPlugin(iface)
