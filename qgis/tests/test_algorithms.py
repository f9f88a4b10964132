"""Each algorithm by qgis_process, against what the server answers to the same question."""

from __future__ import annotations

import json
import math
from pathlib import Path
from xml.etree import ElementTree

from osgeo import gdal
from running import PLACE, POINT, SERVER, WithFolder, api, point, qgis_process, rectangle

gdal.UseExceptions()
HERE = {"lat": PLACE[0], "lon": PLACE[1]}
LOCARNO = rectangle(8.7, 46.1, 8.92, 46.25)
LUGANO = rectangle(8.92, 45.95, 9.05, 46.1)


def limits(raster: str) -> list[float]:
    """The limits of the classes in the style beside a raster."""
    root = ElementTree.parse(Path(raster).with_suffix(".qml")).getroot()
    return [float(item.get("value", "nan")) for item in root.iter("item") if item.get("value") != "inf"]


class Sky(WithFolder):
    def test_points_have_the_numbers_of_the_api(self) -> None:
        """More points than a batch, one outside the scene, one without a place: in order, each as the API has it."""
        places = [(44 + 0.0175 * i, 6 + 0.025 * i) for i in range(203)]
        features = [({"number": i}, point(*place)) for i, place in enumerate(places)]
        features[7] = ({"number": 7}, None)
        features[201] = ({"number": 201}, point(10, 100))
        layer = self.geojson("points.geojson", features)
        results = self.run_algorithm("sky", INPUT=layer, OUTPUT=str(self.folder / "skies.geojson"))
        found = self.output(results["OUTPUT"])
        self.assertEqual([row["number"] for row in found], list(range(203)))
        for number in (0, 100, 200, 202):
            lat, lon = places[number]
            expected = api("/sky", {"lat": round(lat, 9), "lon": round(lon, 9)})
            for name in ("zenith_total_brightness_mag_arcsec2", "ratio_to_natural", "horizontal_illuminance_lx"):
                self.assertAlmostEqual(found[number][name] / expected["sky"][name], 1, 6, f"{number} {name}")
            self.assertEqual(found[number]["bortle_class"], expected["sky"]["bortle_class"])
            self.assertIsNone(found[number]["problem"])
        self.assertIn("no geometry", found[7]["problem"])
        self.assertIn("outside the scene", found[201]["problem"])
        self.assertIsNone(found[201]["bortle_class"])

    def test_projected_points_at_a_time(self) -> None:
        """A layer in metres is asked about in degrees, and a time and assumptions reach the server."""
        layer = self.folder / "swiss.geojson"
        metres = {"type": "Point", "coordinates": [2_690_000, 1_150_000]}
        crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::2056"}}
        feature = {"type": "Feature", "properties": {}, "geometry": metres}
        layer.write_text(json.dumps({"type": "FeatureCollection", "crs": crs, "features": [feature]}))
        asked = {
            "TIME": "2026-08-12T23:00:00Z",
            "TURBIDITY": 4,
            "LAMP": "hps",
            "QUERY": "response=scotopic&solar_flux=150",
        }
        output = str(self.folder / "skies.geojson")
        (found,) = self.output(self.run_algorithm("sky", INPUT=layer, OUTPUT=output, **asked)["OUTPUT"])
        # By the approximate formulas of swisstopo, good to a metre.
        place = {"lat": 46.495262, "lon": 8.610983}
        expected = api(
            "/sky",
            {**place, "time": asked["TIME"], "turbidity": 4, "lamp": "hps", "response": "scotopic", "solar_flux": 150},
        )
        for name in ("zenith_total_brightness_mag_arcsec2", "ratio_to_natural"):
            self.assertAlmostEqual(found[name] / expected["sky"][name], 1, 3, name)


class Rasters(WithFolder):
    def test_influence_adds_up(self) -> None:
        """The pixels add up to the sky's own value, and the colours' limits are parts of that."""
        output = str(self.folder / "influence.tif")
        results = self.run_algorithm("influence", POINT=POINT, MEASURE="horizontal", OUTPUT=output)
        expected = api("/influence", {**HERE, "measure": "horizontal", "limit": 0})
        self.assertEqual((results["TOTAL"], results["UNIT"]), (expected["total"], "lx"))
        band = gdal.Open(output).ReadAsArray()
        self.assertAlmostEqual(float(band[~(band != band)].astype("f8").sum()) / expected["total"], 1, 5)
        classes = limits(output)
        self.assertAlmostEqual(classes[-1] / expected["total"], 0.01, 9)
        self.assertEqual(classes, sorted(classes))

    def test_brightness_as_file_and_as_tiles(self) -> None:
        """The file has the zenith of a place, cloud-optimized; the tiles' source names the server's tiles."""
        output = str(self.folder / "brightness.tif")
        self.run_algorithm("brightness", OUTPUT=output)
        raster = gdal.Open(output)
        self.assertEqual(raster.GetMetadata("IMAGE_STRUCTURE")["LAYOUT"], "COG")
        west, width, _, north, _, height = raster.GetGeoTransform()
        column, row = int((PLACE[1] - west) / width), int((PLACE[0] - north) / height)
        at = {"lat": north + (row + 0.5) * height, "lon": west + (column + 0.5) * width}
        expected = api("/sky", at)["sky"]["zenith_luminance_cd_m2"]
        value = float(raster.ReadAsArray(column, row, 1, 1)[0, 0])
        self.assertLess(abs(value / expected - 1), 0.02)
        natural = api("/tiles/brightness/tilejson.json")["natural"]
        self.assertTrue(math.isclose(limits(output)[0], 0.01 * natural, rel_tol=1e-6))
        tiles = self.run_algorithm("brightness", FORM="tiles")["TILES"]
        self.assertIn(f"url={SERVER}/api/v1/scenes/demo/tiles/brightness/", tiles)

    def test_brightness_of_another_measure(self) -> None:
        """Light on the ground is coloured by that of the natural sky, not by what the zenith has."""
        output = str(self.folder / "horizontal.tif")
        self.run_algorithm("brightness", MEASURE="horizontal", OUTPUT=output)
        said = api("/tiles/brightness/tilejson.json", {"measure": "horizontal"})
        raster = gdal.Open(output)
        self.assertEqual((raster.GetRasterBand(1).GetUnitType(), said["unit"]), ("lx", "lx"))
        for number, limit in enumerate(limits(output)):
            self.assertTrue(math.isclose(limit, 0.01 * 2**number * said["natural"], rel_tol=1e-6), number)
        tiles = self.run_algorithm("brightness", MEASURE="horizontal", FORM="tiles")["TILES"]
        self.assertIn("measure%3Dhorizontal", tiles)

    def test_another_format_is_refused(self) -> None:
        """The server's GeoTIFF is not written under another name."""
        self.assertIn(".tif", self.failure("influence", POINT=POINT, OUTPUT=str(self.folder / "influence.png")))


class Vectors(WithFolder):
    def test_shares_come_back_on_the_layer(self) -> None:
        """Each polygon keeps its fields and has its own share, whatever the answer's order; heights do not count."""
        high = {**LUGANO, "coordinates": [[[*at, 300] for at in LUGANO["coordinates"][0]]]}
        far = rectangle(100, 10, 101, 11)
        layer = self.geojson("areas.geojson", [({"id": 5}, far), ({"id": 6}, high), ({"id": 7}, LOCARNO)])
        output = str(self.folder / "shares.geojson")
        results = self.run_algorithm("shares", INPUT=layer, POINT=POINT, OUTPUT=output)
        found = {row["id"]: row for row in self.output(output)}
        for number, area in ((6, LUGANO), (7, LOCARNO)):
            expected = api("/influence", {**HERE, "limit": 0}, {"boundary": area})["boundary"]
            self.assertAlmostEqual(found[number]["share_percent"], 100 * expected["share"], 6)
            self.assertEqual(found[number]["pixels"], expected["pixels"])
        self.assertEqual(found[5]["share_percent"], 0)
        self.assertAlmostEqual(sum(row["share_percent"] for row in found.values()) + results["OUTSIDE"], 100, 6)

    def test_outlines_of_many_corners_are_simplified(self) -> None:
        """An outline of more corners than the server takes has the share of the smooth one."""
        ring = [
            [
                8.8 + (0.1 + 1e-7 * (i % 2)) * math.cos(math.tau * i / 120_000),
                46.17 + 0.07 * math.sin(math.tau * i / 120_000),
            ]
            for i in range(120_000)
        ]
        detailed = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
        smooth = {"type": "Polygon", "coordinates": [[*ring[::400], ring[0]]]}
        layer = self.geojson("detailed.geojson", [({}, detailed)])
        output = str(self.folder / "shares.geojson")
        self.run_algorithm("shares", INPUT=layer, POINT=POINT, OUTPUT=output)
        expected = api("/influence", {**HERE, "limit": 0}, {"boundary": smooth})["boundary"]
        self.assertLess(abs(self.output(output)[0]["share_percent"] / (100 * expected["share"]) - 1), 0.02)

    def test_darker_places_are_those_of_the_api(self) -> None:
        """The places, in their order, where the API has them."""
        output = str(self.folder / "darker.geojson")
        self.run_algorithm("darker", POINT="8.79,46.17 [EPSG:4326]", WITHIN_KM=40, LIMIT=3, OUTPUT=output)
        expected = api("/darker", {"lat": 46.17, "lon": 8.79, "within_km": 40, "limit": 3})["places"]
        found = json.loads(Path(output).read_text())["features"]
        self.assertEqual(len(found), 3)
        for feature, place in zip(found, expected):
            self.assertEqual(feature["properties"]["rank"], place["rank"])
            self.assertAlmostEqual(feature["properties"]["gain_mag"], place["gain_mag"], 9)
            self.assertEqual(feature["properties"]["nearest_place"], place["nearest_place"]["name"])
            longitude_deg, latitude_deg = feature["geometry"]["coordinates"]
            self.assertAlmostEqual(latitude_deg, place["latitude_deg"], 6)
            self.assertAlmostEqual(longitude_deg, place["longitude_deg"], 6)


class Plans(WithFolder):
    def setUp(self) -> None:
        super().setUp()
        self.sites = self.geojson("sites.geojson", [({"want": 4}, point(*PLACE))])

    def test_a_plan_is_that_of_the_api(self) -> None:
        """Its raster has what goes, its report the site, its id is known to the server."""
        output, report = str(self.folder / "plan.tif"), str(self.folder / "plan.html")
        results = self.run_algorithm("plan", SITES=self.sites, REDUCE_BY=30, OUTPUT=output, REPORT=report)
        body = {"method": "target", "max_cut": 0.8, "sites": [{**HERE, "measure": "zenith", "reduce_by": 0.3}]}
        expected = api("/plans", {"keep": "off"}, body)
        self.assertEqual(results["PLAN"], expected["id"])
        self.assertEqual(results["SITES_MET"], 1)
        self.assertAlmostEqual(results["FLUX_REMOVED_PERCENT"], 100 * expected["flux_removed_share"], 9)
        band = gdal.Open(output).ReadAsArray()
        self.assertEqual(int((band > 0).sum()), expected["dimmed_pixels"])
        words = Path(report).read_text()
        self.assertIn("30.0 %", words)
        self.assertIn("illustrative", words)
        after = api("/sky", {**HERE, "scenario": results["PLAN"]})["sky"]["zenith_luminance_cd_m2"]
        before = api("/sky", HERE)["sky"]["zenith_luminance_cd_m2"]
        self.assertAlmostEqual(after / before, 0.7, 3)

    def test_lights_go_only_inside_the_area(self) -> None:
        """With an area, all that goes lies in it; what is protected in it stays."""
        area = self.geojson("area.geojson", [({}, LOCARNO)])
        protect = self.geojson("protect.geojson", [({}, rectangle(8.7, 46.1, 8.8, 46.25))])
        output = str(self.folder / "plan.tif")
        asked = {"SITES": self.sites, "REDUCE_FIELD": "want", "MAX_CUT": 90, "OUTPUT": output}
        results = self.run_algorithm("plan", AREA=area, PROTECT=protect, **asked)
        raster = gdal.Open(output)
        west, width, _, north, _, height = raster.GetGeoTransform()
        rows, columns = (raster.ReadAsArray() > 0).nonzero()
        self.assertGreater(len(rows), 10)
        for row, column in zip(rows, columns):
            self.assertTrue(8.8 <= west + (column + 0.5) * width <= 8.92, column)
            self.assertTrue(46.1 <= north + (row + 0.5) * height <= 46.25, row)
        self.assertEqual(results["SITES_MET"], 0)
        everything = self.geojson("everything.geojson", [({}, rectangle(3, 42, 16, 50))])
        results = self.run_algorithm("plan", AREA=everything, **asked)
        self.assertEqual(results["SITES_MET"], 1)

    def test_too_many_sites_are_refused(self) -> None:
        """17 sites are one too many, and what to do is said."""
        many = self.geojson("many.geojson", [({}, point(46 + 0.02 * i, 8.6)) for i in range(17)])
        said = self.failure("plan", SITES=many, OUTPUT=str(self.folder / "plan.tif"))
        self.assertIn("17 sites", said)


class Problems(WithFolder):
    def test_problems_say_what_to_do(self) -> None:
        """No server, no such scene, a place outside, a parameter out of range: each in words that help."""
        output = str(self.folder / "x.tif")
        asked = {"POINT": POINT, "OUTPUT": output}
        self.assertIn("Is the server running", self.failure("influence", SERVER="http://127.0.0.1:9", **asked))
        self.assertIn("It has: demo.", self.failure("influence", SCENE="atlantis", **asked))
        outside = {**asked, "POINT": "100,10 [EPSG:4326]"}
        self.assertIn("Choose a place within the scene", self.failure("influence", **outside))
        self.assertIn("Check the API key", self.failure("influence", key="nobodys", **asked))
        said = self.failure("influence", QUERY="turbidity=50", **asked)
        self.assertIn("allowed: 1.5 to 6", said)
        self.assertNotIn("Traceback", said)

    def test_every_algorithm_has_help(self) -> None:
        """qgis_process describes each of them."""
        for name in ("sky", "influence", "brightness", "plan", "shares", "darker"):
            said = qgis_process("help", f"skyglow:{name}")
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertIn("SCENE", said.stdout)
