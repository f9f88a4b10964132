#!/usr/bin/env python3
"""Writes docs/measurements.md: what this version does on this machine, each row with its command.

Usage: scripts/measurements.py [--quick] [--only PART,...] [--out FILE]
Everything in at most 25 minutes, with --quick in at most 5. A part that fails is left out and said so on stderr. A full run
brings the two tables of README.md up to date as well. Needs Python 3 and what `make serve` needs; wrk for the load.
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import time
import tomllib
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORK = ROOT / "target" / "measurements"
DATA = WORK / "data"
PROGRAM = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "skyglow"
LAB = "cargo run --release -p skyglow-lab --"
LIMITS = {"mean": 1.0, "p99": 5.0, "zenith": 0.5, "horizontal": 0.5}


class Row:
    """One figure. README.md shows those that have a key."""

    def __init__(self, what, value, command, key=None):
        self.what, self.value, self.command, self.key = what, value, command, key


def run(command, **options):
    """The output of a command, which also goes to a log in WORK."""
    print(f"== {command}", file=sys.stderr)
    started = time.monotonic()
    done = subprocess.run(command, shell=True, cwd=ROOT, text=True, capture_output=True, **options)
    name = re.sub(r"[^a-z0-9]+", "-", command.lower())[:80]
    (WORK / f"{name}.log").write_text(done.stdout + done.stderr)
    print(f"   {time.monotonic() - started:.0f} s", file=sys.stderr)
    if done.returncode:
        raise RuntimeError(f"{command}: status {done.returncode}\n{done.stderr[-800:]}")
    return done.stdout


def found(pattern, text):
    match = re.search(pattern, text)
    if not match:
        raise RuntimeError(f"no {pattern!r} in the output")
    return match.groups()


def whole(number):
    return f"{float(number):,.0f}".replace(",", " ")


def ms(value):
    value = float(value)
    return f"{value:.2f} ms" if value < 10 else f"{value:.0f} ms"


def percent(value):
    value = abs(float(value))
    return f"{value:.2f} %" if value < 10 else f"{value:.0f} %"


def classes(quick):
    """Class skies against the stored reference solutions."""
    command = f"{LAB} class-accuracy precomputed tests/reference/classes --every"
    skies = []
    for line in run(command).split("# the worst")[0].splitlines():
        match = re.match(r"\S.*?\s+(?:garstang|lambert|horizon|oblique)\s+(.*)", line)
        if match:
            skies.append([abs(float(part)) for part in match.group(1).split()[:4]])
    if not skies:
        raise RuntimeError("no skies in the output")
    columns = dict(zip(LIMITS, zip(*skies)))
    good = sum(all(v <= limit for v, limit in zip(sky, LIMITS.values())) for sky in skies)
    yield Row(f"class skies, mean error (limit {LIMITS['mean']} %)", percent(statistics.mean(columns["mean"])), command, "mean")
    yield Row("99th percentile over directions (limit 5 %)", percent(statistics.mean(columns["p99"])), command, "p99")
    yield Row("zenith (limit 0.5 %)", percent(statistics.mean(columns["zenith"])), command, "zenith")
    yield Row("horizontal illuminance (limit 0.5 %)", percent(statistics.mean(columns["horizontal"])), command, "horizontal")
    yield Row("class skies within all four limits", f"{good} of {len(skies)}", command, "within")


def bench(quick):
    """Run time against error, from the bench's own JSON."""
    folder = WORK / "bench"
    reference = "".join(f" --reference {file.relative_to(ROOT)}" for file in sorted((ROOT / "tests/reference").glob("*.json")))
    command = f"skyglow bench --packs precomputed --out target/measurements/bench{' --quick' if quick else reference}"
    run(command.replace("skyglow", str(PROGRAM), 1) + f" --data {DATA}")
    report = json.loads((folder / "bench.json").read_text())
    times = [row for row in report["run_times"] if row["skipping"] and row["packs"] == 1]
    for executor in dict.fromkeys(row["executor"] for row in times):
        own = [row for row in times if row["executor"] == executor]
        largest = max(row["basis_count"] for row in own)
        own = [row for row in own if row["basis_count"] == largest]
        for scene, noun in [("cells", "lit cells"), ("raster", "lit pixels")]:
            rows = [row for row in own if row["scene"] == scene]
            if rows:
                row = max(rows, key=lambda row: row["lit_sources"])
                what = f"{executor}: a panorama of {whole(row['lit_sources'])} {noun}, {largest} functions, median"
                yield Row(what, ms(row["median_ms"]), command, f"{executor}-{scene}")
                if scene == "cells":
                    yield Row(f"{executor}: the same, times faster than the direct sum", whole(row["times_direct_sum"]), command)
        batches = [row for row in report["batches"] if row["executor"] == executor and row["basis_count"] == largest]
        batches = [row for row in batches if row["scene"] == "cells"]
        if batches:
            row = max(batches, key=lambda row: (row["callers"], row["lit_sources"]))
            what = f"{executor}: panoramas of {whole(row['lit_sources'])} lit cells a second, {row['callers']} callers at once"
            yield Row(what, whole(row["median_panoramas_per_s"]), command)
    errors = [row for row in report["errors"] if row["executor"] == "cpu"]
    most = max((row["basis_count"] for row in errors), default=0)
    for row in (row for row in errors if row["basis_count"] == most and row["directions"] > 1):
        what = f"{row['scene']}, T = {row['turbidity']:g}: mean error; 99th percentile"
        yield Row(what, f"{percent(100 * row['mean'])}; {percent(100 * row['p99'])}", command)


def speed(quick):
    """A place of the demo, pass by pass, beside the direct sum."""
    command = f"{LAB} speed DATA precomputed demo 46.17 8.79 2.5"
    text = run(command.replace("DATA", str(DATA)))
    grid_ms, cells = found(r"polar grid: ([\d.]+) ms, (\d+) lit cells", text)
    yield Row(f"polar grid of Locarno in the demo, {whole(cells)} lit cells", ms(grid_ms), command)
    for executor, total in re.findall(r"^(\w+): ([\d.]+) ms, median", text, re.M):
        yield Row(f"{executor}: a panorama from it", ms(total), command)
    (hours,) = found(r"so a panorama in ([\d.]+) h", text)
    yield Row("the direct sum of the same sky, first order, scaled from 16 directions", f"{hours} h", command)


class Server:
    """A server of its own on a free port."""

    def __enter__(self):
        log = (WORK / "server.log").open("w+")
        command = [PROGRAM, "serve", "--listen", "127.0.0.1:0", "--data", DATA, "--packs", "precomputed", "--device", "cpu"]
        self.started = time.monotonic()
        self.process = subprocess.Popen([str(part) for part in command], cwd=ROOT, stdout=log, stderr=log)
        self.base = None
        while time.monotonic() < self.started + 180:
            port = re.search(r"http://127\.0\.0\.1:(\d+)", (WORK / "server.log").read_text())
            try:
                if port:
                    self.base = f"http://127.0.0.1:{port.group(1)}"
                    self.get("/readyz")
                    self.ready_s = time.monotonic() - self.started
                    return self
            except OSError:
                pass
            time.sleep(0.02)
        raise RuntimeError("the server is not ready after three minutes")

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(timeout=60)

    def get(self, path):
        started = time.monotonic()
        with urllib.request.urlopen(self.base + path, timeout=60) as answer:
            answer.read()
        return 1e3 * (time.monotonic() - started)

    def most_memory_mb(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmHWM:\s+(\d+)", status).group(1)) / 1024


def http(quick):
    """Answers of a server on loopback, each for a new place of the demo."""
    command = "skyglow serve --device cpu"
    with Server():
        pass  # makes the demo and warms the disk
    with Server() as server:
        sky = "/api/v1/scenes/demo/{}?lat={:.3f}&lon={:.3f}&turbidity={}"
        server.get(sky.format("sky", 46.5, 8.6, 2.5))
        numbers, pictures, between = [], [], []
        for step in range(8 if quick else 30):
            place = (46.0 + 0.013 * step, 8.4 + 0.017 * step)
            numbers.append(server.get(sky.format("sky", *place, 2.5)))
            pictures.append(server.get(sky.format("panorama.png", *place, 2.5)))
            between.append(server.get(sky.format("sky", *place, 3)))
        yield Row("ready after start, six packs and the demo", f"{server.ready_s:.1f} s", command)
        yield Row("numbers of a sky at a new place, with terrain, one request after the other, median", ms(statistics.median(numbers)), command, "http")
        yield Row("its picture after that, median", ms(statistics.median(pictures)), command)
        yield Row("numbers between the packs' turbidities, median", ms(statistics.median(between)), command)
        yield Row("memory at its height", f"{whole(server.most_memory_mb())} MB", command)


def load(quick):
    """Throughput by wrk beside the server on the same cores."""
    if quick:
        return
    command = "scripts/load.sh 5"
    for line in run(command).splitlines():
        if line.startswith("{"):
            row = json.loads(line)
            if row.get("connections") == 16:
                what = f"{row['executor']}: {row['mix']}, answers a second, 16 connections"
                yield Row(what, whole(row["per_second"]), command)


def influence(quick):
    """Influence maps and plans over a made-up square of lights."""
    side, rounds = (700, 1) if quick else (1000, 10)
    command = f"{LAB} influence-times precomputed {side} {rounds}"
    text = run(command)
    for measure, pixels, first, _fastest, median in re.findall(
        r"^T 2\.5 (\w+).*? (\d+) pixels: ([\d.]+); ([\d.]+), ([\d.]+)", text, re.M
    ):
        key = "influence" if measure == "Zenith" else None
        yield Row(f"influence map, {measure.lower()}, {whole(pixels)} lit pixels, after the first of a place", ms(median), command, key)
        if key:
            yield Row("the first map of a place", ms(first), command)
    for sites, time_ms in re.findall(r"target plan of (\d+) site\(s\): ([\d.]+) \(", text):
        yield Row(f"target plan of {sites} site{'s' if sites != '1' else ''}, skies before and after included", ms(time_ms), command)


def brightness(quick):
    """The zenith at every place, beside panoramas of some."""
    places, count = (100_000, 40) if quick else (4_000_000, 200)
    command = f"{LAB} brightness DATA precomputed demo 2.5 on {places} {count}"
    text = run(command.replace("DATA", str(DATA)))
    columns, rows, seconds = found(r"(\d+) x (\d+) places.*?: ([\d.]+) s", text)
    (mean,) = found(r"error ([\d.]+) % mean", text)
    (times,) = found(r"all places by panoramas [\d.]+ s, (\d+) times as long", text)
    yield Row(f"brightness of {whole(int(columns) * int(rows))} places of the demo", f"{float(seconds):.1f} s", command, "brightness")
    yield Row("the same by panoramas, times as long", whole(times), command)
    yield Row("mean error of the zenith against those panoramas", percent(mean), command)


def pixels(quick):
    """Influences of single pixels against the sum over each alone."""
    if quick:
        return
    command = f"{LAB} influence-reference DATA precomputed demo 46.53 8.61 2.5 60"
    for measure, mean in re.findall(r"^(zenith|mean|horizontal|norm)\S*\s+([\d.]+)", run(command.replace("DATA", str(DATA))), re.M):
        yield Row(f"influence of single pixels, {measure}: mean error", percent(mean), command)


def solver(quick):
    """The solver of the later orders beside light traced forward."""
    if quick:
        return
    settings = "--turbidity 2 --distance-km 2,10,50 --band G --judge forward --paths 1500000 --seed 12"
    command = f"{LAB} multiple-vs-monte-carlo {settings}"
    for name, mean, noise in re.findall(
        r"^(T 2, lambert, [\d.]+ km)\s+n.*?mean\s+([\d.]+) %.*?MC noise\s+([\d.]+) %", run(command), re.M
    ):
        yield Row(f"solver and forward tracer, {name}: mean difference (the tracer's own noise)", f"{percent(mean)} ({percent(noise)})", command)


def stress(quick):
    """Checks that hunt for NaN, negative radiance, jumps and lost digits, each beside a planted fault."""
    if quick:
        return
    started = time.monotonic()
    file = WORK / "stress.json"
    run(f"scripts/stress.sh --out {file}")
    checks = json.loads(file.read_text())
    checks = checks if isinstance(checks, list) else next(v for v in checks.values() if isinstance(v, list))
    yield Row(f"stress suite, {len(checks)} checks", f"{time.monotonic() - started:.0f} s, none failed", "make stress")


PARTS = [
    ("Accuracy", [classes, pixels, solver]),
    ("Speed of a panorama, and errors by place", [bench, speed]),
    ("Server", [http, load]),
    ("Influences, plans and maps", [influence, brightness]),
    ("Robustness", [stress]),
]


def machine():
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    memory = re.search(r"MemTotal:\s+(\d+)", pathlib.Path("/proc/meminfo").read_text())
    name = cpu.group(1) if cpu else platform.machine()
    return f"{os.cpu_count()} cores of {name}, {round(int(memory.group(1)) / 2**20)} GiB of memory"


def header(quick):
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    git = lambda *words: subprocess.run(["git", *words], cwd=ROOT, text=True, capture_output=True).stdout.strip()
    changed = git("status", "--porcelain", "--", "server", "shaders", "precomputed")
    return "\n".join(
        [
            "# Measurements",
            "",
            f"Made by `make measurements{' QUICK=1' if quick else ''}`, by one version on one machine. Not edited by hand.",
            "",
            f"- Program: skyglow {version}, commit {git('rev-parse', '--short', 'HEAD')}{' with local changes' if changed else ''}",
            f"- Machine: {machine()}; load average {os.getloadavg()[0]:.1f} at the start",
            f"- Date: {datetime.date.today().isoformat()}",
            "",
            "`DATA` is a data folder with the demo scene. Errors are those of [section 16 of the model](model.md#error), against the",
            "[reference solution](model.md#reference). Earlier figures are in the [notebook](notebook/README.md).",
            "",
        ]
    )


def tables(parts):
    text = []
    for title, rows in parts:
        if rows:
            text += [f"## {title}", "", "| what | measured | command |", "|---|---|---|"]
            last = None
            for row in rows:
                command = "the same" if row.command == last else f"`{row.command}`"
                last = row.command
                text.append(f"| {row.what} | {row.value} | {command} |")
            text.append("")
    return "\n".join(text)


def update_readme(rows):
    """Replaces the last column of rows of README.md that end with a comment naming a key."""
    values = {row.key: row.value for row in rows if row.key}
    path = ROOT / "README.md"
    lines = path.read_text().splitlines()
    for at, line in enumerate(lines):
        match = re.match(r"(\|.*\|) [^|]*<!-- (\S+) --> \|$", line)
        if match and match.group(2) in values:
            lines[at] = f"{match.group(1)} {values[match.group(2)]} <!-- {match.group(2)} --> |"
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer and smaller, within five minutes")
    parser.add_argument("--only", help="parts to run, with commas between: " + ", ".join(f.__name__ for _, fs in PARTS for f in fs))
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs" / "measurements.md")
    options = parser.parse_args()
    WORK.mkdir(parents=True, exist_ok=True)
    head = header(options.quick)
    run("cargo build --release -p skyglow -p skyglow-lab")
    with Server():
        pass  # makes the demo
    chosen = options.only.split(",") if options.only else None
    parts, failed = [], []
    for title, functions in PARTS:
        rows = []
        for function in functions:
            if chosen and function.__name__ not in chosen:
                continue
            try:
                rows += function(options.quick)
            except Exception as error:  # one part less, and said so
                failed.append(function.__name__)
                print(f"!! {function.__name__}: {error}", file=sys.stderr)
        parts.append((title, rows))
    options.out.write_text(head + "\n" + tables(parts))
    if not (options.quick or chosen):
        update_readme([row for _, rows in parts for row in rows])
    if failed:
        sys.exit(f"left out: {', '.join(failed)}")


if __name__ == "__main__":
    main()
