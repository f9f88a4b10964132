"""The brightness of the sky, or the light on the ground or on walls, everywhere."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputString,
    QgsProcessingParameterEnum,
    QgsProcessingParameterRasterDestination,
    QgsRasterLayer,
)

from .. import styles
from ..server import Server
from .base import SkyglowAlgorithm
from .rasters import write_raster

FILE, TILES = "file", "tiles"
MAP_MEASURES = [
    "zenith",
    "mean",
    "horizontal",
    "slope",
    "vertical_north",
    "vertical_east",
    "vertical_south",
    "vertical_west",
    "vertical_largest",
    "cylindrical",
    "spherical",
]
# The natural sky that the limits of the style are of, cd/m²: see `make_styles.py`.
STYLE_NATURAL = 2.2855528021820134e-4


class BrightnessAlgorithm(SkyglowAlgorithm):
    """``skyglow:brightness``."""

    NAME = "brightness"
    TITLE = "Brightness of the sky everywhere"
    HELP = (
        "The artificial luminance of the zenith at every place of the scene (cd/m²), or another measure such as the "
        "light on level ground (lx), as a cloud-optimized GeoTIFF on the scene's own grid, or as map tiles that the "
        "server draws. It is coloured by what the natural sky has of that measure. The first time takes seconds to "
        "minutes, and shows how far it is; then the server has it."
    )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: N802
        """Its parameters."""
        self.add_measure(MAP_MEASURES)
        self.addParameter(QgsProcessingParameterEnum("FORM", "As", [FILE, TILES], False, FILE, False, True))
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Brightness (file)", None, True))
        self.addOutput(QgsProcessingOutputString("TILES", "Source of the tiles' layer"))
        self.add_common()

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Asks for the file, or for the tiles once they are ready."""
        server, scene = self.server(parameters, context), self.scene(parameters, context)
        measure = self.measure(parameters, context)
        query = {"measure": measure if measure != MAP_MEASURES[0] else None, **self.query(parameters, context)}
        # The file is of the same map as the tiles, whose description says how far that is.
        described = server.when_ready(server.scene_url(scene, "/tiles/brightness/tilejson.json", query), feedback)
        feedback.pushInfo(described["description"])
        # What it shows, in the server's words, before its limits.
        title = described["description"].partition(": ")[0]
        title = title[:1].upper() + title[1:]
        if self.parameterAsString(parameters, "FORM", context) == TILES:
            return {"TILES": self._tiles(server, described, title, context)}
        path = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        if not path:
            raise QgsProcessingException("Choose a file for the brightness.")
        url = server.scene_url(scene, "/layers/brightness.tif", query)
        write_raster(path, server.get(url, feedback).body)
        whole = described["natural"] / STYLE_NATURAL
        styles.style_file(path, "brightness", whole)
        styles.style_on_load(context, path, "brightness", whole, title)
        return {"OUTPUT": path}

    def _tiles(self, server: Server, described: dict[str, Any], title: str, context: QgsProcessingContext) -> str:
        source = tile_source(server, described)
        layer = QgsRasterLayer(source, title, "wms")
        if not layer.isValid():
            raise QgsProcessingException("QGIS cannot read the tiles.")
        context.temporaryLayerStore().addMapLayer(layer)
        if context.project() is not None:
            details = QgsProcessingContext.LayerDetails(title, context.project(), "TILES")
            context.addLayerToLoadOnCompletion(layer.id(), details)
        return source


def tile_source(server: Server, described: dict[str, Any]) -> str:
    """The source of an XYZ layer of QGIS from TileJSON."""
    url = described["tiles"][0].replace("&", "%26").replace("=", "%3D")
    source = f"type=xyz&url={url}&zmin={described['minzoom']}&zmax={described['maxzoom']}"
    return f"{source}&authcfg={server.authentication}" if server.authentication else source
