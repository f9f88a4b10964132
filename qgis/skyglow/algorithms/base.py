"""What all algorithms share: server, scene and assumptions among their parameters, and problems in plain words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from urllib.parse import parse_qsl

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterEnum,
    QgsProcessingParameterNumber,
    QgsProcessingParameterPoint,
    QgsProcessingParameterString,
)

from .. import settings
from ..problems import ProblemError, unknown_scene
from ..server import CancelledError, Server

WGS84 = "EPSG:4326"
LAMPS = [
    "mixed",
    "neutral",
    "incandescent",
    "hps",
    "hps_colour_enhanced",
    "lps",
    "pc_amber",
    "led_2700k",
    "led_3000k",
    "led_4000k",
    "led_5000k",
    "led_6500k",
    "led_hybrid",
    "led_rgb",
    "led_violet_2700k",
    "led_violet_4000k",
    "metal_halide_3000k",
    "metal_halide",
    "metal_halide_ceramic",
    "mercury",
    "fluorescent",
    "fluorescent_three_band",
]
EMISSIONS = ["modern_city", "garstang_1986", "full_cutoff"]
MEASURES = ["zenith", "mean", "horizontal"]
MEASURE_WORDS = {
    "zenith": "brightness of the zenith",
    "mean": "mean brightness of the visible sky",
    "horizontal": "light on level ground",
    "norm": "size of each light's own glow",
}


class SkyglowAlgorithm(QgsProcessingAlgorithm):
    """An algorithm that asks the server: subclasses say what in ``ask``."""

    NAME = ""
    TITLE = ""
    HELP = ""

    def name(self) -> str:
        """Its id in the provider."""
        return self.NAME

    def displayName(self) -> str:  # noqa: N802
        """Its name in the toolbox."""
        return self.TITLE

    def shortHelpString(self) -> str:  # noqa: N802
        """What stands beside its dialog."""
        return self.HELP

    def createInstance(self) -> QgsProcessingAlgorithm:  # noqa: N802
        """A new one of the same kind."""
        return type(self)()

    def processAlgorithm(  # noqa: N802
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Asks, and puts problems into words."""
        try:
            return self.ask(parameters, context, feedback)
        except ProblemError as problem:
            words = problem.words()
            if problem.kind == "unknown-scene":
                words = unknown_scene(self.scene(parameters, context), self.server(parameters, context).scene_ids())
            raise QgsProcessingException(words) from problem
        except CancelledError:
            return {}

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """What the algorithm does."""
        raise NotImplementedError

    def add_common(self) -> None:
        """Scene, assumptions and server, after the algorithm's own parameters."""
        scene = QgsProcessingParameterString("SCENE", "Scene", settings.read().scene)
        self.addParameter(scene)
        number = QgsProcessingParameterNumber.Type.Double
        self.add_advanced(
            QgsProcessingParameterNumber("TURBIDITY", "Turbidity of the air (2.5 is clear)", number, 2.5, False, 1, 20)
        )
        self.add_advanced(_names("LAMP", "Lamps", LAMPS))
        self.add_advanced(_names("EMISSION", "How lamps send their light", EMISSIONS))
        self.add_advanced(QgsProcessingParameterString("SCENARIO", "Id of a scenario or plan", "", False, True))
        further = "Further parameters of the interface, such as clouds=1500&response=scotopic"
        self.add_advanced(QgsProcessingParameterString("QUERY", further, "", False, True))
        self.add_advanced(QgsProcessingParameterString("SERVER", "Server, if not that of the options", "", False, True))

    def add_advanced(self, parameter: QgsProcessingParameterDefinition) -> None:
        """A parameter among the advanced ones."""
        parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.Flag.FlagAdvanced)
        self.addParameter(parameter)

    def add_place(self) -> None:
        """The place whose sky is asked about."""
        self.addParameter(QgsProcessingParameterPoint("POINT", "Place"))

    def add_measure(self, names: list[str]) -> None:
        """What of the sky lights have their part in."""
        self.addParameter(_names("MEASURE", "Measure", names))

    def server(self, parameters: dict[str, Any], context: QgsProcessingContext) -> Server:
        """The server that is asked."""
        return Server.of_settings(self.parameterAsString(parameters, "SERVER", context))

    def scene(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        """The scene that is asked."""
        return self.parameterAsString(parameters, "SCENE", context).strip() or settings.read().scene

    def query(self, parameters: dict[str, Any], context: QgsProcessingContext) -> dict[str, Any]:
        """The assumptions as the interface takes them; the server's own defaults are not sent."""
        asked: dict[str, Any] = {}
        turbidity = self.parameterAsDouble(parameters, "TURBIDITY", context)
        if turbidity != 2.5:
            asked["turbidity"] = turbidity
        for name, usual in (("LAMP", LAMPS[0]), ("EMISSION", EMISSIONS[0])):
            value = self.parameterAsString(parameters, name, context)
            if value != usual:
                asked[name.lower()] = value
        asked["scenario"] = self.parameterAsString(parameters, "SCENARIO", context).strip()
        further = self.parameterAsString(parameters, "QUERY", context).strip().lstrip("?")
        asked.update(parse_qsl(further, keep_blank_values=True))
        return asked

    def place(self, parameters: dict[str, Any], context: QgsProcessingContext) -> dict[str, float]:
        """The place as the interface takes it."""
        point = self.parameterAsPoint(parameters, "POINT", context, QgsCoordinateReferenceSystem(WGS84))
        return {"lat": point.y(), "lon": point.x()}

    def measure(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        """The measure by its name."""
        return self.parameterAsString(parameters, "MEASURE", context)


def _names(name: str, words: str, names: list[str]) -> QgsProcessingParameterEnum:
    return QgsProcessingParameterEnum(name, words, names, False, names[0], False, True)


def to_wgs84(crs: QgsCoordinateReferenceSystem, context: QgsProcessingContext) -> QgsCoordinateTransform:
    """From a layer's coordinates to degrees."""
    return QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem(WGS84), context.transformContext())


def warn_of(answer: dict[str, Any], say: Callable[[str], None]) -> None:
    """Shows what the server warns of, once each."""
    for warning in answer.get("warnings") or []:
        say(str(warning))
    if (answer.get("scene") or {}).get("illustrative"):
        say("The scene is illustrative: made-up light, not measured.")
