"""Writes the QML styles of the plugin: `python3 qgis/make_styles.py`, with the Python that has QGIS.

Limits of influences are parts of a sky, which the plugin multiplies by the sky's value; of brightness they are cd/m².
"""

from __future__ import annotations

import math
import os
import tempfile
from pathlib import Path
from typing import Any

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
# The order of attributes in a file is that of a hash, the same in every run with this.
os.environ.setdefault("QT_HASH_SEED", "0")

from osgeo import gdal
from qgis.core import (
    QgsApplication,
    QgsCategorizedSymbolRenderer,
    QgsColorRampShader,
    QgsGraduatedSymbolRenderer,
    QgsMapLayer,
    QgsMarkerSymbol,
    QgsPalLayerSettings,
    QgsRasterLayer,
    QgsRasterShader,
    QgsRendererCategory,
    QgsRendererRange,
    QgsSingleBandPseudoColorRenderer,
    QgsStyle,
    QgsTextBufferSettings,
    QgsTextFormat,
    QgsVectorLayer,
    QgsVectorLayerSimpleLabeling,
)
from qgis.PyQt.QtGui import QColor

FOLDER = Path(__file__).parent / "skyglow" / "styles"
# The dark reference outside the air, cd/m² (`natural` of the TileJSON of the layer brightness), and the limits of the
# classes of the World Atlas (Falchi et al. 2016), as parts of it.
NATURAL_CD_M2 = 2.2855528021820134e-4
RATIOS = [0.01 * 2**step for step in range(13)]
# Parts of a sky that one pixel has.
PARTS = [1e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2]


def classes(limits: list[float], colours: list[str | None], labels: list[str]) -> QgsSingleBandPseudoColorRenderer:
    """Classes up to each limit and beyond the last; without a colour a class is transparent."""
    ramp = QgsColorRampShader(0, limits[-1], None, QgsColorRampShader.Type.Discrete)
    items = []
    for limit, colour, label in zip([*limits, math.inf], colours, labels):
        painted = QColor(colour) if colour else QColor(0, 0, 0, 0)
        items.append(QgsColorRampShader.ColorRampItem(limit, painted, label))
    ramp.setColorRampItemList(items)
    shader = QgsRasterShader()
    shader.setRasterShaderFunction(ramp)
    renderer = QgsSingleBandPseudoColorRenderer(None, 1, shader)
    renderer.setClassificationMin(0)
    renderer.setClassificationMax(limits[-1])
    return renderer


def ramp_colours(name: str, count: int, start: float, end: float) -> list[str]:
    """Colours of one of QGIS's own ramps."""
    ramp = QgsStyle.defaultStyle().colorRamp(name)
    return [ramp.color(start + (end - start) * i / (count - 1)).name() for i in range(count)]


def percent(part: float) -> str:
    """A part in per cent, without digits that say nothing."""
    return f"{100 * part:.4f}".rstrip("0").rstrip(".")


def influence() -> QgsSingleBandPseudoColorRenderer:
    """Each pixel's part in the sky: bright is much."""
    labels = ["Of this sky's light, by each pixel:"]
    labels += [f"{percent(low)}–{percent(high)} %" for low, high in zip(PARTS, PARTS[1:])]
    labels += [f"above {percent(PARTS[-1])} %"]
    return classes(PARTS, [None, *ramp_colours("Viridis", len(PARTS), 0.08, 1)], labels)


def ratio(value: float) -> str:
    """A brightness as people count it: in per cent of the natural sky, or in times."""
    return f"{100 * value:.0f} %" if value < 1 else f"{value:.1f} ×".replace(".0 ×", " ×")


def brightness() -> QgsSingleBandPseudoColorRenderer:
    """Light by that of the natural sky."""
    labels = ["Relative to the natural sky:"]
    labels += [f"{ratio(low)} – {ratio(high)}" for low, high in zip(RATIOS, RATIOS[1:])]
    labels += [f"above {ratio(RATIOS[-1])}"]
    limits = [part * NATURAL_CD_M2 for part in RATIOS]
    return classes(limits, [None, *ramp_colours("Plasma", len(limits), 0, 1)], labels)


def plan() -> QgsSingleBandPseudoColorRenderer:
    """The part of each light that goes: yellow a little, red all."""
    limits = [1e-9, 0.2, 0.4, 0.6, 0.8, 0.999999]
    labels = ["Of each light:", "up to 20 % goes", "20–40 %", "40–60 %", "60–80 %", "80–100 %", "all goes"]
    return classes(limits, [None, "#ffeda0", "#fec44f", "#fe9929", "#ec5f1e", "#cc2a1a", "#7a0016"], labels)


def labelled(layer: QgsVectorLayer, expression: str) -> None:
    """Labels that read over any map."""
    text = QgsTextFormat()
    text.setSize(9)
    halo = QgsTextBufferSettings()
    halo.setEnabled(True)
    halo.setSize(0.8)
    text.setBuffer(halo)
    settings = QgsPalLayerSettings()
    settings.setFormat(text)
    settings.fieldName, settings.isExpression = expression, True
    layer.setLabeling(QgsVectorLayerSimpleLabeling(settings))
    layer.setLabelsEnabled(True)


def circle(colour: str, size: float = 3.2) -> QgsMarkerSymbol:
    """A point of a colour."""
    symbol = {"name": "circle", "color": colour, "size": str(size), "outline_color": "#202020", "outline_width": "0.3"}
    return QgsMarkerSymbol.createSimple(symbol)


def points(layer: QgsVectorLayer, expression: str) -> None:
    """Points by Bortle's class."""
    colours = ["#101020", "#2b2b60", "#2050b0", "#20a060", "#e0d030", "#f09020", "#e04020", "#f0a0a0", "#ffffff"]
    words = [
        "excellent dark site",
        "typical dark site",
        "rural sky",
        "rural to suburban",
        "suburban sky",
        "bright suburban sky",
        "suburban to urban",
        "city sky",
        "inner-city sky",
    ]
    found = [
        QgsRendererCategory(number, circle(colour), f"Bortle {number}: {word}")
        for number, (colour, word) in enumerate(zip(colours, words), 1)
    ]
    layer.setRenderer(QgsCategorizedSymbolRenderer("bortle_class", found))
    labelled(layer, expression)


def shares(layer: QgsVectorLayer) -> None:
    """Areas by their share."""
    limits = [0, 0.1, 0.3, 1, 3, 10, 30, 100.0001]
    colours = ramp_colours("YlOrRd", len(limits) - 1, 0, 1)
    symbol = layer.renderer().symbol()
    ranges = []
    for low, high, colour in zip(limits, limits[1:], colours):
        own = symbol.clone()
        own.setColor(QColor(colour))
        own.setOpacity(0.8)
        words = f"{low:g}–{round(high):g} %" if high >= 1 else f"{low:g}–{high:g} %"
        ranges.append(QgsRendererRange(low, high, own, words))
    layer.setRenderer(QgsGraduatedSymbolRenderer("share_percent", ranges))
    labelled(layer, 'format_number("share_percent", if("share_percent" < 1, 2, 1)) || \' %\'')


def raster_layer(folder: str) -> QgsRasterLayer:
    """A raster to put renderers on."""
    path = f"{folder}/one.tif"
    gdal.GetDriverByName("GTiff").Create(path, 1, 1, 1, gdal.GDT_Float32).FlushCache()
    return QgsRasterLayer(path, "one")


def save(layer: QgsMapLayer, name: str) -> None:
    """Writes what shows, and nothing of this layer itself."""
    categories = QgsMapLayer.StyleCategory.Symbology | QgsMapLayer.StyleCategory.Labeling
    said: Any = layer.saveNamedStyle(str(FOLDER / f"{name}.qml"), categories)
    print(name, said)


def main() -> None:
    """Writes all styles."""
    application = QgsApplication([], False)
    application.initQgis()
    with tempfile.TemporaryDirectory() as folder:
        for name, renderer in (("influence", influence()), ("brightness", brightness()), ("plan", plan())):
            layer = raster_layer(folder)
            layer.setRenderer(renderer)
            layer.renderer().setOpacity(0.85)
            save(layer, name)
    field = "field=bortle_class:integer&field=zenith_total_brightness_mag_arcsec2:double&field=gain_mag:double"
    layer = QgsVectorLayer(f"Point?{field}", "sky", "memory")
    points(layer, 'format_number("zenith_total_brightness_mag_arcsec2", 2)')
    save(layer, "sky")
    points(layer, "'+' || format_number(\"gain_mag\", 2) || ' mag'")
    save(layer, "darker")
    layer = QgsVectorLayer("Polygon?field=share_percent:double", "shares", "memory")
    shares(layer)
    save(layer, "shares")
    application.exitQgis()


if __name__ == "__main__":
    main()
