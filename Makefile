# `make` prints this help.
SHELL := /bin/bash
PYTHON ?= $(shell for p in python3.12 python3.11 python3.13 python3; do \
	$$p -c 'import sys; sys.exit(not (3,11) <= sys.version_info[:2] < (3,14))' 2>/dev/null \
	&& echo $$p && break; done)
BIN := .venv/bin
PORT ?= 8080
# Tests of one file share bodies and meshes, so they stay together, in the order of tests/conftest.py.
PARALLEL := -n auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder
# A process for each core: their threads would only wait for each other.
ALONE := OMP_NUM_THREADS=1

.DEFAULT_GOAL := help
.PHONY: help setup run test check demo bench docs first looks format lock browser clean

help: ## Print this help
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "make %-8s %s\n", $$1, $$2}'

setup: .venv/runtime.stamp ## Make .venv with the workbench command in .venv/bin

.venv/python.stamp:
	@test -n "$(PYTHON)" || { echo "Python 3.11, 3.12 or 3.13 is needed; install one or set PYTHON=..."; exit 2; }
	$(PYTHON) -m venv .venv
	@touch $@

.venv/runtime.stamp: .venv/python.stamp requirements.lock pyproject.toml
	$(BIN)/python -m pip install --quiet $$($(BIN)/python .ci/torch_index.py) \
		--requirement requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	@touch $@

.venv/dev.stamp: .venv/runtime.stamp requirements-dev.lock
	$(BIN)/python -m pip install --quiet --requirement requirements-dev.lock
	@touch $@

run: setup ## Open the workbench on 127.0.0.1:8080 with the finger loaded
	$(BIN)/workbench serve --port $(PORT)

demo: setup ## The whole chain without a browser, into out/demo
	$(BIN)/workbench run geltip --indenter sphere --size-mm 6 --target 0,10,35 --depth-mm 1.0 \
		--frames 10 --out out/demo

test: .venv/dev.stamp browser ## Install what tests need and pass every test
	@# A server and a browser want more than a core: those tests run after the others.
	$(ALONE) $(BIN)/python -m pytest $(PARALLEL) -m "not ui" --durations=15; others=$$?; \
	CHROMIUM="$$(bash .ci/chromium)" $(ALONE) $(BIN)/python -m pytest $(PARALLEL) -m ui --durations=15 \
		&& exit $$others

check: .venv/dev.stamp ## Lint, format, types, fast tests
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(ALONE) $(BIN)/python -m pytest -q $(PARALLEL) -m "not slow and not ui and not gpu"

bench: .venv/dev.stamp browser ## Print the benchmark table
	@CHROMIUM="$$(bash .ci/chromium)" $(BIN)/workbench bench all

browser:
	@bash .ci/chromium >/dev/null

docs: setup ## Write the pages that are made from the program
	$(BIN)/python -m docs.generate

first: setup ## Make the results that ship with the program anew, a minute or two
	$(BIN)/python -m docs.first_results

looks: .venv/dev.stamp browser ## Photograph every page in all sizes, list what overlaps, is cut or faint
	@CHROMIUM="$$(bash .ci/chromium)" $(BIN)/python -m docs.looks

format: .venv/dev.stamp ## Format and sort imports
	$(BIN)/ruff check --fix-only
	$(BIN)/ruff format

lock: .venv/dev.stamp ## Resolve dependencies anew into the lock files
	$(BIN)/python .ci/lock.py

clean: ## Remove what make made; results under .workbench stay
	rm -rf .venv out build dist *.egg-info
