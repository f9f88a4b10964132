"""Run inside QGIS (`qgis --code`): the plugin in a real window, with its map tool clicked.

``SKYGLOW_QGIS_SAID`` names the file that gets what was seen, as JSON; ``SKYGLOW_QGIS_PICTURE`` one for a picture of the
window. The test that started QGIS judges what was seen.
"""

from __future__ import annotations

import json
import os
import time
import traceback
from collections.abc import Callable
from pathlib import Path

from qgis.core import (
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsPointXY,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
)
from qgis.PyQt.QtCore import QDateTime, QPoint, Qt, QTimer
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QDockWidget
from qgis.utils import iface, plugins

PLACE = (46.53, 8.61)
# From Zurich to Milan in the projection of web maps, metres.
EXTENT = QgsRectangle(820_000, 5_600_000, 1_110_000, 6_000_000)


def wait_for(what: str, is_there: Callable[[], object], seconds: float = 60) -> None:
    """Lets the window live until something is there."""
    end = time.monotonic() + seconds
    while not is_there():
        if time.monotonic() > end:
            raise AssertionError(f"no {what} within {seconds} s")
        QgsApplication.processEvents()
        time.sleep(0.02)


def pixel_of(latitude_deg: float, longitude_deg: float) -> QPoint:
    canvas = iface.mapCanvas()
    from skyglow.map_tool import from_degrees

    on_map = from_degrees(canvas, QgsPointXY(longitude_deg, latitude_deg))
    at = canvas.getCoordinateTransform().transform(on_map)
    return QPoint(round(at.x()), round(at.y()))


def click(latitude_deg: float, longitude_deg: float) -> None:
    at = pixel_of(latitude_deg, longitude_deg)
    QTest.mouseClick(iface.mapCanvas().viewport(), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, at)


def base_layer(server: str) -> None:
    """The terrain of the demo, in the projection of web maps."""
    url = f"{server}/api/v1/scenes/demo/tiles/elevation/{{z}}/{{x}}/{{y}}.png"
    layer = QgsRasterLayer(f"type=xyz&url={url}&zmin=0&zmax=10", "Terrain", "wms")
    QgsProject.instance().setCrs(QgsCoordinateReferenceSystem("EPSG:3857"))
    # Grey, so that colours are those of the lights.
    layer.hueSaturationFilter().setSaturation(-75)
    layer.brightnessFilter().setBrightness(-50)
    QgsProject.instance().addMapLayer(layer)
    # The first layer of a project sets the extent, some time later.
    end = time.monotonic() + 2
    wait_for("first extent", lambda: time.monotonic() > end)
    iface.mapCanvas().setExtent(EXTENT)
    iface.mapCanvas().refresh()


def settle_picture() -> None:
    """Waits for the map, and writes a picture of the window where one is wanted."""
    path = os.environ.get("SKYGLOW_QGIS_PICTURE")
    if path is None:
        return
    end = time.monotonic() + 6
    wait_for("time to draw", lambda: time.monotonic() > end)
    iface.mainWindow().grab().save(path)


def look() -> dict[str, object]:
    """Uses the plugin as a person would, and says what was there."""
    said: dict[str, object] = {}
    plugin = plugins["skyglow"]
    dock = plugin.dock
    for other in iface.mainWindow().findChildren(QDockWidget):
        if other.objectName() in ("Browser", "StatistalSummaryDockWidget", "ProcessingToolbox"):
            other.close()
    window = iface.mainWindow()
    window.resize(1280, 800)
    base_layer(os.environ["SKYGLOW_URL"])
    said["algorithms"] = sorted(algorithm.id() for algorithm in plugin.provider.algorithms())
    plugin.action.trigger()
    window.resizeDocks([window.findChild(QDockWidget, "Layers"), dock], [320, 330], Qt.Orientation.Horizontal)
    said["tool"] = iface.mapCanvas().mapTool() is plugin.tool

    click(*PLACE)
    wait_for("place", lambda: dock.place)
    wait_for("answer", lambda: not dock.asker.is_waiting())
    said["place"] = dock.place
    said["pixel_deg"] = iface.mapCanvas().mapUnitsPerPixel() / 111_320
    said["headline"], said["details"] = dock.headline.text(), dock.details.text()
    said["scenes"] = [dock.scene.itemData(i) for i in range(dock.scene.count())]
    whole = dock.picture.whole
    said["picture"] = [whole.width(), whole.height()]
    said["viewer"] = dock.viewer_url()
    said["mark"] = dock.mark.isVisible()

    dock.at_time.setChecked(True)
    dock.time.setDateTime(QDateTime.fromString("2026-08-12T23:00:00Z", Qt.DateFormat.ISODate).toLocalTime())
    wait_for("question about a time", lambda: dock.asker.is_waiting())
    wait_for("answer at a time", lambda: not dock.asker.is_waiting())
    said["at_time"] = [dock.headline.text(), dock.details.text(), dock.viewer_url()]

    before = set(QgsProject.instance().mapLayers())
    dock.influence.click()
    wait_for("influence layer", lambda: set(QgsProject.instance().mapLayers()) - before)
    (added,) = set(QgsProject.instance().mapLayers()) - before
    layer = QgsProject.instance().mapLayer(added)
    said["influence"] = layer.name()
    items = layer.renderer().shader().rasterShaderFunction().colorRampItemList()
    said["legend"] = [[item.value, item.label] for item in items[:-1]]
    wait_for("button", dock.influence.isEnabled)
    settle_picture()

    click(20.0, 60.0)
    wait_for("answer outside", lambda: not dock.asker.is_waiting())
    said["outside"] = [dock.headline.text(), dock.picture.whole is None, dock.influence.isEnabled()]
    from qgis.utils import unloadPlugin

    said["unloaded"] = unloadPlugin("skyglow")
    said["gone"] = QgsApplication.processingRegistry().providerById("skyglow") is None
    return said


def main() -> None:
    try:
        said = look()
    except BaseException:
        said = {"failed": traceback.format_exc()}
    Path(os.environ["SKYGLOW_QGIS_SAID"]).write_text(json.dumps(said, indent=1), encoding="utf-8")
    # QGIS would ask whether to save the project.
    os._exit(0)


QTimer.singleShot(500, main)
