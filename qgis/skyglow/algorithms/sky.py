"""The numbers of the skies over many points, or over one."""

from __future__ import annotations

import json
from collections import Counter
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
    QgsProcessingParameterDateTime,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterPoint,
    QgsProcessingUtils,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QDateTime, QVariant

from .. import styles
from .base import WGS84, SkyglowAlgorithm, to_wgs84

# Places that are asked for at once: the server takes 1 000; fewer show progress.
BATCH = 200
# Numbers of a sky that become fields, by their names in the interface.
NUMBERS = [
    "zenith_total_brightness_mag_arcsec2",
    "ratio_to_natural",
    "bortle_class",
    "naked_eye_limit_mag",
    "horizontal_illuminance_lx",
    "horizontal_total_illuminance_lx",
    "zenith_luminance_cd_m2",
    "zenith_total_luminance_cd_m2",
    "sqm_total_brightness_mag_arcsec2",
    "mean_luminance_cd_m2",
    "brightest_luminance_cd_m2",
    "brightest_azimuth_deg",
    "brightest_elevation_deg",
    "zenith_scotopic_luminance_cd_m2",
]


def sky_fields() -> QgsFields:
    """The fields that every point gets."""
    fields = QgsFields()
    for name in NUMBERS:
        fields.append(QgsField(name, QVariant.Int if name == "bortle_class" else QVariant.Double))
    fields.append(QgsField("terrain_altitude_m", QVariant.Double))
    fields.append(QgsField("coverage", QVariant.Double))
    fields.append(QgsField("problem", QVariant.String))
    return fields


def sky_values(line: dict[str, Any]) -> list[Any]:
    """The values of these fields from a line of the answer."""
    if line.get("error"):
        return [None] * (len(NUMBERS) + 2) + [line["error"]["detail"]]
    numbers = [line["sky"][name] for name in NUMBERS]
    return [*numbers, line["observer"]["terrain_altitude_m"], line["coverage"], None]


class SkyAlgorithm(SkyglowAlgorithm):
    """``skyglow:sky``."""

    NAME = "sky"
    TITLE = "Sky at points"
    HELP = (
        "How bright the night sky is over each point: total brightness of the zenith (mag/arcsec²), artificial "
        "light over natural, Bortle class, the faintest star that the eye sees, light on the ground (lx), and more."
        " Takes a layer of points, or one place; other geometries count by a point on them. Without a time the "
        "natural sky is a dark one: no Moon, no twilight. A point that cannot be answered, such as one outside the "
        "scene, says why in its field <i>problem</i>."
    )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: N802
        """Its parameters."""
        anything = QgsProcessing.SourceType.TypeVectorAnyGeometry
        self.addParameter(QgsProcessingParameterFeatureSource("INPUT", "Points", [anything], None, True))
        self.addParameter(QgsProcessingParameterPoint("POINT", "Or one place", None, True))
        when = "Time, by this computer's clock (none: a dark sky)"
        kind = QgsProcessingParameterDateTime.Type.DateTime
        self.addParameter(QgsProcessingParameterDateTime("TIME", when, kind, None, True))
        self.addParameter(
            QgsProcessingParameterFeatureSink("OUTPUT", "Skies", QgsProcessing.SourceType.TypeVectorPoint)
        )
        self.add_common()

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Asks for the points in batches."""
        features, fields, crs = self._points(parameters, context)
        found = QgsProcessingUtils.combineFields(fields, sky_fields())
        sink, destination = self.parameterAsSink(parameters, "OUTPUT", context, found, QgsWkbTypes.Type.Point, crs)
        if sink is None:
            raise QgsProcessingException(self.invalidSinkError(parameters, "OUTPUT"))
        transform = to_wgs84(crs, context)
        query = {**self.query(parameters, context), "time": self._time(parameters, context)}
        url = self.server(parameters, context).scene_url(self.scene(parameters, context), "/skies", query)
        said: Counter[str] = Counter()
        for start in range(0, len(features), BATCH):
            batch = features[start : start + BATCH]
            for feature, line in zip(batch, self._lines(batch, transform, url, (parameters, context, feedback))):
                said.update(warnings_of(line))
                feature.setAttributes([*feature.attributes(), *sky_values(line)])
                sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert)
            feedback.setProgress(100 * (start + len(batch)) / len(features))
        for warning, count in said.items():
            feedback.pushInfo(f"{warning} ({count} of {len(features)} points)")
        styles.style_on_load(context, destination, "sky")
        return {"OUTPUT": destination}

    def _points(
        self, parameters: dict[str, Any], context: QgsProcessingContext
    ) -> tuple[list[QgsFeature], QgsFields, QgsCoordinateReferenceSystem]:
        source = self.parameterAsSource(parameters, "INPUT", context)
        if source is None:
            if not parameters.get("POINT"):
                raise QgsProcessingException("Choose a layer of points, or one place.")
            crs = QgsCoordinateReferenceSystem(WGS84)
            feature = QgsFeature()
            feature.setGeometry(QgsGeometry.fromPointXY(self.parameterAsPoint(parameters, "POINT", context, crs)))
            return [feature], QgsFields(), crs
        features = [QgsFeature(feature) for feature in source.getFeatures()]
        for feature in features:
            if feature.hasGeometry():
                feature.setGeometry(QgsGeometry.fromPointXY(point_of(feature.geometry())))
        return features, source.fields(), source.sourceCrs()

    def _time(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str | None:
        if not parameters.get("TIME"):
            return None
        time: QDateTime = self.parameterAsDateTime(parameters, "TIME", context)
        if not time.isValid():
            raise QgsProcessingException("The time cannot be read: 2026-08-12T23:00:00Z is how one is written.")
        return time.toUTC().toString("yyyy-MM-ddTHH:mm:ss") + "Z"

    def _lines(
        self, features: list[QgsFeature], transform: Any, url: str, run: tuple[Any, Any, Any]
    ) -> list[dict[str, Any]]:
        parameters, context, feedback = run
        lines: list[dict[str, Any]] = [{"error": {"detail": "it has no geometry"}} for _ in features]
        asked, places = [], []
        for number, feature in enumerate(features):
            if feature.hasGeometry():
                at: QgsPointXY = transform.transform(feature.geometry().asPoint())
                places.append({"lat": at.y(), "lon": at.x()})
                asked.append(number)
        if places:
            body = self.server(parameters, context).post(url, {"places": places}, feedback).body
            said = body.decode().splitlines()
            if len(said) < len(places):
                raise QgsProcessingException(
                    f"The answer ended after {len(said)} of {len(places)} points: wait a little and run it again."
                )
            for number, line in zip(asked, said):
                lines[number] = json.loads(line)
        return lines


def warnings_of(line: dict[str, Any]) -> list[str]:
    """What the server warns of; how much of the surroundings is known is a field of its own."""
    said = [warning for warning in line.get("warnings") or [] if "of the 300 km around" not in warning]
    if line.get("coverage", 1) < 0.9:
        said.append("Less than 90 % of the light within 300 km is known; see the field coverage.")
    if (line.get("scene") or {}).get("illustrative"):
        said.append("The scene is illustrative: made-up light, not measured.")
    return said


def point_of(geometry: QgsGeometry) -> QgsPointXY:
    """The point itself, or one on a geometry of another kind."""
    if geometry.wkbType() in (QgsWkbTypes.Type.Point, QgsWkbTypes.Type.PointZ, QgsWkbTypes.Type.PointM):
        return geometry.asPoint()
    return geometry.pointOnSurface().asPoint()
