#!/usr/bin/env python3
"""Attacks on a server of its own, on loopback, and what another user has of it meanwhile: `attacks.py [OPTIONS] [PART ...]`.

Each part starts the program with the limits that it has by itself, under a memory limit where the system gives one (a memory
cgroup), lets another user ask quietly, and then asks again while the attack runs. It prints the server's largest resident memory
beside the limit, the other user's median and worst time by kind of request, and whether the part is passed. Parts:

  F1   uploads whose numbers lie in other files of the server (needs h5py: pip install h5py)
  F2   bodies that are held one byte short of their end
  F3   one household stores as much as it can: is what another user stored still there?
  F4   lists of a store that is full
  F5   plans that take long, by many
  F6   the largest rasters, read slowly
  F7   a small upload of very many lit pixels, asked for
  F8   a damaged pack, and damaged scenes
  F9   many who ask for what is not cached: does another user still get tiles and 304?
  F10  requests without a host or with two, slow readers, modes of files
  ALL  F2, F4, F5, F6, F7 and F9 at once

Python's standard library alone; clients are told apart by X-Forwarded-For of a trusted proxy on 127.0.0.1.
"""
import argparse, http.client, json, multiprocessing, os, pathlib, random, shutil, socket, stat, sys, tempfile, threading, time

from attacked_server import DEMO, OTHER_USER, ROOT, TOKEN, Server, ask, geotiff, measured, place, upload

OPTIONS = None


# ------------------------------------------------------------------------------------------------ attacks: run in processes of their own

def many(count, work, seconds):
    """Runs `work(number, until)` in threads."""
    os.nice(5)
    until = time.monotonic() + seconds
    threads = [threading.Thread(target=quiet, args=(work, number, until), daemon=True) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(max(0.0, until + 1 - time.monotonic()))


def quiet(work, *arguments):
    try:
        work(*arguments)
    except (OSError, http.client.HTTPException):
        pass


def held_bodies(port, seconds):
    """F2."""
    os.nice(5)
    length = 2 * 1024 * 1024
    piece = b" " * (length - 1)
    def hold(number, until):
        held = []
        for index in range(number, OPTIONS.connections, 16):
            if time.monotonic() > until:
                break
            method, path = [("POST", f"{DEMO}/scenarios"), ("GET", f"{DEMO}/sky?lat=46.17&lon=8.79")][index % 2]
            s = socket.create_connection(("127.0.0.1", port), timeout=5)
            head = (f"{method} {path} HTTP/1.1\r\nHost: a\r\nX-Forwarded-For: 198.51.{index // 250}.{index % 250 + 1}\r\n"
                    f"Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n")
            try:
                s.sendall(head.encode())
                s.sendall(piece)
            except OSError:
                pass
            held.append(s)
        time.sleep(max(0.0, until - time.monotonic()))
    many(16, hold, seconds)


def household(port, seconds):
    """F3: twenty /64 of one /59, as many small scenarios as are taken."""
    stored = []
    def store(number, until):
        rng = random.Random(number)
        for index in range(OPTIONS.scenarios // 20):
            if time.monotonic() > until:
                return
            body = {"title": f"{number} {index}", "edits": [{"brush": {"points": [[8.7 + 0.2 * rng.random(), 46.17]], "radius_m": 50},
                                                            "factor": 0.5}]}
            stored.append(ask(port, "POST", f"{DEMO}/scenarios", body, client=f"2001:db8:0:{number:x}::{index % 7 + 1}")[0])
    many(20, store, seconds)
    print(f"    of {len(stored)} scenarios {stored.count(201)} were stored", flush=True)


def fill_store(port, seconds):
    """Large scenarios of many addresses."""
    def fill(number, until):
        rng = random.Random(number)
        for index in range(10_000):
            if time.monotonic() > until:
                return
            edits = [{"brush": {"points": [[8.79 + rng.random() * 1e-3, 46.17 + rng.random() * 1e-3] for _ in range(400)],
                                "radius_m": 1}, "factor": 0.5} for _ in range(100)]
            ask(port, "POST", f"{DEMO}/scenarios", {"edits": edits}, client=f"198.18.{number}.{index // 2 % 250}")
    many(4, fill, seconds)


def lists(port, seconds):
    """F4: lists of another scene and of this one, and writing."""
    def read(number, until):
        while time.monotonic() < until:
            scene = "small" if number % 4 else "demo"
            ask(port, "GET", f"/api/v1/scenes/{scene}/scenarios", client=f"198.51.100.{number + 1}", timeout=120)
    many(8, read, seconds)


def long_plans(port, seconds):
    """F5: plans of 16 sites between turbidities over a painted scene."""
    paint = {"edits": [{"brush": {"points": [[8.5, 45.6], [9.5, 45.6]], "radius_m": 50_000}, "lamp": "pc_amber"}]}
    status, answer, _ = ask(port, "POST", f"{DEMO}/scenarios", paint, client="198.51.100.1")
    scenario = f"&scenario={json.loads(answer)['id']}" if status in (200, 201) else ""
    def plan(number, until):
        rng = random.Random(time.monotonic_ns() + number)
        while time.monotonic() < until:
            sites = [{"lat": 44.8 + 2.0 * rng.random(), "lon": 7.5 + 3.5 * rng.random(), "measure": "mean", "reduce_by": 0.3}
                     for _ in range(16)]
            body = {"method": "target", "max_cut": 0.8, "sites": sites}
            ask(port, "POST", f"{DEMO}/plans?keep=off&turbidity={2.1 + 0.3 * rng.random():.3f}{scenario}", body,
                client=f"198.51.100.{number % 10 + 1}", timeout=60)
            time.sleep(0.2)
    many(50, plan, seconds)


def large_rasters(port, seconds):
    """F6: half of them read slowly."""
    def read(number, until):
        rng = random.Random(time.monotonic_ns() + number)
        while time.monotonic() < until:
            s = socket.create_connection(("127.0.0.1", port), timeout=60)
            s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 16_384)
            s.sendall((f"GET {DEMO}/panorama.tif?width=4096&height_px=2048&{place(rng)} HTTP/1.1\r\nHost: a\r\n"
                       f"X-Forwarded-For: 198.51.100.{number % 16 + 1}\r\nConnection: close\r\n\r\n").encode())
            while time.monotonic() < until and s.recv(16_384):
                if number % 2:
                    time.sleep(0.25)
            s.close()
            time.sleep(0.05)
    many(48, read, seconds)


def lit_upload(port, seconds):
    """F7: the operator's upload, one stranger's sky, and its end."""
    os.nice(5)
    until = time.monotonic() + seconds
    content = geotiff(OPTIONS.side, 30.0, west=-20.0, north=50.0)
    status, answer, _ = upload(port, "lit", "lit.tif", content)
    print(f"    upload of {len(content) / 1e6:.2f} MB, {OPTIONS.side}^2 lit pixels: {status} {answer[:160].decode(errors='replace') if status >= 400 else ''}", flush=True)
    if status in (200, 201):
        try:
            sky = ask(port, "GET", "/api/v1/scenes/lit/sky?lat=25&lon=5", client="198.51.100.1", timeout=120)[0]
        except (OSError, http.client.HTTPException) as error:
            sky = error
        print(f"    its sky: {sky}", flush=True)
        quiet(ask, port, "DELETE", "/api/v1/scenes/lit", None, None, 60, {"Authorization": f"Bearer {TOKEN}"}.items())
    time.sleep(max(0.0, until - time.monotonic()))


def crowd(port, seconds):
    """F9: 256 connections that ask for pictures of new places."""
    def look(number, until):
        rng = random.Random(time.monotonic_ns() + number)
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        while time.monotonic() < until:
            try:
                connection.request("GET", f"{DEMO}/panorama.png?{place(rng)}", headers={"X-Forwarded-For": f"198.51.100.{number % 16 + 1}"})
                connection.getresponse().read()
            except (OSError, http.client.HTTPException):
                connection.close()
            time.sleep(0.02)
    many(256, look, seconds)


# ------------------------------------------------------------------------------------------------ parts

class Part:
    """One part: a server with a copy of the demo, and what is wrong."""

    def __init__(self, name, demo):
        self.name, self.wrong, self.report = name, [], {"part": name}
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="skyglow-attack-", dir=OPTIONS.work))
        (self.folder / "data" / "scenes").mkdir(parents=True)
        shutil.copytree(demo, self.folder / "data" / "scenes" / "demo")
        self.server = None

    def start(self, *arguments, **more):
        self.server = Server(self.folder, OPTIONS, *arguments, **more)
        return self.server.port

    def check(self, is_fine, what):
        if not is_fine:
            self.wrong.append(what)

    def under(self, *attacks, seconds=None):
        """Another user, quiet and then under attacks: whatever they ask for must be answered, in good time."""
        seconds = seconds or OPTIONS.seconds
        port = self.server.port
        if "quiet" not in self.report:
            self.report["quiet"] = measured(port, min(8, seconds))
        running = [multiprocessing.Process(target=quiet, args=(attack, port, seconds)) for attack in attacks]
        for attack in running:
            attack.start()
        # What builds up first is there when the other user asks.
        time.sleep(min(3, seconds / 4))
        self.report["attacked"] = measured(port, seconds - min(3, seconds / 4))
        for attack in running:
            attack.join(seconds + 120)
            if attack.is_alive():
                attack.kill()
        for kind, answers in self.report["attacked"].items():
            slow = [f"{name} {answers[name]} s" for name, most in (("median_s", OPTIONS.median), ("worst_s", OPTIONS.worst))
                    if answers[name] is None or answers[name] > most]
            self.check(not slow, f"{kind} of another user: {', '.join(slow)}")
            self.check(not answers["refused"], f"{answers['refused']} of {answers['asked']} {kind} of another user got {answers['with']}")

    def end(self):
        if self.server:
            alive = self.server.is_alive()
            self.check(alive, f"the server ended with {self.server.process.poll()} (-9: killed, as where memory runs out)")
            if alive:
                metrics = ask(self.server.port, "GET", "/metrics")[1].decode()
                self.check('status="500"' not in metrics, "answers with 500")
            time.sleep(0.2)
            self.report["limit_enforced"] = self.server.group is not None
            self.report["memory_after_mb"] = round(self.server.resident() / 1e6)
            self.server.stop()
            self.report["memory_peak_mb"] = round(self.server.peak / 1e6)
            self.check(self.server.peak <= OPTIONS.limit, "more memory than the limit")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.report["wrong"] = self.wrong
        tell(self.report)
        return self.report


def f1(part):
    port = part.start()
    try:
        import h5py, numpy
    except ImportError:
        part.check(False, "h5py is not installed (apt-get install python3-h5py, and run this by /usr/bin/python3)")
        return
    side, name = 240, "NearNadir_Composite_Snow_Free"
    secret, sound = part.folder / "secret", part.folder / "data" / "sound.h21v09.h5"
    secret.write_bytes(b"x" * side * side)
    with h5py.File(sound, "w") as file:
        file.create_dataset(name, data=numpy.full((side, side), 120, dtype="u1"))
    def external(file):
        file.create_dataset(name, shape=(side, side), dtype="u1", external=[(str(secret), 0, side * side)])
    def link(file):
        file[name] = h5py.ExternalLink(str(sound), name)
    def virtual(file):
        layout = h5py.VirtualLayout(shape=(side, side), dtype="u1")
        layout[:] = h5py.VirtualSource(str(sound), name, shape=(side, side))
        file.create_virtual_dataset(name, layout)
    for kind, make in [("external storage", external), ("external link", link), ("virtual dataset", virtual)]:
        path = part.folder / "attack.h21v09.h5"
        with h5py.File(path, "w") as file:
            make(file)
            if make is link:
                file.create_dataset("other", data=numpy.full((side, side), 1, dtype="u1"))
        status, answer, _ = upload(port, "read", path.name, path.read_bytes(), scale="1", band=name)
        print(f"    {kind}: {status} {answer[:200].decode(errors='replace') if status >= 400 else ''}")
        part.check(status == 422, f"an upload with {kind} is answered with {status}")
    vrt = f"""<VRTDataset rasterXSize="64" rasterYSize="64"><SRS>EPSG:4326</SRS><GeoTransform>10,0.01,0,47,0,-0.01</GeoTransform>
<VRTRasterBand dataType="Byte" band="1" subClass="VRTRawRasterBand"><SourceFilename relativetoVRT="0">{secret}</SourceFilename>
<ImageOffset>0</ImageOffset><PixelOffset>1</PixelOffset><LineOffset>64</LineOffset></VRTRasterBand></VRTDataset>"""
    status, answer, _ = upload(port, "read", "attack.tif", vrt.encode())
    print(f"    virtual raster: {status} {answer[:200].decode(errors='replace')}")
    part.check(status == 422, f"a virtual raster is answered with {status}")


def f2(part):
    part.start()
    part.under(held_bodies)


def f3(part):
    # Room for less than the household has to store.
    port = part.start("--kept-plans", str(max(10, OPTIONS.scenarios // 4)))
    paint = {"title": "another user's", "edits": [{"brush": {"points": [[9.0, 45.5]], "radius_m": 3000}, "factor": 0.3}]}
    status, answer, _ = ask(port, "POST", f"{DEMO}/scenarios", paint, client=OTHER_USER)
    identifier = json.loads(answer)["id"]
    part.under(household, seconds=max(OPTIONS.seconds, OPTIONS.household_seconds))
    status = ask(port, "GET", f"/api/v1/scenarios/{identifier}", client=OTHER_USER)[0]
    print(f"    what another user stored before: {status}")
    part.check(status == 200, f"what another user stored is answered with {status}")


def start_full(part):
    """A server with a second scene and a full store."""
    port = part.start()
    upload(port, "small", "small.tif", geotiff(64, 5.0))
    filling = multiprocessing.Process(target=fill_store, args=(port, OPTIONS.fill_seconds))
    filling.start()
    filling.join()
    return port


def f4(part):
    port = start_full(part)
    stored = [f for f in (part.folder / "data").rglob("*") if f.is_file() and "scenes" not in f.relative_to(part.folder / "data").parts[:1]]
    kept_mb = sum(f.stat().st_size for f in stored) / 1e6
    begun = time.monotonic()
    status, answer, _ = ask(port, "GET", "/api/v1/scenes/small/scenarios", client=OTHER_USER, timeout=120)
    took = time.monotonic() - begun
    print(f"    {kept_mb:.0f} MB stored; the list of another scene: {status}, {len(answer)} bytes, {took:.2f} s")
    part.report["stored_mb"], part.report["list_s"] = round(kept_mb), round(took, 3)
    part.check(took < 1.0, f"an empty list takes {took:.1f} s")
    part.under(lists)


def f5(part):
    part.start()
    part.under(long_plans)


def f6(part):
    part.start()
    part.under(large_rasters)


def f7(part):
    part.start()
    part.under(lit_upload)


def f8(part):
    packs = part.folder / "packs"
    shutil.copytree(ROOT / "precomputed", packs)
    flip(sorted(packs.glob("*.skyglow"))[2])
    try:
        port = part.start("--no-demo", packs=packs)
    except SystemExit as error:
        part.check(False, f"one damaged pack of six: {str(error)[:300]}")
        part.server = None
        return
    upload(port, "small", "small.tif", geotiff(64, 5.0))
    status, ready, _ = ask(port, "GET", "/readyz")
    print(f"    one damaged pack: {status} {ready.decode()}")
    part.check(status == 200 and b"skyglow" in ready, "the damaged pack is not named")
    part.server.stop()
    flip(part.folder / "data" / "scenes" / "demo" / "light.bin")
    port = part.start("--no-demo")
    time.sleep(2)
    status, ready, _ = ask(port, "GET", "/readyz")
    sky = ask(port, "GET", f"{DEMO}/sky?lat=46.17&lon=8.79")[0]
    print(f"    one damaged scene of two: {status} {ready.decode()}; its sky: {sky}")
    part.check(status == 200 and b"demo" in ready, "the damaged scene is not named")
    part.check(sky == 503, f"the sky of a damaged scene is answered with {sky}")
    ask(port, "DELETE", "/api/v1/scenes/small", headers={"Authorization": f"Bearer {TOKEN}"})
    part.server.stop()
    port = part.start("--no-demo", wait=False)
    status = 0
    for _ in range(40):
        time.sleep(0.25)
        try:
            status = ask(port, "GET", "/readyz")[0]
            if status == 503 and b"damaged" in ask(port, "GET", "/readyz")[1]:
                break
        except OSError:
            pass
    print(f"    its only scene damaged: {status}")
    part.check(status == 503, f"/readyz is {status} with the only scene damaged")


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def f9(part):
    part.start()
    # More than there are places ask for new pictures: some of what is new is refused, with Retry-After; what is cached is not.
    part.under(crowd)


def f10(part):
    port = part.start()
    def raw(head):
        with socket.create_connection(("127.0.0.1", port), timeout=10) as s:
            s.sendall(head)
            return int((s.recv(64).split() or [b"0", b"0"])[1])
    for what, head in [("without a host", b"GET /healthz HTTP/1.1\r\n\r\n"), ("with two hosts", b"GET /healthz HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n")]:
        status = raw(head)
        print(f"    a request {what}: {status}")
        part.check(status == 400, f"a request {what} is answered with {status}")
    ask(port, "POST", f"{DEMO}/scenarios", {"edits": [{"brush": {"points": [[9.0, 45.5]], "radius_m": 3000}, "factor": 0.3}]})
    upload(port, "small", "small.tif", geotiff(64, 5.0))
    modes = {}
    for file in (part.folder / "data").rglob("*"):
        # The key of hashes is for the program alone.
        if file.is_file() and "demo" not in file.parts and file.name != "kept.key":
            modes.setdefault(oct(stat.S_IMODE(file.stat().st_mode)), []).append(str(file.relative_to(part.folder)))
    print(f"    modes of files: { {mode: len(files) for mode, files in modes.items()} }")
    part.check(len(modes) == 1, f"files are written with several modes: { {mode: files[:2] for mode, files in modes.items()} }")
    # A slow reader: 60 kB a second of a large raster.
    s = socket.create_connection(("127.0.0.1", port), timeout=60)
    s.sendall(f"GET {DEMO}/panorama.tif?width=4096&height_px=2048&lat=46.17&lon=8.79 HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n".encode())
    begun, taken = time.monotonic(), 0
    try:
        while time.monotonic() - begun < max(100, OPTIONS.seconds):
            piece = s.recv(6000)
            if not piece:
                break
            taken += len(piece)
            time.sleep(0.1)
    except OSError:
        pass
    lasted = time.monotonic() - begun
    print(f"    a reader of 60 kB/s is served {taken / 1e6:.1f} MB in {lasted:.0f} s")
    part.check(lasted >= max(100, OPTIONS.seconds) or taken > 20e6, f"a reader of 60 kB/s is cut off after {lasted:.0f} s")


def everything(part):
    start_full(part)
    part.under(held_bodies, lists, long_plans, large_rasters, lit_upload, crowd)


PARTS = {"F1": f1, "F2": f2, "F3": f3, "F4": f4, "F5": f5, "F6": f6, "F7": f7, "F8": f8, "F9": f9, "F10": f10, "ALL": everything}


def tell(report):
    if "memory_peak_mb" in report:
        print(f"  memory: {report['memory_peak_mb']} MB at most, {report['memory_after_mb']} MB at the end; limit {OPTIONS.limit / 1e6:.0f} MB"
              f"{'' if report['limit_enforced'] else ', which nothing enforces here'}")
    for when in ("quiet", "attacked"):
        for kind, a in report.get(when, {}).items():
            print(f"  {when:9}{kind:10}{a['asked']:5} asked {a['refused']:4} refused {a['with'] or ''}  median {a['median_s']} s, worst {a['worst_s']} s")
    for what in report["wrong"]:
        print(f"  wrong: {what}")
    print(f"{report['part']}: {report['skipped'] if 'skipped' in report else 'FAILED' if report['wrong'] else 'passed'}", flush=True)


def demo_scene():
    """The demo's folder, made once by the program."""
    folder = pathlib.Path(OPTIONS.work) / "demo"
    scene = folder / "data" / "scenes" / "demo"
    if not scene.exists():
        folder.mkdir(parents=True, exist_ok=True)
        Server(folder, OPTIONS).stop()
    return scene


def main():
    global OPTIONS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"{', '.join(PARTS)}; all by default")
    parser.add_argument("--program", default=ROOT / "target" / "release" / "skyglow")
    parser.add_argument("--seconds", type=float, default=60, help="of each attack (60)")
    parser.add_argument("--limit", type=lambda text: int(float(text) * 2**30), default=4 * 2**30, help="memory limit, GiB (4)")
    parser.add_argument("--median", type=float, default=2, help="longest median of another user's times, seconds (2)")
    parser.add_argument("--worst", type=float, default=15, help="longest of another user's times, seconds (15)")
    parser.add_argument("--connections", type=int, default=1960, help="connections of F2 (1960)")
    parser.add_argument("--scenarios", type=int, default=5000, help="scenarios of F3 (5000)")
    parser.add_argument("--household-seconds", type=float, default=120, help="of F3 at least (120)")
    parser.add_argument("--fill-seconds", type=float, default=60, help="of filling the store in F4 (60)")
    parser.add_argument("--side", type=int, default=12_000, help="pixels a side of the upload in F7 (12000)")
    parser.add_argument("--port", type=int, default=0, help="port of the server (a free one)")
    parser.add_argument("--work", default=None, help="folder for the servers' data (a new one, removed at the end)")
    parser.add_argument("--json", type=pathlib.Path, help="file for the figures")
    OPTIONS = parser.parse_args()
    unknown = set(OPTIONS.parts) - set(PARTS)
    if unknown:
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    own = None if OPTIONS.work else tempfile.mkdtemp(prefix="skyglow-attacks-")
    OPTIONS.work = OPTIONS.work or own
    reports = []
    try:
        demo = demo_scene()
        for name in OPTIONS.parts or PARTS:
            print(f"{name}: {PARTS[name].__doc__ or ''}".rstrip(": "), flush=True)
            part = Part(name, demo)
            try:
                PARTS[name](part)
            finally:
                reports.append(part.end())
            if OPTIONS.json:
                OPTIONS.json.write_text(json.dumps(reports, indent=1) + "\n")
    finally:
        if own:
            shutil.rmtree(own, ignore_errors=True)
    failed = [report["part"] for report in reports if report["wrong"]]
    print(f"attacks: {'FAILED: ' + ', '.join(failed) if failed else 'passed'}")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
