"""A server to be attacked by `attacks.py`: started in a memory cgroup of its own, asked, given scenes, and used by somebody else
meanwhile, whose times are measured.
"""
import http.client, json, multiprocessing, os, pathlib, random, signal, socket, statistics, struct
import subprocess, threading, time, zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOKEN = "attacks-operator-token-0123456789"
DEMO = "/api/v1/scenes/demo"
OTHER_USER = "203.0.113.7"


# ------------------------------------------------------------------------------------------------ the server

class Server:
    """The program on a free port, in a memory cgroup of its own where there can be one."""

    def __init__(self, folder, options, *arguments, packs=None, wait=True):
        """`options` has the program, the limit of its memory in bytes, and its port, 0 for a free one."""
        self.folder, self.peak, self.group = pathlib.Path(folder), 0, memory_group(options.limit)
        token = self.folder / "token"
        token.write_text(TOKEN)
        self.port = options.port or free_port()
        command = [options.program, "serve", "--listen", f"127.0.0.1:{self.port}", "--data", self.folder / "data", "--packs",
                   packs or ROOT / "precomputed", "--device", "cpu", "--trusted-proxies", "127.0.0.1/32",
                   "--operator-token-file", token, *arguments]
        self.log = open(self.folder / "log", "ab")
        group = self.group
        def enter():
            if group:
                (group / "cgroup.procs").write_text(str(os.getpid()))
        environment = {k: v for k, v in os.environ.items() if not k.startswith("SKYGLOW_")}
        environment["RUST_LOG"] = "warn"
        self.process = subprocess.Popen([str(part) for part in command], stderr=self.log, stdout=self.log, preexec_fn=enter,
                                        env=environment)
        self.watching = True
        threading.Thread(target=self.watch, daemon=True).start()
        deadline = time.monotonic() + 180
        while wait:
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise SystemExit(f"the server did not start: {(self.folder / 'log').read_text()[-1000:]}")
            try:
                if ask(self.port, "GET", "/readyz", timeout=5)[0] == 200:
                    break
            except OSError:
                pass
            time.sleep(0.1)

    def watch(self):
        while self.watching:
            self.peak = max(self.peak, self.resident())
            time.sleep(0.1)

    def resident(self):
        """Bytes of the program and its children (the reader of uploads) that are no files: what the system cannot take back."""
        total = 0
        for pid in [self.process.pid, *children(self.process.pid)]:
            try:
                for line in open(f"/proc/{pid}/status"):
                    if line.startswith(("RssAnon:", "RssShmem:")):
                        total += 1024 * int(line.split()[1])
            except OSError:
                pass
        return total

    def is_alive(self):
        return self.process.poll() is None

    def stop(self):
        self.watching = False
        if self.is_alive():
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(30)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        if self.group:
            for _ in range(50):
                try:
                    self.group.rmdir()
                    break
                except OSError:
                    time.sleep(0.1)


def children(pid):
    try:
        found = []
        for task in os.listdir(f"/proc/{pid}/task"):
            found += open(f"/proc/{pid}/task/{task}/children").read().split()
        return found
    except OSError:
        return []


def memory_group(limit):
    """A new memory cgroup with a limit (version 2, else 1); None where none can be made."""
    for top, name in [("/sys/fs/cgroup", "memory.max"), ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")]:
        group = pathlib.Path(top) / f"skyglow-attacks-{os.getpid()}-{time.monotonic_ns()}"
        try:
            group.mkdir()
        except OSError:
            continue
        try:
            # In a folder that is no cgroup writing would make a plain file.
            if (group / name).exists():
                (group / name).write_text(str(limit))
                return group
        except OSError:
            pass
        group.rmdir()
    return None


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


# ------------------------------------------------------------------------------------------------ requests

def ask(port, method, path, body=None, client=None, timeout=40, headers=()):
    """Status, body and headers of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout)
    try:
        headers = dict(headers)
        if client:
            headers["X-Forwarded-For"] = client
        if body is not None and not isinstance(body, bytes):
            body, headers["Content-Type"] = json.dumps(body).encode(), "application/json"
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        return answer.status, answer.read(), dict((k.lower(), v) for k, v in answer.getheaders())
    finally:
        connection.close()


def upload(port, scene, name, content, **fields):
    """PUT of a scene by the operator."""
    mark = "attack-0123456789"
    parts = [f'--{mark}\r\nContent-Disposition: form-data; name="{key}"\r\n\r\n{value}\r\n'.encode() for key, value in fields.items()]
    parts.append(f'--{mark}\r\nContent-Disposition: form-data; name="radiance"; filename="{name}"\r\n\r\n'.encode() + content + b"\r\n")
    body = b"".join(parts) + f"--{mark}--\r\n".encode()
    headers = {"Authorization": f"Bearer {TOKEN}", "Content-Type": f"multipart/form-data; boundary={mark}"}
    return ask(port, "PUT", f"/api/v1/scenes/{scene}", body, headers=headers, timeout=600)


def place(rng):
    return f"lat={44.3 + 3.0 * rng.random():.6f}&lon={6.3 + 6.0 * rng.random():.6f}"


def geotiff(side, value, west=10.0, north=47.0, step=1 / 240):
    """A GeoTIFF of equal radiances, deflated in strips, on WGS 84."""
    rows = min(side, 256)
    strips = [zlib.compress(struct.pack("<f", value) * side * min(rows, side - top), 9) for top in range(0, side, rows)]
    entries = []
    extra = bytearray()
    count = len(strips)
    head = 8 + 2 + 12 * 14 + 4
    def put(data):
        at = head + len(extra)
        extra.extend(data)
        return at
    def entry(tag, kind, values):
        form = {3: "H", 4: "I", 12: "d"}[kind]
        data = struct.pack(f"<{len(values)}{form}", *values)
        field = data.ljust(4, b"\0") if len(data) <= 4 else struct.pack("<I", put(data))
        entries.append(struct.pack("<HHI", tag, kind, len(values)) + field)
    for tag, kind, values in [(256, 4, [side]), (257, 4, [side]), (258, 3, [32]), (259, 3, [8]), (262, 3, [1])]:
        entry(tag, kind, values)
    offsets_index = len(entries)
    entries.append(b"")
    for tag, kind, values in [(277, 3, [1]), (278, 4, [rows]), (279, 4, [len(s) for s in strips]), (284, 3, [1]), (339, 3, [3]),
                              (33550, 12, [step, step, 0.0]), (33922, 12, [0.0, 0.0, 0.0, west, north, 0.0]),
                              (34735, 3, [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326])]:
        entry(tag, kind, values)
    table = put(b"\0" * 4 * count) if count > 1 else None
    at = head + len(extra)
    offsets = []
    for strip in strips:
        offsets.append(at)
        at += len(strip)
    packed = struct.pack(f"<{count}I", *offsets)
    if table is None:
        field = packed
    else:
        extra[table - head : table - head + 4 * count] = packed
        field = struct.pack("<I", table)
    entries[offsets_index] = struct.pack("<HHI", 273, 4, count) + field
    ifd = struct.pack("<H", len(entries)) + b"".join(entries) + struct.pack("<I", 0)
    return struct.pack("<2sHI", b"II", 42, 8) + ifd + bytes(extra) + b"".join(strips)


# ------------------------------------------------------------------------------------------------ another user

TILES = [f"{DEMO}/tiles/{layer}/7/{x}/45.png" for layer in ("radiance", "elevation") for x in (66, 67)]


def other_user(port, seconds, out):
    """Asks for skies and influences of new places, for tiles again and again, and for what has not changed; one of each at a time."""
    rng = random.Random(time.monotonic_ns())
    kinds = {
        "sky": lambda: (f"{DEMO}/sky?{place(rng)}", {}),
        "tile": lambda: (rng.choice(TILES), {}),
        "304": lambda: (TILES[0], {"If-None-Match": tag}),
        "influence": lambda: (f"{DEMO}/influence.json?{place(rng)}", {}),
    }
    try:
        tag = ask(port, "GET", TILES[0], client=OTHER_USER)[2].get("etag", "")
    except OSError:
        tag = ""
    said = {kind: [] for kind in kinds}
    end = time.monotonic() + seconds
    def run(kind):
        while time.monotonic() < end:
            path, headers = kinds[kind]()
            begun = time.monotonic()
            try:
                status = ask(port, "GET", path, client=OTHER_USER, headers=headers)[0]
            except (OSError, http.client.HTTPException):
                status = 0
            took = time.monotonic() - begun
            # Places off the raster are answered too, and are no skies.
            if status != 404:
                said[kind].append((status, took))
            time.sleep(max(0.0, 0.05 - took))
    threads = [threading.Thread(target=run, args=(kind,)) for kind in kinds]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    out.put(said)


def measured(port, seconds):
    out = multiprocessing.Queue()
    user = multiprocessing.Process(target=other_user, args=(port, seconds, out))
    user.start()
    said = out.get()
    user.join()
    table = {}
    for kind, answers in said.items():
        times = [took for _, took in answers]
        refused = sorted({status for status, _ in answers if status not in (200, 304)})
        table[kind] = {
            "asked": len(answers), "refused": sum(status not in (200, 304) for status, _ in answers), "with": refused,
            "median_s": round(statistics.median(times), 3) if times else None, "worst_s": round(max(times), 3) if times else None,
        }
    return table
