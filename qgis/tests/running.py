"""What the tests share: qgis_process with the plugin, and the server's own answers to compare with.

``scripts/qgis_plugin.sh`` sets ``SKYGLOW_URL`` (a server with the demo), ``SKYGLOW_QGIS_PROFILE`` (an empty folder) and
``SKYGLOW_QGIS_PLUGINS`` (the folder that holds the plugin as it is installed).
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path
from typing import Any
from urllib.parse import urlencode
from urllib.request import Request, urlopen

SERVER = os.environ["SKYGLOW_URL"]
PROFILE = Path(os.environ["SKYGLOW_QGIS_PROFILE"])
PLUGINS = os.environ["SKYGLOW_QGIS_PLUGINS"]
# Debian's own script puts an option before the command that qgis_process does not know.
QGIS_PROCESS = shutil.which("qgis_process.bin") or "qgis_process"
PLACE = (46.53, 8.61)
POINT = f"{PLACE[1]},{PLACE[0]} [EPSG:4326]"


def environment(key: str = "") -> dict[str, str]:
    """The environment of a QGIS with the plugin and the server's address, and with nothing of this user's."""
    profile = PROFILE / (key or "without-key")
    settings = profile / "profiles/default/QGIS/QGIS3.ini"
    settings.parent.mkdir(parents=True, exist_ok=True)
    if not settings.exists():
        own_settings = f"[skyglow]\naddress={SERVER}\nkey={key}\n\n[PythonPlugins]\nskyglow=true\nprocessing=true\n"
        settings.write_text(own_settings)
    own = {"QGIS_CUSTOM_CONFIG_PATH": str(profile), "QGIS_PLUGINPATH": PLUGINS, "PYTHONDONTWRITEBYTECODE": "1"}
    return {**os.environ, **own}


def qgis_process(*arguments: str, key: str = "") -> subprocess.CompletedProcess[str]:
    """Runs qgis_process without a window."""
    command = [QGIS_PROCESS, *arguments]
    without_window = {**environment(key), "QT_QPA_PLATFORM": "offscreen"}
    return subprocess.run(command, env=without_window, capture_output=True, text=True, timeout=900, check=False)


def api(path: str, query: dict[str, Any] | None = None, body: Any = None) -> Any:
    """What the server itself answers."""
    url = f"{SERVER}/api/v1/scenes/demo{path}" + (f"?{urlencode(query)}" if query else "")
    data = None if body is None else json.dumps(body).encode()
    with urlopen(Request(url, data), timeout=120) as answer:
        return json.loads(answer.read())


class WithFolder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self) -> None:
        own = tempfile.TemporaryDirectory()
        self.addCleanup(own.cleanup)
        self.folder = Path(own.name)

    def run_algorithm(self, name: str, **parameters: Any) -> dict[str, Any]:
        """The results of an algorithm."""
        run = qgis_process("run", f"skyglow:{name}", "--json", *(f"--{key}={parameters[key]}" for key in parameters))
        self.assertEqual(run.returncode, 0, run.stderr + run.stdout)
        return json.loads(run.stdout)["results"]

    def failure(self, name: str, key: str = "", **parameters: Any) -> str:
        """What an algorithm says that cannot do what it was asked."""
        asked = [f"--{parameter}={value}" for parameter, value in parameters.items()]
        run = qgis_process("run", f"skyglow:{name}", *asked, key=key)
        self.assertNotEqual(run.returncode, 0, run.stdout)
        return run.stderr + run.stdout

    def geojson(self, name: str, features: list[tuple[dict[str, Any], dict[str, Any] | None]]) -> str:
        """A file of features: properties and geometry of each."""
        path = self.folder / name
        made = [{"type": "Feature", "properties": own, "geometry": geometry} for own, geometry in features]
        path.write_text(json.dumps({"type": "FeatureCollection", "features": made}))
        return str(path)

    def output(self, path: str) -> list[dict[str, Any]]:
        """The properties of the features of a GeoJSON file."""
        return [feature["properties"] for feature in json.loads(Path(path).read_text())["features"]]


def point(latitude_deg: float, longitude_deg: float) -> dict[str, Any]:
    return {"type": "Point", "coordinates": [longitude_deg, latitude_deg]}


def rectangle(west: float, south: float, east: float, north: float) -> dict[str, Any]:
    ring = [[west, south], [east, south], [east, north], [west, north], [west, south]]
    return {"type": "Polygon", "coordinates": [ring]}
