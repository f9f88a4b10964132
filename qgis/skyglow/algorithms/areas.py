"""Polygon layers as GeoJSON in degrees, simple enough for the server."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from qgis.core import (
    QgsFeature,
    QgsFeatureRequest,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeatureSource,
    QgsProcessingFeedback,
    QgsRectangle,
    QgsWkbTypes,
)

from .base import to_wgs84

# The server takes 50 000 corners an area, and bodies of 2 MiB; a corner has some 20 bytes.
MAX_BYTES = 1_900_000
MAX_CORNERS = 49_000
# Outlines are simplified by this part of the scene's pixels at first: that moves next to no pixel across.
_FIRST_PART = 0.05
_METRES_PER_DEGREE = 111_320.0
_DECIMALS = 6


def polygons(source: QgsProcessingFeatureSource, context: QgsProcessingContext) -> list[tuple[QgsFeature, QgsGeometry]]:
    """The features of a layer with their outlines in degrees; those without an outline have an empty one."""
    transform = to_wgs84(source.sourceCrs(), context)
    found = []
    for feature in source.getFeatures(QgsFeatureRequest()):
        outline = QgsGeometry(feature.geometry())
        if not outline.isEmpty():
            # The server takes positions of two numbers.
            outline.get().dropZValue()
            outline.get().dropMValue()
            outline.transform(transform)
        found.append((QgsFeature(feature), outline))
    return found


def geojson(outline: QgsGeometry) -> dict[str, Any]:
    """Its GeoJSON: a Polygon or a MultiPolygon."""
    return json.loads(outline.asJson(_DECIMALS))


def united(outlines: Sequence[QgsGeometry]) -> QgsGeometry:
    """One outline around all."""
    whole = QgsGeometry.unaryUnion([outline.makeValid() for outline in outlines if not outline.isEmpty()])
    # What is made valid may leave lines and points beside its polygons.
    whole.convertGeometryCollectionToSubclass(QgsWkbTypes.GeometryType.PolygonGeometry)
    if whole.isEmpty():
        raise QgsProcessingException("The layer of areas has no polygons.")
    return whole


def fitting(outlines: Sequence[QgsGeometry], pixel_size_m: float, feedback: QgsProcessingFeedback) -> list[QgsGeometry]:
    """The outlines, simplified until the server takes them: their number and bytes are limited."""
    fitted, part = list(outlines), _FIRST_PART
    while not _fits(fitted):
        if part > 1:
            raise QgsProcessingException(
                "The outlines have more corners than the server takes. Send fewer of them, or simplify them: "
                "Vector › Geometry tools › Simplify."
            )
        tolerance_m = part * pixel_size_m
        feedback.pushInfo(f"The outlines have too many corners, and are simplified to {tolerance_m:.0f} m.")
        fitted = [_simpler(outline, tolerance_m / _METRES_PER_DEGREE) for outline in outlines]
        part *= 2
    return fitted


def all_but(outline: QgsGeometry, bounds: Sequence[float]) -> QgsGeometry:
    """What of the scene lies outside an outline."""
    west, south, east, north = bounds
    if west > east:
        east += 360
    return QgsGeometry.fromRect(QgsRectangle(west, south, east, north)).difference(outline)


def _simpler(outline: QgsGeometry, tolerance_deg: float) -> QgsGeometry:
    simpler = outline.simplify(tolerance_deg)
    # What vanishes at this tolerance is smaller than a pixel, and keeps its own few corners.
    return outline if simpler.isEmpty() else simpler


def _fits(outlines: Sequence[QgsGeometry]) -> bool:
    corners = [outline.constGet().nCoordinates() for outline in outlines if not outline.isEmpty()]
    if not corners or max(corners) > MAX_CORNERS:
        return not corners
    # About 24 bytes a corner: counted exactly only where it is close.
    if sum(corners) * 12 > MAX_BYTES:
        return False
    return sum(len(outline.asJson(_DECIMALS)) for outline in outlines if not outline.isEmpty()) <= MAX_BYTES
