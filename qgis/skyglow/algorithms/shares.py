"""Whose light a sky is, by the polygons of a layer."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingUtils,
)
from qgis.PyQt.QtCore import QVariant

from .. import styles
from . import areas
from .base import MEASURES, SkyglowAlgorithm, warn_of


class SharesAlgorithm(SkyglowAlgorithm):
    """``skyglow:shares``."""

    NAME = "shares"
    TITLE = "Shares of municipalities in a sky"
    HELP = (
        "The layer of polygons again, each with its part in the artificial light of the place's sky: "
        "<i>share_percent</i>, <i>influence</i> in the measure's unit, <i>flux_dnb_w</i> (upward flux) and lit "
        "<i>pixels</i>. OUTSIDE is the share of lights in none of them; shares of areas that do not overlap and "
        "OUTSIDE add up to 100 %."
    )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: N802
        """Its parameters."""
        kinds = [QgsProcessing.SourceType.TypeVectorPolygon]
        self.addParameter(QgsProcessingParameterFeatureSource("INPUT", "Municipalities", kinds))
        self.add_place()
        self.add_measure(MEASURES)
        self.addParameter(QgsProcessingParameterFeatureSink("OUTPUT", "Shares", kinds[0]))
        self.addOutput(QgsProcessingOutputNumber("TOTAL", "The sky's own value"))
        self.addOutput(QgsProcessingOutputNumber("OUTSIDE", "Share of lights in none of them (%)"))
        self.add_common()

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Posts all outlines at once."""
        source = self.parameterAsSource(parameters, "INPUT", context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, "INPUT"))
        server, scene = self.server(parameters, context), self.scene(parameters, context)
        pixel_size_m = server.get(server.scene_url(scene, ""), feedback).json()["pixel_size_m"]
        known = areas.polygons(source, context)
        outlines = areas.fitting([outline for _, outline in known], pixel_size_m, feedback)
        asked = [number for number, outline in enumerate(outlines) if not outline.isEmpty()]
        if not asked:
            raise QgsProcessingException("The layer has no polygons.")
        posted = {
            "type": "FeatureCollection",
            "features": [
                {"type": "Feature", "properties": {}, "geometry": areas.geojson(outlines[number])} for number in asked
            ],
        }
        query = {
            **self.place(parameters, context),
            "measure": self.measure(parameters, context),
            **self.query(parameters, context),
        }
        answer = server.post(server.scene_url(scene, "/shares", query), posted, feedback).json()
        warn_of(answer, feedback.pushInfo)
        if answer["shared_pixels"]:
            feedback.pushWarning(f"{answer['shared_pixels']} lit pixels lie in more than one area, and count for each.")
        # The answer numbers features from 1, in the order of the body.
        found = {asked[area["feature"] - 1]: area for area in answer["areas"]}
        fields = QgsFields()
        for name, kind in _FIELDS:
            fields.append(QgsField(name, kind))
        sink, destination = self.parameterAsSink(
            parameters,
            "OUTPUT",
            context,
            QgsProcessingUtils.combineFields(source.fields(), fields),
            source.wkbType(),
            source.sourceCrs(),
        )
        if sink is None:
            raise QgsProcessingException(self.invalidSinkError(parameters, "OUTPUT"))
        for number, (feature, _) in enumerate(known):
            feature.setAttributes([*feature.attributes(), *_values(found.get(number))])
            sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert)
        styles.style_on_load(context, destination, "shares")
        return {"OUTPUT": destination, "TOTAL": answer["total"], "OUTSIDE": 100 * answer["outside"]["share"]}


_FIELDS = [
    ("share_percent", QVariant.Double),
    ("influence", QVariant.Double),
    ("flux_dnb_w", QVariant.Double),
    ("pixels", QVariant.Int),
    ("share_rank", QVariant.Int),
]


def _values(area: dict[str, Any] | None) -> list[Any]:
    if area is None:
        return [None] * len(_FIELDS)
    return [100 * area["share"], area["influence"], area["flux_dnb_w"], area["pixels"], area["rank"]]
