"""What to dim, so that sites get darker."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputNumber,
    QgsProcessingOutputString,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from .. import reports, styles
from ..server import Server
from . import areas
from .base import MEASURES, SkyglowAlgorithm, to_wgs84, warn_of
from .rasters import write_raster
from .sky import point_of

# The server takes as many sites.
MAX_SITES = 16


class PlanAlgorithm(SkyglowAlgorithm):
    """``skyglow:plan``."""

    NAME = "plan"
    TITLE = "Plan what to dim"
    HELP = (
        "The least light to take away such that every site gets as much darker as it wants: a raster of the part of"
        " each pixel's light that goes (0 to 1), and a report with every site before and after. <i>Dim only "
        "inside</i> is the area whose lights are in your hands; <i>leave alone</i> holds lights that stay. What is "
        "out of reach is brought as near as it can be, and the report says why. With <i>keep</i> the server stores "
        "the plan and lists it for everybody."
    )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: N802
        """Its parameters."""
        points = [QgsProcessing.SourceType.TypeVectorPoint]
        kinds = [QgsProcessing.SourceType.TypeVectorPolygon]
        number = QgsProcessingParameterNumber.Type.Double
        self.addParameter(QgsProcessingParameterFeatureSource("SITES", "Sites (points, 16 at most)", points))
        self.addParameter(QgsProcessingParameterNumber("REDUCE_BY", "Darker by (%)", number, 30, False, 0, 100))
        numeric = QgsProcessingParameterField.DataType.Numeric
        field = QgsProcessingParameterField("REDUCE_FIELD", "Or by this field (%)", None, "SITES", numeric, False, True)
        self.addParameter(field)
        self.add_measure(MEASURES)
        cut = QgsProcessingParameterNumber("MAX_CUT", "Cut of a light, at most (%)", number, 80, False, 0, 100)
        self.addParameter(cut)
        self.addParameter(QgsProcessingParameterFeatureSource("AREA", "Dim only inside", kinds, None, True))
        self.addParameter(QgsProcessingParameterFeatureSource("PROTECT", "Leave alone", kinds, None, True))
        self.addParameter(QgsProcessingParameterBoolean("KEEP", "Keep the plan at the server", False))
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Part of the light that goes"))
        report = QgsProcessingParameterFileDestination("REPORT", "Report", "HTML (*.html)", None, True)
        self.addParameter(report)
        self.addOutput(QgsProcessingOutputString("PLAN", "Id of the plan, which other algorithms take as scenario"))
        self.addOutput(QgsProcessingOutputNumber("FLUX_REMOVED_PERCENT", "Light that goes (%)"))
        self.addOutput(QgsProcessingOutputNumber("SITES_MET", "Sites that get what they want"))
        self.add_common()

    def ask(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Posts the plan, waits for it, and fetches its raster."""
        server, scene = self.server(parameters, context), self.scene(parameters, context)
        body = {
            "method": "target",
            "max_cut": self.parameterAsDouble(parameters, "MAX_CUT", context) / 100,
            "sites": self._sites(parameters, context),
        }
        protected = self._protected(server, scene, parameters, context, feedback)
        if protected is not None:
            body["protect"] = protected
        keep = self.parameterAsBool(parameters, "KEEP", context)
        query = {**self.query(parameters, context), "keep": "on" if keep else "off"}
        answer = server.post(server.scene_url(scene, "/plans", query), body, feedback)
        plan = answer.json()
        for site in plan["sites"]:
            warn_of(site, feedback.pushInfo)
            target = site.get("target") or {}
            if target.get("why_not"):
                feedback.pushWarning(target["why_not"])
        raster = server.get(server.url(f"/api/v1/plans/{plan['id']}.tif"), feedback)
        path = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        write_raster(path, raster.body)
        styles.style_file(path, "plan")
        styles.style_on_load(context, path, "plan", name="What to dim: part of the light that goes")
        results = {
            "OUTPUT": path,
            "PLAN": plan["id"],
            "FLUX_REMOVED_PERCENT": 100 * plan["flux_removed_share"],
            "SITES_MET": sum(bool(site["target"]["is_met"]) for site in plan["sites"]),
        }
        report = self.parameterAsFileOutput(parameters, "REPORT", context)
        if report:
            link = f"{server.address}/#scene={scene}&scenario={plan['id']}" if keep else ""
            Path(report).write_text(reports.of_plan(plan, link), encoding="utf-8")
            results["REPORT"] = report
        if keep and answer.owner:
            feedback.pushInfo(f"The secret that lets its owner remove the plan (Skyglow-Owner): {answer.owner}")
        feedback.pushInfo(
            f"{plan['dimmed_pixels']} pixels are dimmed; {results['FLUX_REMOVED_PERCENT']:.2f} % of the light goes."
        )
        return results

    def _sites(self, parameters: dict[str, Any], context: QgsProcessingContext) -> list[dict[str, Any]]:
        source = self.parameterAsSource(parameters, "SITES", context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, "SITES"))
        transform = to_wgs84(source.sourceCrs(), context)
        field = self.parameterAsString(parameters, "REDUCE_FIELD", context)
        usual_percent = self.parameterAsDouble(parameters, "REDUCE_BY", context)
        measure = self.measure(parameters, context)
        sites = []
        for feature in source.getFeatures():
            if not feature.hasGeometry():
                continue
            at = transform.transform(point_of(feature.geometry()))
            percent = feature[field] if field else usual_percent
            if not isinstance(percent, (int, float)):
                raise QgsProcessingException(f"A site has no number in its field {field}.")
            sites.append({"lat": at.y(), "lon": at.x(), "measure": measure, "reduce_by": percent / 100})
        if not 1 <= len(sites) <= MAX_SITES:
            raise QgsProcessingException(
                f"The layer has {len(sites)} sites; a plan takes 1 to {MAX_SITES}. Select those that you mean, "
                "and choose “Selected features only”."
            )
        return sites

    def _protected(
        self,
        server: Server,
        scene: str,
        parameters: dict[str, Any],
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback,
    ) -> dict[str, Any] | None:
        area = self.parameterAsSource(parameters, "AREA", context)
        protect = self.parameterAsSource(parameters, "PROTECT", context)
        if area is None and protect is None:
            return None
        described = server.get(server.scene_url(scene, ""), feedback).json()
        parts = []
        if area is not None:
            inside = areas.united([outline for _, outline in areas.polygons(area, context)])
            parts.append(areas.all_but(inside, described["bounds"]))
        if protect is not None:
            parts.append(areas.united([outline for _, outline in areas.polygons(protect, context)]))
        if all(part.isEmpty() for part in parts):
            # The area holds all of the scene.
            return None
        whole = areas.fitting([areas.united(parts)], described["pixel_size_m"], feedback)[0]
        return areas.geojson(whole)
