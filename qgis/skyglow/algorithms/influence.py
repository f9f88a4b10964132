"""Which lights cause the sky of a place, pixel by pixel."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingOutputNumber,
    QgsProcessingOutputString,
    QgsProcessingParameterRasterDestination,
)

from .. import styles
from .base import MEASURE_WORDS, MEASURES, SkyglowAlgorithm, warn_of
from .rasters import write_raster


class InfluenceAlgorithm(SkyglowAlgorithm):
    """``skyglow:influence``."""

    NAME = "influence"
    TITLE = "Which lights cause a sky"
    HELP = (
        "A raster on the scene's own grid: what each lit pixel within 300 km has in the sky of the place. It is "
        "coloured by the pixel's part in the whole. TOTAL is the sky's own value, in UNIT."
    )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: N802
        """Its parameters."""
        self.add_place()
        self.add_measure([*MEASURES, "norm"])
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Influence"))
        self.addOutput(QgsProcessingOutputNumber("TOTAL", "Sum over all lights"))
        self.addOutput(QgsProcessingOutputString("UNIT", "Its unit"))
        self.add_common()

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Asks for the raster, and for the whole that its colours are parts of."""
        server, scene = self.server(parameters, context), self.scene(parameters, context)
        measure, place = self.measure(parameters, context), self.place(parameters, context)
        query = {**place, "measure": measure, **self.query(parameters, context)}
        answer = server.get(server.scene_url(scene, "/influence.tif", query), feedback)
        whole = server.get(server.scene_url(scene, "/influence.json", {**query, "limit": 0}), feedback).json()
        warn_of(whole, feedback.pushInfo)
        path = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        write_raster(path, answer.body)
        name = f"Lights behind the {MEASURE_WORDS[measure]} at {place['lat']:.4f}, {place['lon']:.4f}"
        styles.style_file(path, "influence", whole["total"])
        styles.style_on_load(context, path, "influence", whole["total"], name)
        return {"OUTPUT": path, "TOTAL": whole["total"], "UNIT": whole["unit"]}
