"""The page *Skyglow* of the options."""

from __future__ import annotations

from qgis.gui import QgsAuthConfigSelect, QgsOptionsPageWidget, QgsOptionsWidgetFactory, QgsPasswordLineEdit
from qgis.PyQt.QtGui import QIcon
from qgis.PyQt.QtWidgets import QFormLayout, QHBoxLayout, QLabel, QLineEdit, QPushButton, QWidget

from . import settings
from .problems import ProblemError
from .provider import ICON
from .server import Server


class SkyglowOptions(QgsOptionsWidgetFactory):
    """Makes the page."""

    def __init__(self) -> None:
        super().__init__()
        self.setTitle("Skyglow")

    def icon(self) -> QIcon:
        """The page's icon."""
        return QIcon(ICON)

    def createWidget(self, parent: QWidget | None) -> OptionsPage:  # noqa: N802
        """The page itself."""
        return OptionsPage(parent)


class OptionsPage(QgsOptionsPageWidget):
    """Server, sign-in and default scene."""

    def __init__(self, parent: QWidget | None) -> None:
        super().__init__(parent)
        now = settings.read()
        self.address = QLineEdit(now.address)
        self.address.setPlaceholderText(settings.DEFAULT_ADDRESS)
        self.key = QgsPasswordLineEdit()
        self.key.setText(now.key)
        self.key.setPlaceholderText("none needed")
        self.authentication = QgsAuthConfigSelect()
        self.authentication.setConfigId(now.authentication)
        self.scene = QLineEdit(now.scene)
        self.said = QLabel()
        self.said.setWordWrap(True)
        test = QPushButton("Test")
        test.clicked.connect(self.test)
        row = QHBoxLayout()
        row.addWidget(self.address)
        row.addWidget(test)
        form = QFormLayout(self)
        form.addRow("Server", row)
        form.addRow("", self.said)
        form.addRow("Default scene", self.scene)
        form.addRow("API key", self.key)
        note = QLabel(
            "The key is stored as it is. A sign-in below is stored encrypted, and can send it as a header too."
        )
        note.setWordWrap(True)
        form.addRow("", note)
        form.addRow("Sign-in", self.authentication)

    def entered(self) -> settings.Settings:
        """What the page says."""
        return settings.Settings(
            address=self.address.text().strip().rstrip("/") or settings.DEFAULT_ADDRESS,
            key=self.key.text().strip(),
            authentication=self.authentication.configId(),
            scene=self.scene.text().strip() or settings.DEFAULT_SCENE,
        )

    def test(self) -> None:
        """Says which scenes the server has."""
        entered = self.entered()
        server = Server(entered.address, entered.key, entered.authentication)
        try:
            scenes = server.scene_ids()
        except ProblemError as problem:
            self.said.setText(problem.words())
            return
        self.said.setText(f"It answers. Its scenes: {', '.join(scenes) or 'none yet'}.")

    def apply(self) -> None:
        """Stores what was entered."""
        settings.write(self.entered())
