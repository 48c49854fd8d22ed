# The only commands anyone must know. `make help` lists them.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/pip --disable-pip-version-check --quiet

# One BLAS thread: our matrices are small, and two threads are slower than one (evidence in docs/verification.md).
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export MKL_NUM_THREADS := 1

.DEFAULT_GOAL := help
.PHONY: help demo gallery live app window pages test lint types layers security kernels unit servers bench qualify docs pictures lock clean

help: ## list the commands
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-9s %s\n", $$1, $$2}'

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo 'jackettwin needs Python 3.11 or newer; set PYTHON=/path/to/python3'; exit 2; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/.core: requirements.lock pyproject.toml | $(BIN)/python
	$(PIP) install -r requirements.lock
	$(PIP) install --no-deps -e .
	@touch $@

$(VENV)/.dev: requirements-dev.lock $(VENV)/.core
	$(PIP) install -r requirements-dev.lock
	@touch $@

demo: $(VENV)/.core ## digital twin of a 15 MW jacket from an OpenFAST record: out/demo/report.html
	$(BIN)/jackettwin run --out out/demo

gallery: $(VENV)/.core ## the figures of the thesis, recomputed: out/gallery/gallery.html
	PYTHONPATH=scripts $(BIN)/python -m gallery

live: $(VENV)/.live window ## a foundation lives: http://127.0.0.1:8470/, its records arrive in fast motion
	$(BIN)/jackettwin serve out/live --demo

$(VENV)/.live: requirements-service.lock $(VENV)/.core
	$(PIP) install -r requirements-service.lock
	@touch $@

app: app/node_modules/.installed ## the window, a browser's pages of the service, from app/ (Node 20 or newer)
	cd app && npm run --silent build
	cd app/src && find . -type f ! -name schema.d.ts | LC_ALL=C sort | xargs cat | sha256sum > ../../src/jackettwin/service/window/source

app/node_modules/.installed: app/package.json app/package-lock.json
	cd app && npm ci --silent && touch node_modules/.installed

NPM := $(shell command -v npm)
ifdef NPM
window: app
pages: app $(VENV)/.dev # the window: types against the API of this source, style, tests
	$(BIN)/python scripts/write_openapi.py app/openapi.json
	cd app && npm run --silent schema && npm run --silent check
else
window pages:
	@echo 'Node 20 or newer is not installed: the window is not built; the service says so'
endif

test: $(VENV)/.dev ## everything CI checks
	@$(MAKE) --no-print-directory --jobs=3 --output-sync=target servers kernels types lint layers security pages
	@$(MAKE) --no-print-directory unit

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.dev
	$(BIN)/mypy

layers: $(VENV)/.dev
	$(BIN)/lint-imports

COMPILING := response/test_numbered.py sensing/test_smoother.py loads/test_rotor.py watching/test_level.py
COMPILING += watching/test_memory.py simulate/test_simulate.py::test_turbines_stay_bounded_and_lean_downwind
kernels: $(VENV)/.dev # compiled once here, and not by each worker of the tests for itself
	$(BIN)/pytest -p no:xdist $(COMPILING:%=tests/%)

unit: $(VENV)/.dev servers # on two cores three workers: tests of servers wait often
	$(BIN)/pytest -n 3 --dist loadfile --no-loadscope-reorder

servers: # PostgreSQL, mosquitto, Chromium for tests that use the real ones; skipped where they cannot be installed
	@scripts/install-servers

security: $(VENV)/.dev # known holes of what we install, where the index can be asked; habits of our own code
	$(BIN)/bandit -q -r src/jackettwin/service src/jackettwin/store -ll
	@timeout 60 $(BIN)/pip-audit --timeout 5 -r requirements-service.lock --no-deps --disable-pip --progress-spinner off || echo "pip-audit: the index of known holes cannot be asked, or names one (above)"

bench: $(VENV)/.dev ## speed, on this machine
	@for file in benchmarks/bench_*.py; do echo "$$file"; $(BIN)/python $$file || exit 1; done

qualify: $(VENV)/.dev ## statistics at full size, to docs/verification (takes hours)
	@for file in qualify/*.py; do echo "$$file"; $(BIN)/python $$file || exit 1; done

lock: | $(BIN)/python ## refresh the lock files from pyproject.toml
	$(PIP) install pip-tools
	$(BIN)/pip-compile -q --strip-extras --no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header --extra fatigue --output-file requirements.lock pyproject.toml
	$(BIN)/pip-compile -q --strip-extras --no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header --extra fatigue --extra service --extra postgresql --constraint requirements.lock --output-file requirements-service.lock pyproject.toml
	$(BIN)/pip-compile -q --strip-extras --no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header --extra fatigue --extra service --extra postgresql --extra dev --extra docs --extra bench --constraint requirements-service.lock --output-file requirements-dev.lock pyproject.toml

pictures: $(VENV)/.dev ## the documentation's pictures, drawn anew by the program
	PYTHONPATH=scripts $(BIN)/python -m pictures

docs: $(VENV)/.dev ## the documentation, to site/
	$(BIN)/mkdocs build --quiet --strict

clean: ## remove everything built
	rm -rf $(VENV) build dist site out app/node_modules src/jackettwin/service/window .mypy_cache .ruff_cache .pytest_cache
