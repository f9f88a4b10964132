"""Rasters as the server sends them, in files."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsProcessingException


def write_raster(path: str, tiff: bytes) -> None:
    """Writes a GeoTIFF as it came: another format would lose what is said in it."""
    if Path(path).suffix.lower() not in (".tif", ".tiff"):
        raise QgsProcessingException(f"{path}: the server sends GeoTIFF, so the file's name must end with .tif.")
    try:
        Path(path).write_bytes(tiff)
    except OSError as error:
        raise QgsProcessingException(f"{path} cannot be written: {error.strerror}.") from error
