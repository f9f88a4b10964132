#!/usr/bin/env python3
"""Measures scenes of a planet by their number of lit pixels, and prints a Markdown table.

    cargo build --release --package skyglow --package skyglow-lab
    scripts/planet_table.py --folder /tmp/planet --sizes 1e5,1e6 --terrain both

Makes what is not there yet in --folder: rasters by `lab planet`, scenes by `skyglow ingest`.
Then it serves each scene beside the smallest one and clicks at the same places in both in turn.
These lie in a region that is the same in every size, so that what differs is the rest of the planet.
A server opens it by itself at its start; then the first click is made, whose skylines are found in the background ("first word": when
it says so). Times are of one run, with the machine's load beside them.
Files are in the system's cache where they fit.
"""

import argparse
import json
import os
import pathlib
import socket
import statistics
import subprocess
import sys
import time
import urllib.error
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLACES = 30


def say(text):
    print(text, file=sys.stderr, flush=True)


def load():
    return f"{os.getloadavg()[0]:.1f}"


def run_timed(command):
    """Seconds, greatest resident memory in GB, and the output of a command."""
    start = time.monotonic()
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.PIPE)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stdout.close()
    if process.returncode:
        raise SystemExit(f"{command} ended with {process.returncode}")
    return time.monotonic() - start, usage.ru_maxrss / 1e6, output


def folder_bytes(folder):
    return sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())


def resident_gb(pid, field="VmRSS"):
    """Of a process: what it holds, pages of files that it looks at among it; RssAnon is without those, which the system can take back."""
    lines = pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
    values = {line.split(":")[0]: int(line.split()[1]) for line in lines if line.endswith("kB")}
    return values[field] / 1e6


class Server:
    """A server of some scenes; its time to ready is in `open_s`."""

    def __init__(self, options, data):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            address = f"127.0.0.1:{free.getsockname()[1]}"
        self.url = f"http://{address}"
        command = [options.skyglow, "serve", "--data", data, "--listen", address]
        command += ["--no-demo", "--device", "cpu", *options.serve]
        log = open(options.folder / "serve.log", "ab")
        start = time.monotonic()
        self.process = subprocess.Popen([str(part) for part in command], stdout=log, stderr=log)
        while True:
            try:
                urllib.request.urlopen(f"{self.url}/readyz", timeout=2).read()
                break
            except OSError:
                if self.process.poll() is not None or time.monotonic() - start > 600:
                    self.stop()
                    raise SystemExit("the server does not start: see serve.log") from None
                time.sleep(0.01)
        self.open_s = time.monotonic() - start

    def click_ms(self, scene, place):
        start = time.monotonic()
        query = f"lat={place[0]}&lon={place[1]}"
        self.first_word_ms = None
        while True:
            try:
                with urllib.request.urlopen(f"{self.url}/api/v1/scenes/{scene}/sky?{query}", timeout=1800) as answer:
                    answer.read()
                break
            except urllib.error.HTTPError as error:
                # Skylines of the lights around are being found.
                if error.code != 503 or json.load(error)["type"] != "/problems/being-made":
                    raise
                self.first_word_ms = self.first_word_ms or 1e3 * (time.monotonic() - start)
                time.sleep(0.2)
        click_ms = 1e3 * (time.monotonic() - start)
        self.first_word_ms = self.first_word_ms or click_ms
        return click_ms

    def until_opened(self, scene):
        """Waits until it has opened the scene by itself."""
        while True:
            with urllib.request.urlopen(f"{self.url}/metrics", timeout=60) as answer:
                lines = answer.read().decode().splitlines()
            if any(line.startswith("skyglow_scenes_open ") and float(line.split()[1]) > 0 for line in lines):
                return
            time.sleep(0.05)

    def stop(self):
        self.process.terminate()
        self.process.wait()


def scene_id(size, terrain):
    return f"planet-{size:.0e}-{'terrain' if terrain else 'flat'}".replace("+", "")


def make(options):
    """Rasters and scenes that are not there yet; what their making took is in a file beside."""
    folder = options.folder
    folder.mkdir(parents=True, exist_ok=True)
    terrain = folder / "terrain.tif"
    if any(options.terrains) and not terrain.exists():
        say("terrain")
        seconds, gb, _ = run_timed([options.lab, "planet", "--terrain", terrain])
        say(f"  {seconds:.0f} s, {gb:.2f} GB, file {terrain.stat().st_size / 1e6:.0f} MB, load {load()}")
    for size in options.sizes:
        lights, facts = folder / f"lights-{size:.0e}.tif", folder / f"lights-{size:.0e}.json"
        if not facts.exists():
            say(f"lights {size:.0e}")
            command = [options.lab, "planet", "--lights", lights, "--lit", str(int(size))]
            command += ["--lights-arcsec", str(options.arcsec), "--region-lit", str(options.region_lit)]
            seconds, gb, output = run_timed(command)
            say(f"  {seconds:.0f} s, {gb:.2f} GB, file {lights.stat().st_size / 1e6:.0f} MB, load {load()}")
            facts.write_bytes(output)
        for with_terrain in options.terrains:
            scene = scene_id(size, with_terrain)
            report = folder / f"{scene}.json"
            data = folder / "data" / scene
            if report.exists():
                continue
            say(f"ingest {scene}")
            command = [options.skyglow, "ingest", lights, "--id", scene, "--data", data, "--replace"]
            if with_terrain:
                command += ["--terrain", terrain]
            seconds, gb, _ = run_timed(command)
            made = {"ingest_s": seconds, "ingest_gb": gb, "load": load()}
            made["disk_gb"] = folder_bytes(data / "scenes" / scene) / 1e9
            report.write_text(json.dumps(made))
            say(f"  {seconds:.0f} s, {gb:.2f} GB, disk {made['disk_gb']:.2f} GB, load {made['load']}")


def begin(options, size, with_terrain):
    """The server of a scene, and the first row of figures: it was asked for two places."""
    facts = json.loads((options.folder / f"lights-{size:.0e}.json").read_text())
    scene = scene_id(size, with_terrain)
    server = Server(options, options.folder / "data" / scene)
    row = json.loads((options.folder / f"{scene}.json").read_text())
    row.update(scene=scene, lit=facts["lit_pixels"], places=facts["places"], open_s=server.open_s)
    start = time.monotonic()
    server.until_opened(scene)
    row["opened_s"] = row["open_s"] + time.monotonic() - start
    row["first_ms"] = server.click_ms(scene, row["places"][-1])
    row["first_word_ms"] = server.first_word_ms
    row["second_ms"] = server.click_ms(scene, row["places"][-2])
    say(f"{scene}: ready {row['open_s']:.2f} s, first click {row['first_ms']:.0f} ms, load {load()}")
    return server, row


def measure(options):
    """Each scene has a server, beside one of the smallest of its kind, which is asked at the same places in turn."""
    rows = []
    for with_terrain in options.terrains:
        smallest, first = begin(options, options.sizes[0], with_terrain)
        try:
            for size in options.sizes:
                server, row = begin(options, size, with_terrain)
                try:
                    times_ms = [[], []]
                    for number in range(PLACES * options.rounds):
                        # Another place each time, a little beside: what was asked before is remembered.
                        latitude, longitude = row["places"][number % PLACES]
                        place = (latitude + 1e-4 * (len(rows) + 1) + 1e-2 * (number // PLACES), longitude)
                        pair = [(smallest, first), (server, row)]
                        for index in (0, 1) if number % 2 else (1, 0):
                            times_ms[index].append(pair[index][0].click_ms(pair[index][1]["scene"], place))
                    row["small_ms"], row["warm_ms"] = (statistics.median(times) for times in times_ms)
                    row["slowest_ms"] = max(times_ms[1])
                    row["own_gb"] = resident_gb(server.process.pid, "RssAnon")
                    row["resident_gb"] = resident_gb(server.process.pid)
                    row["peak_gb"] = resident_gb(server.process.pid, "VmHWM")
                    row["load"] = load()
                finally:
                    server.stop()
                say(json.dumps({key: value for key, value in row.items() if key != "places"}))
                rows.append(row)
        finally:
            smallest.stop()
    return rows


def table(rows):
    print(
        "| lit pixels | terrain | ingest s | its peak GB | disk GB | ready s | scene open s | first word ms | first click ms | second ms | "
        "warm click ms | slowest ms | to the smallest | own GB | resident GB | peak GB | load |"
    )
    print("|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    for row in rows:
        kind = "30″" if row["scene"].endswith("terrain") else "none"
        print(
            f"| {row['lit']:,} | {kind} | {row['ingest_s']:.0f} | {row['ingest_gb']:.2f} | {row['disk_gb']:.2f} "
            f"| {row['open_s']:.2f} | {row['opened_s']:.2f} | {row['first_word_ms']:.0f} | {row['first_ms']:.0f} | {row['second_ms']:.0f} | {row['warm_ms']:.1f} "
            f"| {row['slowest_ms']:.0f} | {row['warm_ms'] / row['small_ms']:.2f} × | {row['own_gb']:.2f} | {row['resident_gb']:.2f} "
            f"| {row['peak_gb']:.2f} | {row['load']} |"
        )
    print(f"\nOn {os.cpu_count()} cores, shared with other work where the load is above them.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="for rasters and scenes, some gigabytes")
    parser.add_argument("--sizes", default="1e5,1e6,1e7,3e7", help="numbers of lit pixels")
    parser.add_argument("--terrain", choices=["none", "only", "both"], default="both")
    parser.add_argument("--arcsec", type=int, default=15, help="side of a pixel of the lights, arc seconds")
    parser.add_argument("--region-lit", type=int, default=80_000, help="of the region that is always the same")
    parser.add_argument("--rounds", type=int, default=1, help="clicks at each place")
    parser.add_argument("--skyglow", type=pathlib.Path, default=ROOT / "target/release/skyglow")
    parser.add_argument("--lab", type=pathlib.Path, default=ROOT / "target/release/lab")
    parser.add_argument("--only-make", action="store_true", help="makes rasters and scenes, and measures nothing else")
    parser.add_argument("serve", nargs="*", help="flags of `skyglow serve`, after --")
    options = parser.parse_args()
    options.sizes = [float(size) for size in options.sizes.split(",")]
    options.terrains = {"none": [False], "only": [True], "both": [False, True]}[options.terrain]
    make(options)
    if not options.only_make:
        table(measure(options))


if __name__ == "__main__":
    main()
