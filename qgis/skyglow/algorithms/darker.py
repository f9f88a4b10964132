"""Darker places near a place."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsPointXY,
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QVariant

from .. import styles
from .base import WGS84, SkyglowAlgorithm, warn_of

# Fields by their names in the interface.
NUMBERS = [
    "rank",
    "distance_m",
    "azimuth_deg",
    "gain_mag",
    "artificial_ratio",
    "zenith_total_brightness_mag_arcsec2",
    "ratio_to_natural",
    "bortle_class",
    "naked_eye_limit_mag",
    "terrain_altitude_m",
]
_WHOLE = {"rank", "bortle_class"}


class DarkerAlgorithm(SkyglowAlgorithm):
    """``skyglow:darker``."""

    NAME = "darker"
    TITLE = "Darker places nearby"
    HELP = (
        "Points with a darker zenith near a place, the darkest first: how far, in which direction, what they gain "
        "(magnitudes), and in which directions their low sky is clean. Roads, fences and owners are not known."
    )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: N802
        """Its parameters."""
        number = QgsProcessingParameterNumber.Type
        self.add_place()
        self.addParameter(QgsProcessingParameterNumber("WITHIN_KM", "Within (km)", number.Double, 60, False, 2, 150))
        self.addParameter(QgsProcessingParameterNumber("LIMIT", "Places at most", number.Integer, 6, False, 1, 20))
        points = QgsProcessing.SourceType.TypeVectorPoint
        self.addParameter(QgsProcessingParameterFeatureSink("OUTPUT", "Darker places", points))
        self.add_common()

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Asks, and makes a point of each place."""
        server = self.server(parameters, context)
        query = {
            **self.place(parameters, context),
            "within_km": self.parameterAsDouble(parameters, "WITHIN_KM", context),
            "limit": self.parameterAsInt(parameters, "LIMIT", context),
            **self.query(parameters, context),
        }
        answer = server.get(server.scene_url(self.scene(parameters, context), "/darker", query), feedback).json()
        warn_of(answer, feedback.pushInfo)
        if not answer["places"]:
            feedback.pushWarning("No place within reach has at least a tenth less artificial light.")
        fields = QgsFields()
        for name in NUMBERS:
            fields.append(QgsField(name, QVariant.Int if name in _WHOLE else QVariant.Double))
        for name in ("ground", "nearest_place", "clean_directions_deg"):
            fields.append(QgsField(name, QVariant.String))
        wgs84 = QgsCoordinateReferenceSystem(WGS84)
        sink, destination = self.parameterAsSink(parameters, "OUTPUT", context, fields, QgsWkbTypes.Type.Point, wgs84)
        if sink is None:
            raise QgsProcessingException(self.invalidSinkError(parameters, "OUTPUT"))
        for place in answer["places"]:
            feature = QgsFeature(fields)
            at = QgsPointXY(place["longitude_deg"], place["latitude_deg"])
            feature.setGeometry(QgsGeometry.fromPointXY(at))
            nearest = (place.get("nearest_place") or {}).get("name")
            words = [place["ground"], nearest, _directions(place)]
            feature.setAttributes([*(place.get(name) for name in NUMBERS), *words])
            sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert)
        styles.style_on_load(context, destination, "darker")
        return {"OUTPUT": destination}


def _directions(place: dict[str, Any]) -> str:
    ranges = (place.get("low_sky") or {}).get("clean_directions_deg") or []
    return ", ".join(f"{first:.0f}–{last:.0f}" for first, last in ranges)
