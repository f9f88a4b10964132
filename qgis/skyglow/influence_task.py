"""The layer of the lights behind a sky, made beside the window's own work."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from qgis.core import (
    QgsApplication,
    QgsProcessing,
    QgsProcessingAlgRunnerTask,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProject,
    QgsRasterLayer,
)


class _Heard(QgsProcessingFeedback):
    """Keeps what went wrong."""

    def __init__(self) -> None:
        super().__init__(False)
        self.problem = ""

    def reportError(self, error: str, fatalError: bool = False) -> None:  # noqa: N802, N803
        self.problem = error


class InfluenceTask:
    """Runs ``skyglow:influence`` as a task of QGIS, one at a time, and adds its layer to the project."""

    def __init__(self, problem: Callable[[str], None], done: Callable[[], None]) -> None:
        self.problem, self.done = problem, done
        # What the task uses must live as long as it does.
        self.held: tuple[Any, ...] = ()

    def start(self, place: tuple[float, float], scene: str) -> None:
        """Begins."""
        latitude_deg, longitude_deg = place
        algorithm = QgsApplication.processingRegistry().createAlgorithmById("skyglow:influence")
        parameters = {
            "POINT": f"{longitude_deg},{latitude_deg} [EPSG:4326]",
            "SCENE": scene,
            "OUTPUT": QgsProcessing.TEMPORARY_OUTPUT,
        }
        context, feedback = QgsProcessingContext(), _Heard()
        context.setProject(QgsProject.instance())
        task = QgsProcessingAlgRunnerTask(algorithm, parameters, context, feedback)
        name = f"Lights behind {latitude_deg:.4f}, {longitude_deg:.4f}"
        task.executed.connect(lambda is_done, results: self._ended(is_done, results, name))
        self.held = (algorithm, context, feedback, task)
        QgsApplication.taskManager().addTask(task)

    def _ended(self, is_done: bool, results: dict[str, Any], name: str) -> None:
        # Its style lies beside the file, and is loaded with it.
        layer = QgsRasterLayer(results["OUTPUT"], name) if is_done and "OUTPUT" in results else None
        if layer is not None and layer.isValid():
            QgsProject.instance().addMapLayer(layer)
            QgsProject.instance().layerTreeRoot().findLayer(layer.id()).setExpanded(True)
        else:
            self.problem(self.held[2].problem or "The influence layer could not be made.")
        self.done()
