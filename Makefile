# Two commands to know: `make serve` and `make test`. Each sets up what it needs.
.PHONY: help serve check test test-browser packs bench measurements stress load soak faults attacks replicas package container fuzz deny viewer qgis standards wheel

help: ## this list
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 16

serve: ## install, build, and serve the demo at http://127.0.0.1:8080
	@scripts/serve.sh

check: ## format, lints and unit tests, in a minute once everything is built
	@scripts/test.sh check

test: ## set up and run what every change must pass, browser tests included
	@scripts/test.sh

test-browser: ## the viewer in a real browser alone
	@scripts/test.sh browser

stress: ## hunt for NaN, negative radiance, jumps and lost digits (minutes; OUT=FILE.json keeps the figures)
	@scripts/stress.sh $(if $(OUT),--out "$(OUT)")

packs: ## rebuild every table pack in precomputed/
	@cargo build --release --package skyglow
	@scripts/make_packs.sh all

bench: ## run time against error on this machine, in minutes: a table, and target/bench with its plots
	@cargo build --release --package skyglow
	@NODEVICE_SELECT="$${NODEVICE_SELECT:-1}" target/release/skyglow bench --packs precomputed --out target/bench \
		$(foreach file,$(wildcard tests/reference/*.json),--reference $(file))

measurements: ## write docs/measurements.md and the README's figures, by this version on this machine (QUICK=1: 5 minutes)
	@NODEVICE_SELECT="$${NODEVICE_SELECT:-1}" scripts/measurements.py $(if $(QUICK),--quick)

load: ## throughput and latency by wrk on loopback, with plain Rust and with lavapipe, in minutes
	@scripts/load.sh

soak: ## a mixed load and the server's memory beside it (MINUTES=20)
	@scripts/soak.sh $(MINUTES)

faults: ## kill it, fill its disk, damage its files, starve its connections, under load
	@scripts/faults.sh

attacks: ## attack a server of its own, and measure what another user has of it (PARTS="F2 F6", SECONDS=60)
	@cargo build --release --package skyglow
	@NODEVICE_SELECT="$${NODEVICE_SELECT:-1}" scripts/attacks.py --seconds $(or $(SECONDS),60) $(PARTS)

replicas: ## two servers over an S3 server and Redis, one killed under load: is anything lost? (minutes; installs both)
	@cargo build --release --package skyglow
	@NODEVICE_SELECT="$${NODEVICE_SELECT:-1}" scripts/replicas.py

package: ## a Debian package and a tarball of the program with its packs, in target/package
	@deploy/debian/package.sh

container: ## build the image's root file system without a container engine and start it as one would (as root)
	@deploy/container/test.sh

fuzz: ## bytes that nobody meant to every parser (SECONDS=60 each; installs the nightly compiler if it is missing)
	@scripts/fuzz.sh $(SECONDS)

qgis: ## the QGIS plugin in QGIS, with and without a window (installs Debian's QGIS; TESTS=test_algorithms.Sky picks)
	@cargo build --release --package skyglow
	@scripts/qgis_plugin.sh $(TESTS)

standards: ## the server by OGC's schemas and abstract tests, STAC, COG, CoverageJSON and CF (fetches validators and schemas once)
	@cargo build --release --package skyglow
	@scripts/standards.sh

wheel: ## the Python package and its engine as wheels in target/wheels, tried in an empty environment and against a server
	@cargo build --release --package skyglow
	@scripts/python_wheel.sh

deny: ## licences, bans, duplicates, sources and known weaknesses of every dependency (cargo-deny)
	@scripts/dependencies.sh

viewer: ## rebuild web/dist, the viewer's built form, from its sources
	@scripts/system_packages.sh test
	@cd web && ../scripts/with_node.sh npm ci --no-audit --no-fund && ../scripts/with_node.sh npm run build
