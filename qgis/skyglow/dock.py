"""The dock: the sky of the place that was clicked, in numbers and as the eye sees it."""

from __future__ import annotations

from typing import Any

from qgis.core import Qgis, QgsPointXY
from qgis.gui import QgsDockWidget, QgsVertexMarker
from qgis.PyQt.QtCore import QDateTime, Qt, QTimer, QUrl
from qgis.PyQt.QtGui import QColor, QDesktopServices, QPixmap
from qgis.PyQt.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDateTimeEdit,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from . import settings, words
from .asker import Asker, numbers
from .influence_task import InfluenceTask
from .map_tool import from_degrees
from .problems import ProblemError
from .server import Server

# How long the time must stay as it is before it is asked about.
_SETTLED_MS = 400


class Picture(QLabel):
    """A picture that keeps its shape."""

    def __init__(self) -> None:
        super().__init__()
        self.whole: QPixmap | None = None
        self.setAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
        self.setMinimumSize(220, 240)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Expanding)

    def show_picture(self, whole: QPixmap | None) -> None:
        """Shows another one, or none."""
        self.whole = whole
        self.fit()

    def fit(self) -> None:
        """Makes it as large as there is room."""
        if self.whole is None:
            self.clear()
            return
        ratio = self.devicePixelRatioF()
        smooth = Qt.TransformationMode.SmoothTransformation
        keep = Qt.AspectRatioMode.KeepAspectRatio
        fitted = self.whole.scaled(self.size() * ratio, keep, smooth)
        fitted.setDevicePixelRatio(ratio)
        self.setPixmap(fitted)

    def resizeEvent(self, event: Any) -> None:  # noqa: N802
        """Another size of the dock."""
        super().resizeEvent(event)
        self.fit()


class SkyDock(QgsDockWidget):
    """The dock *Skyglow*."""

    def __init__(self, iface: Any) -> None:
        super().__init__("Skyglow")
        self.setObjectName("SkyglowDock")
        self.iface = iface
        self.place: tuple[float, float] | None = None
        self.asker = Asker(self)
        self.tasks = InfluenceTask(self.say_problem, self.influence_done)
        self.mark: QgsVertexMarker | None = None
        self._build()
        self.settled = QTimer(self)
        self.settled.setSingleShot(True)
        self.settled.setInterval(_SETTLED_MS)
        self.settled.timeout.connect(self.ask)
        self.at_time.toggled.connect(self.time.setEnabled)
        self.at_time.toggled.connect(self.settled.start)
        self.time.dateTimeChanged.connect(self.settled.start)
        self.scene.activated.connect(self.settled.start)
        self.influence.clicked.connect(self.add_influence)
        self.browser.clicked.connect(self.open_browser)
        iface.mapCanvas().destinationCrsChanged.connect(self.move_mark)

    def _build(self) -> None:
        self.scene = QComboBox()
        self.scene.setToolTip("Scene of the server")
        self.scene.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.at_time = QCheckBox("At")
        self.at_time.setToolTip("The natural sky of a time; otherwise a dark one: no Moon, no twilight")
        self.time = QDateTimeEdit(QDateTime.currentDateTime())
        self.time.setCalendarPopup(True)
        self.time.setDisplayFormat("yyyy-MM-dd HH:mm")
        self.time.setToolTip("By this computer's clock")
        self.time.setEnabled(False)
        self.headline = QLabel("Click the map to see the sky there.")
        self.details, self.where = QLabel(), QLabel()
        font = self.headline.font()
        font.setBold(True)
        self.headline.setFont(font)
        for label in (self.headline, self.details, self.where):
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.picture = Picture()
        self.influence = QPushButton("Influence layer")
        self.influence.setToolTip("Adds a layer of the lights that cause this sky")
        self.browser = QPushButton("Open in browser")
        when, buttons = QHBoxLayout(), QHBoxLayout()
        when.addWidget(self.at_time)
        when.addWidget(self.time, 1)
        for button in (self.influence, self.browser):
            button.setEnabled(False)
            buttons.addWidget(button)
        body = QWidget()
        column = QVBoxLayout(body)
        column.addWidget(self.scene)
        column.addLayout(when)
        column.addWidget(self.where)
        column.addWidget(self.headline)
        column.addWidget(self.details)
        column.addWidget(self.picture, 1)
        column.addLayout(buttons)
        self.setWidget(body)

    def show_place(self, latitude_deg: float, longitude_deg: float) -> None:
        """Shows the sky of a place."""
        self.place = (latitude_deg, longitude_deg)
        self.where.setText(words.place(latitude_deg, longitude_deg))
        self.setUserVisible(True)
        self.move_mark()
        self.ask()

    def chosen_scene(self) -> str:
        """The scene that is asked."""
        return self.scene.currentData() or settings.read().scene

    def chosen_time(self) -> str:
        """The time that is asked about, UTC; none for a dark sky."""
        if not self.at_time.isChecked():
            return ""
        return self.time.dateTime().toUTC().toString("yyyy-MM-ddTHH:mm:00") + "Z"

    def ask(self) -> None:
        """Asks for the numbers and the picture of the place."""
        if self.place is None:
            return
        server, scene = Server.of_settings(), self.chosen_scene()
        query = {"lat": self.place[0], "lon": self.place[1], "time": self.chosen_time()}
        side = int(min(max(self.picture.width() * self.picture.devicePixelRatioF(), 240), 1200))
        drawn = {**query, "projection": "fisheye", "style": "eye", "width": side, "height_px": side}
        if not self.scene.count():
            url = server.url("/api/v1/scenes")
            self.asker.ask("scenes", server, url, self.show_scenes, lambda _: None)
        self.headline.setText("…")
        self.details.setText("")
        self.asker.ask("sky", server, server.scene_url(scene, "/sky", query), self.show_sky, self.show_problem)
        url = server.scene_url(scene, "/panorama.png", drawn)
        self.asker.ask("picture", server, url, self.show_picture, lambda _: self.picture.show_picture(None))

    def show_scenes(self, body: bytes) -> None:
        """Lists the scenes, the chosen one as it was."""
        chosen = self.chosen_scene()
        for scene in numbers(body):
            self.scene.addItem(scene["title"], scene["id"])
        self.scene.setCurrentIndex(max(self.scene.findData(chosen), 0))

    def show_sky(self, body: bytes) -> None:
        """Shows the numbers."""
        answer = numbers(body)
        self.headline.setText(words.headline(answer["sky"]))
        self.details.setText(words.details(answer))
        self.influence.setEnabled(True)
        self.browser.setEnabled(True)

    def show_picture(self, body: bytes) -> None:
        """Shows the picture."""
        whole = QPixmap()
        whole.loadFromData(body)
        self.picture.show_picture(whole)

    def show_problem(self, problem: ProblemError) -> None:
        """Shows why there is no sky, where it would stand."""
        self.headline.setText(problem.words())
        self.details.setText("")
        self.picture.show_picture(None)
        self.influence.setEnabled(False)
        self.browser.setEnabled(False)

    def add_influence(self) -> None:
        """Begins to make the layer of the lights behind this sky."""
        if self.place is not None:
            self.influence.setEnabled(False)
            self.tasks.start(self.place, self.chosen_scene())

    def influence_done(self) -> None:
        """Another one may be asked for."""
        self.influence.setEnabled(True)

    def say_problem(self, text: str) -> None:
        """Shows a problem above the map."""
        self.iface.messageBar().pushMessage("Skyglow", text, Qgis.MessageLevel.Warning, 0)

    def viewer_url(self) -> str:
        """The address of this sky in the server's own viewer."""
        latitude_deg, longitude_deg = self.place or (0.0, 0.0)
        url = f"{Server.of_settings().address}/#scene={self.chosen_scene()}"
        url += f"&lat={latitude_deg:.5f}&lon={longitude_deg:.5f}"
        time = self.chosen_time()
        return f"{url}&time={time[:16]}Z" if time else url

    def open_browser(self) -> None:
        """Opens this sky in the browser."""
        QDesktopServices.openUrl(QUrl(self.viewer_url()))

    def move_mark(self) -> None:
        """Puts the mark on the place, wherever that is on the map now."""
        if self.place is None:
            return
        canvas = self.iface.mapCanvas()
        if self.mark is None:
            self.mark = QgsVertexMarker(canvas)
            self.mark.setIconType(QgsVertexMarker.IconType.ICON_CIRCLE)
            self.mark.setColor(QColor("#e0457b"))
            self.mark.setIconSize(14)
            self.mark.setPenWidth(3)
        self.mark.setCenter(from_degrees(canvas, QgsPointXY(self.place[1], self.place[0])))
        self.mark.show()

    def hide_mark(self) -> None:
        """Takes the mark off the map."""
        if self.mark is not None:
            self.mark.hide()

    def close_down(self) -> None:
        """The plugin goes."""
        self.asker.drop_all()
        self.iface.mapCanvas().destinationCrsChanged.disconnect(self.move_mark)
        if self.mark is not None:
            self.iface.mapCanvas().scene().removeItem(self.mark)
            self.mark = None
