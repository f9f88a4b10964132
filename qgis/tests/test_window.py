"""The plugin in a window of QGIS on a screen of memory (Xvfb): what `gui.py` saw there."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import unittest
from pathlib import Path
from typing import Any, ClassVar

from running import PLACE, PROFILE, api, environment


class Window(unittest.TestCase):
    said: ClassVar[dict[str, Any]]

    @classmethod
    def setUpClass(cls) -> None:
        said = PROFILE / "said.json"
        own = {**environment(), "SKYGLOW_QGIS_SAID": str(said)}
        profiles = own["QGIS_CUSTOM_CONFIG_PATH"]
        own.pop("QT_QPA_PLATFORM", None)
        qgis = shutil.which("qgis.bin") or "qgis"
        script = str(Path(__file__).with_name("gui.py"))
        command = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 1400x900x24", qgis, "--noversioncheck"]
        command += ["--nologo", "--profiles-path", profiles, "--code", script]
        run = subprocess.run(command, env=own, capture_output=True, text=True, timeout=300, check=False)
        assert said.exists(), run.stdout + run.stderr
        cls.said = json.loads(said.read_text())
        assert "failed" not in cls.said, cls.said["failed"] + run.stderr

    def test_a_click_shows_the_sky_there(self) -> None:
        """The place is the clicked one to a pixel of the screen, and the numbers are the API's."""
        self.assertTrue(self.said["tool"] and self.said["mark"])
        latitude_deg, longitude_deg = self.said["place"]
        self.assertLess(abs(latitude_deg - PLACE[0]), self.said["pixel_deg"])
        self.assertLess(abs(longitude_deg - PLACE[1]), self.said["pixel_deg"])
        sky = api("/sky", {"lat": latitude_deg, "lon": longitude_deg})["sky"]
        self.assertIn(f"{sky['zenith_total_brightness_mag_arcsec2']:.2f} mag/arcsec²", self.said["headline"])
        self.assertIn(f"Bortle {sky['bortle_class']}", self.said["headline"])
        self.assertIn(f"{100 * sky['ratio_to_natural']:.0f} %", self.said["details"])
        self.assertEqual(self.said["scenes"], ["demo"])
        self.assertGreaterEqual(min(self.said["picture"]), 240)

    def test_a_time_has_its_own_sky(self) -> None:
        """The numbers are those of the time, with its stars, and the viewer's address names it."""
        headline, details, viewer = self.said["at_time"]
        latitude_deg, longitude_deg = self.said["place"]
        query = {"lat": latitude_deg, "lon": longitude_deg, "time": "2026-08-12T23:00:00Z"}
        answer = api("/sky", query)
        self.assertIn(f"{answer['sky']['zenith_total_brightness_mag_arcsec2']:.2f} mag/arcsec²", headline)
        self.assertIn(f"{answer['night_sky']['stars']['visible']} stars", details)
        place = f"#scene=demo&lat={latitude_deg:.5f}&lon={longitude_deg:.5f}"
        self.assertEqual(viewer, f"{os.environ['SKYGLOW_URL']}/{place}&time=2026-08-12T23:00Z")

    def test_the_influence_layer_has_its_legend(self) -> None:
        """The layer's classes are parts of this sky."""
        latitude_deg, longitude_deg = self.said["place"]
        total = api("/influence", {"lat": latitude_deg, "lon": longitude_deg, "limit": 0})["total"]
        value, label = self.said["legend"][-1]
        self.assertAlmostEqual(value / total, 0.01, 9)
        self.assertEqual(label, "0.3–1 %")
        self.assertIn(f"{latitude_deg:.4f}", self.said["influence"])

    def test_a_plan_is_a_styled_layer(self) -> None:
        """The algorithm's raster comes into the project under its name, with its classes, and its site is met."""
        plan = self.said["plan"]
        self.assertEqual(plan["name"], "What to dim: part of the light that goes")
        self.assertGreater(len(plan["legend"]), 3)
        self.assertEqual(plan["SITES_MET"], 1)
        self.assertTrue(0 < plan["FLUX_REMOVED_PERCENT"] < 30)

    def test_a_place_outside_says_so(self) -> None:
        """There is no old picture, and no button that would do nothing."""
        headline, has_no_picture, has_influence = self.said["outside"]
        self.assertIn("outside the scene", headline)
        self.assertTrue(has_no_picture)
        self.assertFalse(has_influence)

    def test_unloading_takes_all_away(self) -> None:
        """The plugin can be switched off, and its provider goes."""
        self.assertTrue(self.said["unloaded"] and self.said["gone"])
        self.assertEqual(len(self.said["algorithms"]), 6)
