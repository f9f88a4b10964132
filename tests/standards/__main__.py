"""Validates a running server with the demo by the standards that it claims: scripts/standards.sh starts it.

Arguments: the server's address, the folder of schemas, a folder for files, and GeoTIFFs that are judged too.
"""

import sys
from pathlib import Path

import catalogue
import common_and_edr
import files
import processes
import tiles_and_maps
from api import POINT, Api
from report import Report
from requirements_of import CLASSES, COVERED_BY
from schemas import Schemas

url, schemas_folder, files_folder, *exported = sys.argv[1:]
api, schemas, report = Api(url), Schemas(Path(schemas_folder)), Report()
folder = Path(files_folder)
folder.mkdir(parents=True, exist_ok=True)
assert common_and_edr and processes and tiles_and_maps, "they register their checks"


def declared() -> None:
    """Every class that the server declares is checked here, and no other."""
    spec = "www.opengis.net/spec/"
    said = {name.partition(spec)[2] for name in api.json("/conformance")["conformsTo"]}
    assert said == set(CLASSES) | set(COVERED_BY), said ^ (set(CLASSES) | set(COVERED_BY))


report.run("OGC conformance", "classes declared and checked", declared)
for of_class, checks in CLASSES.items():
    for name, check in checks:
        report.run(of_class, name, lambda check=check: check(api, schemas))

# Planted faults: a schema must find what it is there for.
collection = api.collections()[0]
coverage = api.json("/collections/demo/position", coords=POINT)
matrix_set = api.json("/tileMatrixSets/WebMercatorQuad")
for path, document, member in (
    ("edr/collections/collection.yaml", collection, "data_queries"),
    ("common-geodata/common-geodata/collectionDesc.yaml", collection, "links"),
    ("covjson/coveragejson.json", coverage, "domain"),
    ("tms/tileMatrixSet.json", matrix_set, "tileMatrices"),
    ("processes/process.yaml", api.json("/processes/plan"), "version"),
):
    broken = {name: value for name, value in document.items() if name != member}
    report.finds(
        "JSON schemas", f"{path} without {member}", lambda path=path, broken=broken: schemas.check(path, broken)
    )

catalogue.check(api, schemas, report)
files.cogs(api, report, folder)
files.exported(report, [Path(path) for path in exported])
files.netcdf(api, report, folder)
report.print()
sys.exit(1 if report.faults else 0)
