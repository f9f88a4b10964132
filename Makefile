# Two commands to know: `make serve` and `make test`. Each sets up what it needs.
.PHONY: help serve test packs viewer

help: ## this list
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

serve: ## install, build, and serve the demo at http://127.0.0.1:8080
	@scripts/serve.sh

test: ## set up and run every check and test, browser tests included
	@scripts/test.sh

packs: ## rebuild every table pack in precomputed/
	@cargo build --release --package skyglow
	@scripts/make_packs.sh all

viewer: ## rebuild web/dist from its sources (needs Node 20 or later)
	@cd web && npm ci --no-audit --no-fund && npm run build
