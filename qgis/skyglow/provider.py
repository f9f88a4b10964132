"""The processing provider: ``skyglow`` in the toolbox and for qgis_process."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .algorithms.brightness import BrightnessAlgorithm
from .algorithms.darker import DarkerAlgorithm
from .algorithms.influence import InfluenceAlgorithm
from .algorithms.plan import PlanAlgorithm
from .algorithms.shares import SharesAlgorithm
from .algorithms.sky import SkyAlgorithm

ICON = str(Path(__file__).parent / "icon.svg")


class SkyglowProvider(QgsProcessingProvider):
    """All algorithms of the plugin."""

    def loadAlgorithms(self) -> None:  # noqa: N802
        """Adds them."""
        for kind in (
            SkyAlgorithm,
            InfluenceAlgorithm,
            SharesAlgorithm,
            PlanAlgorithm,
            DarkerAlgorithm,
            BrightnessAlgorithm,
        ):
            self.addAlgorithm(kind())

    def id(self) -> str:
        """What stands before the colon."""
        return "skyglow"

    def name(self) -> str:
        """Its name in the toolbox."""
        return "Skyglow"

    def icon(self) -> QIcon:
        """Its icon in the toolbox."""
        return QIcon(ICON)

    def supportedOutputRasterLayerExtensions(self) -> list[str]:  # noqa: N802
        """The server sends GeoTIFF."""
        return ["tif"]
