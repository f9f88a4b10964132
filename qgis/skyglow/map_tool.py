"""The map tool: a click says which place."""

from __future__ import annotations

from qgis.core import Qgis, QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsPointXY, QgsProject
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent, QgsMapToolEmitPoint
from qgis.PyQt.QtCore import Qt, pyqtSignal


class SkyTool(QgsMapToolEmitPoint):
    """Emits the place of a click, degrees north and east."""

    picked = pyqtSignal(float, float)
    dropped = pyqtSignal()

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__(canvas)
        self.setCursor(Qt.CursorShape.CrossCursor)

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:  # noqa: N802
        """A click of the left button."""
        if event.button() == Qt.MouseButton.LeftButton:
            place = to_degrees(self.canvas(), self.toMapCoordinates(event.pos()))
            self.picked.emit(place.y(), place.x())

    def deactivate(self) -> None:
        """Another tool takes over."""
        super().deactivate()
        self.dropped.emit()


def to_degrees(canvas: QgsMapCanvas, point: QgsPointXY) -> QgsPointXY:
    """A point of the map in degrees."""
    return _degrees(canvas).transform(point)


def from_degrees(canvas: QgsMapCanvas, point: QgsPointXY) -> QgsPointXY:
    """A place in degrees on the map."""
    return _degrees(canvas).transform(point, Qgis.TransformDirection.Reverse)


def _degrees(canvas: QgsMapCanvas) -> QgsCoordinateTransform:
    wgs84 = QgsCoordinateReferenceSystem("EPSG:4326")
    return QgsCoordinateTransform(canvas.mapSettings().destinationCrs(), wgs84, QgsProject.instance())
