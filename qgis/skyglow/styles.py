"""How layers look: the QML files beside this one, put on layers and beside files."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from qgis.core import (
    QgsMapLayer,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingLayerPostProcessorInterface,
    QgsProject,
)
from qgis.PyQt.QtXml import QDomDocument

FOLDER = Path(__file__).parent / "styles"


def style_text(style: str, whole: float | None = None) -> str:
    """A style as QML; with ``whole`` the limits of its classes are parts of that."""
    text = (FOLDER / f"{style}.qml").read_text(encoding="utf-8")
    if whole is None:
        return text
    root = ElementTree.fromstring(text)
    for element in root.iter():
        for name in _SCALED.get(element.tag, ()):
            element.set(name, repr(float(element.get(name, "0")) * whole))
    return ElementTree.tostring(root, encoding="unicode")


# Of a raster's classes: the attributes that hold values.
_SCALED = {
    "item": ["value"],
    "colorrampshader": ["minimumValue", "maximumValue"],
    "rasterrenderer": ["classificationMin", "classificationMax"],
}


def apply_style(layer: QgsMapLayer, style: str, whole: float | None = None) -> None:
    """Puts a style on a layer."""
    document = QDomDocument()
    document.setContent(style_text(style, whole))
    layer.importNamedStyle(document)
    layer.triggerRepaint()


def style_file(path: str, style: str, whole: float | None = None) -> None:
    """Writes the style beside a raster, where QGIS looks for it whenever the file is opened."""
    Path(path).with_suffix(".qml").write_text(style_text(style, whole), encoding="utf-8")


class _Styled(QgsProcessingLayerPostProcessorInterface):
    """Puts a style on a result when processing loads it."""

    # Processing does not own post-processors: without this list Python would drop them too early.
    kept: list[_Styled] = []  # noqa: RUF012

    def __init__(self, style: str, whole: float | None) -> None:
        super().__init__()
        self.style, self.whole = style, whole

    def postProcessLayer(  # noqa: N802
        self, layer: QgsMapLayer, context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> None:
        apply_style(layer, self.style, self.whole)
        _Styled.kept.remove(self)


def style_on_load(
    context: QgsProcessingContext, destination: Any, style: str, whole: float | None = None, name: str = ""
) -> None:
    """Has a result styled, and named, when it is loaded into the project."""
    if not context.willLoadLayerOnCompletion(destination):
        return
    details = context.layerToLoadOnCompletionDetails(destination)
    if name and isinstance(details.project, QgsProject):
        details.name = name
    processor = _Styled(style, whole)
    _Styled.kept.append(processor)
    details.setPostProcessor(processor)
