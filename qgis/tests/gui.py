"""Run inside QGIS (`qgis --code`): the plugin in a real window, with its map tool clicked.

``SKYGLOW_QGIS_SAID`` names the file that gets what was seen, as JSON; ``SKYGLOW_QGIS_PICTURE`` one for a picture of the
window with influences, ``SKYGLOW_QGIS_PLAN_PICTURE`` one with a plan. The test that started QGIS judges what was seen.
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
    QgsFeature,
    QgsGeometry,
    QgsMarkerSymbol,
    QgsPointXY,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QDateTime, QPoint, Qt, QTimer
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QDockWidget
from qgis.utils import iface, plugins

PLACE = (46.53, 8.61)
# A place between towns.
SITE = (46.30, 8.79)
# From Zurich to Milan in the projection of web maps, metres; and what lies around the site.
EXTENT = QgsRectangle(820_000, 5_600_000, 1_110_000, 6_000_000)
SITE_EXTENT = QgsRectangle(912_000, 5_715_000, 1_045_000, 5_865_000)


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


def tiles(server: str, layer: str, title: str) -> QgsRasterLayer:
    """Map tiles of the demo."""
    url = f"{server}/api/v1/scenes/demo/tiles/{layer}/{{z}}/{{x}}/{{y}}.png"
    return QgsRasterLayer(f"type=xyz&url={url}&zmin=0&zmax=10", title, "wms")


def base_layer(server: str) -> None:
    """The terrain of the demo, in the projection of web maps."""
    layer = tiles(server, "elevation", "Terrain")
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


def settle_picture(wanted: str) -> None:
    """Waits for the map, and writes a picture of the window where the variable names a file for one."""
    path = os.environ.get(wanted)
    if path is None:
        return
    # Tiles come one after the other, and each is drawn anew.
    drawn = time.monotonic()

    def is_settled() -> bool:
        nonlocal drawn
        if iface.mapCanvas().isDrawing():
            drawn = time.monotonic()
        return time.monotonic() > drawn + 4

    wait_for("map without changes", is_settled, 120)
    iface.mainWindow().grab().save(path)


def plan_layer(influence: str) -> dict[str, object]:
    """What to dim for a site, by the processing algorithm, in place of the layer of influences."""
    import processing

    project = QgsProject.instance()
    node = project.layerTreeRoot().findLayer(influence)
    node.setItemVisibilityChecked(False)
    node.setExpanded(False)
    lights = tiles(os.environ["SKYGLOW_URL"], "radiance", "Lights today")
    lights.hueSaturationFilter().setSaturation(-100)
    project.addMapLayer(lights)
    sites = QgsVectorLayer("Point?crs=EPSG:4326", "Site: 30 % darker", "memory")
    site = QgsFeature(sites.fields())
    site.setGeometry(QgsGeometry.fromPointXY(QgsPointXY(SITE[1], SITE[0])))
    sites.dataProvider().addFeature(site)
    marker = QgsMarkerSymbol.createSimple(
        {"name": "cross_fill", "color": "white", "size": "4", "outline_color": "black"}
    )
    sites.renderer().setSymbol(marker)
    project.addMapLayer(sites)
    before = set(project.mapLayers())
    results = processing.runAndLoadResults("skyglow:plan", {"SITES": sites, "OUTPUT": "TEMPORARY_OUTPUT"})
    (added,) = set(project.mapLayers()) - before
    project.layerTreeRoot().findLayer(added).setExpanded(True)
    project.layerTreeRoot().findLayer(lights).setExpanded(False)
    layer = project.mapLayer(added)
    items = layer.renderer().shader().rasterShaderFunction().colorRampItemList()
    numbers = {name: results[name] for name in ("FLUX_REMOVED_PERCENT", "SITES_MET")}
    return {"name": layer.name(), "legend": [item.label for item in items], **numbers}


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
    settle_picture("SKYGLOW_QGIS_PICTURE")

    dock.at_time.setChecked(False)
    iface.mapCanvas().setExtent(SITE_EXTENT)
    click(*SITE)
    wait_for("answer at the site", lambda: not dock.asker.is_waiting())
    said["plan"] = plan_layer(added)
    settle_picture("SKYGLOW_QGIS_PLAN_PICTURE")

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
