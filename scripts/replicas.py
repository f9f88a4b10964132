#!/usr/bin/env python3
"""Two servers over one store, on loopback: an S3 server (moto) for what is kept, Redis for limits and drafts. `replicas.py [OPTIONS]`.
With --azurite its program `azurite-blob` (`npm install azurite`) is asked instead, as Azure Blob Storage.

1. What one keeps the other reads, lists and removes; how long until the first sees that.
2. A draft of one is read at the other, and a client's burst counts at both together.
3. Both keep and read under load, and one of them is killed in the middle: is all there that was answered 201, at the other, at a new
   server with an empty folder, and at the killed one when it starts again? Does the other refuse anything?
4. Redis goes away: requests go on, with one warning and a metric.
5. The store hangs, then goes on: 503 that says so, never 404; what has a copy is read; a server does not start.

Ends with 1 at the first thing that is not so. moto goes into an environment in the build folder, Debian's redis-server is installed
where it is missing.
"""
import argparse, base64, email.utils, hashlib, hmac, http.client, json, os, pathlib, random, shutil, signal, socket, subprocess, sys, tempfile, threading, time, zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
DEMO = "/api/v1/scenes/demo"
TOKEN = "replicas-operator-token-0123456789"
BUCKET, PREFIX, PASSWORD = "kept", "demo/service", "a-password-of-redis"
BURST = 400
STARTED = []


def say(*words):
    print("replicas:", *words, flush=True)


def require(is_so, *words):
    if not is_so:
        say("FAILED:", *words)
        sys.exit(1)


# ------------------------------------------------------------------------------------------------ what is started

def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def environment():
    """Python with moto."""
    requirements = ROOT / "scripts/replicas_requirements.txt"
    folder = TARGET / f"replicas-{zlib.crc32(requirements.read_bytes()):08x}"
    if not (folder / "complete").exists():
        say("installing moto into", folder)
        shutil.rmtree(folder, ignore_errors=True)
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([folder / "bin/pip", "install", "--quiet", "--no-deps", "--requirement", requirements], check=True)
        (folder / "complete").touch()
    return folder / "bin/python"


def until_listening(port, process, words):
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and process.poll() is None:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
            return
        except OSError:
            time.sleep(0.05)
    require(False, words, "does not start")


def start_s3(work):
    port = free_port()
    code = f"from moto.server import main; main(['-p', '{port}', '-H', '127.0.0.1'])"
    process = subprocess.Popen([environment(), "-c", code], stdout=open(work / "s3.log", "ab"), stderr=subprocess.STDOUT)
    STARTED.append(process)
    until_listening(port, process, "moto's S3 server")
    require(send(port, "PUT", f"/{BUCKET}", timeout=30)[0] == 200, "no bucket can be made")
    variables = {"AWS_ENDPOINT": f"http://127.0.0.1:{port}", "AWS_ALLOW_HTTP": "true", "AWS_ACCESS_KEY_ID": "test",
                 "AWS_SECRET_ACCESS_KEY": "test", "AWS_REGION": "us-east-1"}
    return f"s3://{BUCKET}/{PREFIX}", variables, process


# Of every Azurite, as its documentation has them.
AZURITE_ACCOUNT = "devstoreaccount1"
AZURITE_KEY = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw=="


def start_azurite(work, program):
    port = free_port()
    command = [program, "--silent", "--location", work / "azurite", "--blobPort", str(port), "--skipApiVersionCheck"]
    process = subprocess.Popen(command, stdout=open(work / "azurite.log", "ab"), stderr=subprocess.STDOUT)
    STARTED.append(process)
    until_listening(port, process, "Azurite")
    # A container, by the rules of shared keys.
    headers = {"x-ms-date": email.utils.formatdate(usegmt=True), "x-ms-version": "2021-08-06"}
    signed = "PUT" + 5 * "\n" + "application/json" + 7 * "\n" + "".join(f"{name}:{value}\n" for name, value in headers.items())
    signed += f"/{AZURITE_ACCOUNT}/{AZURITE_ACCOUNT}/{BUCKET}\nrestype:container"
    digest = hmac.new(base64.b64decode(AZURITE_KEY), signed.encode(), hashlib.sha256).digest()
    headers |= {"Authorization": f"SharedKey {AZURITE_ACCOUNT}:{base64.b64encode(digest).decode()}", "Content-Length": "0"}
    answer = send(port, "PUT", f"/{AZURITE_ACCOUNT}/{BUCKET}?restype=container", headers=headers, timeout=30)
    require(answer[0] == 201, "no container can be made:", answer[2])
    variables = {"AZURE_STORAGE_USE_EMULATOR": "true", "AZURITE_BLOB_STORAGE_URL": f"http://127.0.0.1:{port}"}
    return f"az://{BUCKET}/{PREFIX}", variables, process


def start_redis(work):
    if not shutil.which("redis-server"):
        say("installing redis-server")
        subprocess.run(["apt-get", "install", "-y", "-q", "--no-install-recommends", "redis-server"], check=True, stdout=subprocess.DEVNULL)
    port = free_port()
    command = ["redis-server", "--bind", "127.0.0.1", "--port", str(port), "--save", "", "--appendonly", "no", "--requirepass", PASSWORD,
               "--dir", str(work)]
    process = subprocess.Popen(command, stdout=open(work / "redis.log", "ab"), stderr=subprocess.STDOUT)
    STARTED.append(process)
    until_listening(port, process, "redis-server")
    return port, process


class Server:
    """The program over the store, with a data folder of its own."""

    def __init__(self, options, folder, store, redis_port, wait=True):
        self.folder, self.port = folder, free_port()
        folder.mkdir(exist_ok=True)
        token = folder / "token"
        token.write_text(TOKEN)
        command = [options.program, "serve", "--listen", f"127.0.0.1:{self.port}", "--data", folder / "data", "--packs", ROOT / "precomputed",
                   "--device", "cpu", "--trusted-proxies", "127.0.0.1/32", "--operator-token-file", token, "--store", store[0],
                   "--requests-per-second", "20", "--request-burst", str(BURST), "--kept-per-day", "0", "--work-per-minute-s", "0",
                   "--memory-budget-bytes", str(256 << 20)]
        env = {k: v for k, v in os.environ.items() if not k.startswith(("SKYGLOW_", "AWS_", "AZURE_", "AZURITE_", "GOOGLE_"))}
        env |= store[1] | {"RUST_LOG": "info",
                "SKYGLOW_VALKEY": f"redis://:{PASSWORD}@127.0.0.1:{redis_port}"}
        self.process = subprocess.Popen([str(part) for part in command], stdout=open(folder / "log", "ab"), stderr=subprocess.STDOUT, env=env)
        STARTED.append(self.process)
        if wait:
            self.until_ready()

    def log(self):
        return (self.folder / "log").read_text(errors="replace")

    def until_ready(self):
        deadline = time.monotonic() + 600
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                if send(self.port, "GET", "/readyz", timeout=5)[0] == 200:
                    return
            except OSError:
                pass
            time.sleep(0.1)
        require(False, "a server does not start:", self.log()[-2000:])

    def ask(self, method, path, body=None, client="203.0.113.1", headers=None, timeout=60):
        return send(self.port, method, path, body, {"X-Forwarded-For": client} | (headers or {}), timeout)

    def metric(self, name):
        text = self.ask("GET", "/metrics")[2].decode()
        return next(float(line.split()[1]) for line in text.splitlines() if line.startswith(name + " "))


def send(port, method, path, body=None, headers=None, timeout=60):
    """Status, headers and body of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=timeout)
    try:
        data = None if body is None else json.dumps(body)
        connection.request(method, path, data, {"Content-Type": "application/json"} | (headers or {}))
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()
    finally:
        connection.close()


# ------------------------------------------------------------------------------------------------ what is asked

def paint(number):
    brush = {"points": [[8.79 + 1e-5 * (number % 1000), 46.17]], "radius_m": 2000 + number // 1000}
    return {"title": f"number {number}", "edits": [{"brush": brush, "factor": 0.5}]}


def plan(reduce_by):
    return {"method": "target", "max_cut": 0.8, "sites": [{"lat": 46.4, "lon": 8.7, "measure": "zenith", "reduce_by": reduce_by}]}


def path_of(kind, answer):
    return f"/api/v1/{kind}/{json.loads(answer[2])['id']}"


def until(words, is_so, seconds):
    """Seconds until something is so."""
    began = time.monotonic()
    while not is_so():
        require(time.monotonic() - began < seconds, words, f"not within {seconds} s")
        time.sleep(0.05)
    return time.monotonic() - began


def share_documents(a, b):
    made = a.ask("POST", f"{DEMO}/scenarios", paint(1))
    require(made[0] == 201, "a scenario is not kept:", made)
    scenario, secret = path_of("scenarios", made), made[1]["skyglow-owner"]
    here, there = a.ask("GET", scenario), b.ask("GET", scenario)
    require(there[0] == 200 and there[2] == here[2], "a scenario of one is not read at the other:", there)
    found = b.ask("POST", f"{DEMO}/plans", plan(0.2))
    require(found[0] == 201, "a plan is not kept:", found[0], found[2][:500])
    for form in ["", ".tif", ".csv"]:
        one, other = (server.ask("GET", path_of("plans", found) + form) for server in (a, b))
        require(one[0] == 200 and one[2] == other[2], "a plan of one is not the same at the other:", form, one[0])
    sky = f"{DEMO}/sky?lat=46.17&lon=8.79&scenario={scenario.rsplit('/', 1)[1]}"
    require(b.ask("GET", sky)[2] == a.ask("GET", sky)[2], "the changed skies differ")
    is_listed = lambda: scenario.rsplit("/", 1)[1].encode() in b.ask("GET", f"{DEMO}/scenarios")[2]
    listed_s = until("a scenario of one is in the other's list", is_listed, 10)
    require(b.ask("DELETE", scenario, headers={"Skyglow-Owner": "0" * 32})[0] == 403, "anybody may remove it")
    require(b.ask("DELETE", scenario, headers={"Skyglow-Owner": secret})[0] == 204, "its owner may not remove it")
    gone_s = until("what one removed is gone at the other", lambda: a.ask("GET", scenario)[0] == 404, 15)
    say(f"kept at one, read at the other at once; in its list after {listed_s:.2f} s; removed there, gone here after {gone_s:.1f} s")


def share_scenes(a, b):
    """What one server is given by PUT the other has soon; what the other removes goes everywhere."""
    raster, scene = a.folder / "radiance.tif", "/api/v1/scenes/trial"
    raster.write_bytes(a.ask("GET", f"{DEMO}/layers/radiance.tif")[2])
    command = ["curl", "-sS", "-X", "PUT", f"http://127.0.0.1:{a.port}{scene}", "-H", f"Authorization: Bearer {TOKEN}", "-F", f"radiance=@{raster}"]
    answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    require(a.ask("GET", scene)[0] == 200, "an upload is not taken:", answer[:500])
    seconds = until("the scene of one is at the other", lambda: b.ask("GET", scene)[0] == 200, 60)
    ask = f"{scene}/sky?lat=46.2&lon=8.8"
    one, other = (server.ask("GET", ask) for server in (a, b))
    require(one[0] == 200 and one[2] == other[2], "skies differ:", one[2][:500], other[2][:500])
    require(b.ask("DELETE", scene, headers={"Authorization": f"Bearer {TOKEN}"})[0] == 204, "a scene cannot be removed")
    gone = until("a scene that is removed at one is gone at the other", lambda: a.ask("GET", scene)[0] == 404, 60)
    require(a.ask("GET", DEMO)[0] == 200 == b.ask("GET", DEMO)[0], "scenes that no server put into the store are gone")
    say(f"a scene given to one is at the other after {seconds:.1f} s, with the same sky; removed there, it is gone here after {gone:.1f} s")


def share_drafts_and_rates(a, b):
    draft = a.ask("POST", f"{DEMO}/plans?keep=off", plan(0.25))
    require(draft[0] == 201, "no draft:", draft[2][:500])
    there = b.ask("GET", path_of("plans", draft))
    require(there[0] == 200 and there[2] == a.ask("GET", path_of("plans", draft))[2], "a draft of one is not read at the other")
    sky = f"{DEMO}/sky?lat=46.4&lon=8.7&scenario={json.loads(draft[2])['id']}"
    require(b.ask("GET", sky)[2] == a.ask("GET", sky)[2], "the skies of a draft differ")
    began, good = time.monotonic(), [0, 0]
    # As somebody who asks both by turns, for twice his burst.
    for number in range(2 * BURST):
        good[number % 2] += (a, b)[number % 2].ask("GET", "/api/v1/atmospheres", client="203.0.113.99")[0] == 200
    took_s = time.monotonic() - began
    most = BURST + 20 * took_s
    # Servers add up ten times a second: what he asks meanwhile is owed. A busy machine needs longer. Each alone would let all pass.
    require(sum(good) < most + 0.5 * 2 * BURST / took_s, f"{sum(good)} requests of one client passed, {most:.0f} are his share")
    require(sum(good) > 0.9 * BURST, f"only {sum(good)} requests of one client passed")
    say(f"a draft of one is read at the other; of {2 * BURST} requests of one client to both in {took_s:.1f} s {good[0]} + {good[1]} passed, "
        f"his share is {most:.0f}")


class Load:
    """Clients that keep scenarios and read them, at whichever server answers."""

    def __init__(self, servers):
        self.servers, self.lock, self.kept, self.read, self.refused, self.broken = servers, threading.Lock(), [], 0, [], 0
        self.dead, self.ends = set(), False

    def client(self, number):
        choice, count = random.Random(number), 0
        while not self.ends:
            server = choice.choice([s for s in self.servers if s not in self.dead])
            # A client's share is not what is measured here.
            client = f"198.51.{number}.{count // 100 % 250}"
            try:
                if count % 3 == 0:
                    body = paint(1000 * (number + 1) + count // 3)
                    answer = server.ask("POST", f"{DEMO}/scenarios", body, client)
                    good = answer[0] == 201
                    with self.lock:
                        if good:
                            self.kept.append((path_of("scenarios", answer), body["title"]))
                else:
                    with self.lock:
                        path, title = choice.choice(self.kept) if self.kept else (f"{DEMO}", None)
                    answer = server.ask("GET", path, None, client)
                    good = answer[0] == 200 and (title is None or json.loads(answer[2])["title"] == title)
                    self.read += good
                if not good:
                    self.refused.append((answer[0], answer[2][:300]))
            except (OSError, http.client.HTTPException):
                self.broken += 1
                if server.process.poll() is not None:
                    self.dead.add(server)
            count += 1


def kill_one_under_load(options, a, b, start):
    load = Load([a, b])
    threads = [threading.Thread(target=load.client, args=(number,), daemon=True) for number in range(options.clients)]
    began = time.monotonic()
    for thread in threads:
        thread.start()
    time.sleep(options.seconds / 2)
    with load.lock:
        before = len(load.kept)
    a.process.send_signal(signal.SIGKILL)
    a.process.wait()
    time.sleep(options.seconds / 2)
    load.ends = True
    for thread in threads:
        thread.join()
    took_s = time.monotonic() - began
    require(before > 0 and len(load.kept) > before, "nothing was kept before or after the kill:", before, len(load.kept))
    require(not load.refused, f"{len(load.refused)} answers were refused or wrong:", load.refused[:3])
    say(f"{options.clients} clients, {took_s:.0f} s: {len(load.kept)} kept ({before} before one was killed), {load.read} read, none refused, "
        f"{load.broken} connections broken by the kill")
    again, new = start("a"), start("c")
    for name, server in [("the other", b), ("the killed one, started again", again), ("a new one", new)]:
        for number, (path, title) in enumerate(load.kept):
            answer = server.ask("GET", path, client=f"198.18.{number // 100}.1")
            require(answer[0] == 200 and json.loads(answer[2])["title"] == title, f"{path} is lost at {name}:", answer[0])
        say(f"all {len(load.kept)} are there at {name}")
    new.process.send_signal(signal.SIGTERM)
    require(new.process.wait(60) == 0, "SIGTERM does not end a server with 0")
    return again, load.kept


def lose_redis(redis, a, b):
    redis.kill()
    redis.wait()
    for server in (a, b):
        for number in range(50):
            began = time.monotonic()
            require(server.ask("GET", f"{DEMO}/site?lat=46.17&lon=8.79", client="192.0.2.7")[0] == 200, "no answer without Redis")
            require(time.monotonic() - began < 2, "an answer without Redis took 2 s")
            time.sleep(0.02)
        draft = server.ask("POST", f"{DEMO}/plans?keep=off", plan(0.15))
        require(draft[0] == 201 and server.ask("GET", path_of("plans", draft))[0] == 200, "no draft without Redis")
        require(server.metric("skyglow_valkey_away") == 1, "the metric does not say that Redis is away")
        require(server.log().count("Valkey does not answer") == 1, "not one warning that Redis is away")
    say("Redis killed: requests and drafts go on at each server, one warning, skyglow_valkey_away is 1")


def hang_store(process, start, b, kept):
    # B has copies of all; one that it has not is another's, kept a moment before.
    process.send_signal(signal.SIGSTOP)
    began = time.monotonic()
    answer = b.ask("GET", "/api/v1/scenarios/s-0123456789abcdef0123")
    took_s = time.monotonic() - began
    require(answer[0] == 503 and json.loads(answer[2])["type"] == "/problems/store-away", "a store that hangs:", answer[0], answer[2])
    require(b.ask("GET", kept[0][0])[0] == 200, "what has a copy is not read")
    require(b.ask("GET", f"{DEMO}/sky?lat=46.2&lon=8.8")[0] == 200, "no sky while the store hangs")
    answer = b.ask("POST", f"{DEMO}/scenarios", paint(7))
    require(answer[0] == 503, "kept while the store hangs:", answer[0])
    refused = start("d", wait=False)
    require(refused.process.wait(180) != 0 and "store" in refused.log(), "a server starts without its store:", refused.log()[-500:])
    process.send_signal(signal.SIGCONT)
    until("the store goes on", lambda: b.ask("POST", f"{DEMO}/scenarios", paint(8))[0] == 201, 30)
    require(b.ask("GET", "/api/v1/scenarios/s-0123456789abcdef0123")[0] == 404, "what nobody kept is not unknown")
    say(f"store hangs: 503 store-away after {took_s:.1f} s, copies are read, nothing is kept, no server starts; then it goes on")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=TARGET / "release/skyglow")
    parser.add_argument("--scenes", type=pathlib.Path, help="folder of scenes with the demo, which takes a while to make")
    parser.add_argument("--seconds", type=float, default=20, help="of load")
    parser.add_argument("--clients", type=int, default=4)
    parser.add_argument("--azurite", type=pathlib.Path, help="program of Azurite's blob service, in the place of S3")
    options = parser.parse_args()
    work = pathlib.Path(tempfile.mkdtemp(prefix="skyglow-replicas-"))
    try:
        store = start_azurite(work, options.azurite) if options.azurite else start_s3(work)
        redis_port, redis = start_redis(work)
        start = lambda name, wait=True: Server(options, work / name, store, redis_port, wait)
        # The first makes the demo, unless it is there; scenes are copied, as a volume that all mount would bring them.
        if options.scenes:
            (work / "a/data").mkdir(parents=True)
            shutil.copytree(options.scenes, work / "a/data/scenes")
        a = start("a")
        for name in "bcd":
            (work / name / "data").mkdir(parents=True)
            shutil.copytree(work / "a/data/scenes", work / name / "data/scenes")
        b = start("b")
        share_documents(a, b)
        share_scenes(a, b)
        share_drafts_and_rates(a, b)
        a, kept = kill_one_under_load(options, a, b, start)
        lose_redis(redis, a, b)
        hang_store(store[2], start, b, kept)
        say("passed")
    finally:
        for process in STARTED:
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.kill()
                process.wait()
        shutil.rmtree(work, ignore_errors=True)


if __name__ == "__main__":
    main()
