"""What QGIS starts: the provider always, and in a window the map tool, its dock and the options page."""

from __future__ import annotations

from typing import Any

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QIcon
from qgis.PyQt.QtWidgets import QAction

from .provider import ICON, SkyglowProvider


class SkyglowPlugin:
    """The plugin; ``iface`` is None in qgis_process."""

    def __init__(self, iface: Any) -> None:
        self.iface = iface
        self.provider: SkyglowProvider | None = None
        self.action: QAction | None = None

    def initProcessing(self) -> None:  # noqa: N802
        """Adds the provider; qgis_process calls nothing else."""
        self.provider = SkyglowProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self) -> None:  # noqa: N802
        """Adds all that needs a window."""
        from .dock import SkyDock
        from .map_tool import SkyTool
        from .options import SkyglowOptions

        self.initProcessing()
        self.options = SkyglowOptions()
        self.iface.registerOptionsWidgetFactory(self.options)
        self.dock = SkyDock(self.iface)
        self.iface.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, self.dock)
        self.dock.hide()
        self.tool = SkyTool(self.iface.mapCanvas())
        self.tool.picked.connect(self.dock.show_place)
        self.tool.dropped.connect(self.dock.hide_mark)
        self.action = QAction(QIcon(ICON), "Sky at a Place", self.iface.mainWindow())
        self.action.setObjectName("skyglowSkyAtPlace")
        self.action.setToolTip("Skyglow: click the map to see the night sky there")
        self.action.setCheckable(True)
        self.action.triggered.connect(self.pick)
        self.tool.setAction(self.action)
        self.iface.addToolBarIcon(self.action)
        self.iface.addPluginToMenu("Skyglow", self.action)

    def pick(self) -> None:
        """Clicks on the map show their sky from now on."""
        self.iface.mapCanvas().setMapTool(self.tool)
        self.dock.show()

    def unload(self) -> None:
        """Takes all away again."""
        if self.provider is not None:
            QgsApplication.processingRegistry().removeProvider(self.provider)
            self.provider = None
        if self.action is None:
            return
        self.iface.mapCanvas().unsetMapTool(self.tool)
        self.iface.removePluginMenu("Skyglow", self.action)
        self.iface.removeToolBarIcon(self.action)
        self.action.deleteLater()
        self.action = None
        self.dock.close_down()
        self.iface.removeDockWidget(self.dock)
        self.dock.deleteLater()
        self.iface.unregisterOptionsWidgetFactory(self.options)
