# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause

# Needs Python 3.11 or newer, pip and make; everything else goes into .venv.

PYTHON ?= python3
BIN := .venv/bin
RUN := $(BIN)/python
CODE := source scripts tests docs/conf.py docs/_ext

.PHONY: help setup demo test test-all lint format docs assets clean
.DEFAULT_GOAL := help

help:
	@echo "make demo      set up, train for a few iterations, film the policy that comes with ARCGym"
	@echo "make test      set up, lint, run the fast tests"
	@echo "make test-all  lint and run every test"
	@echo "make lint      ruff and mypy"
	@echo "make format    let ruff format the code"
	@echo "make docs      build the documentation into docs/_build/html"
	@echo "make assets    make every file of assets/usd anew"
	@echo "make clean     remove caches and build outputs, keep .venv and logs"

setup:
	@$(PYTHON) scripts/setup_venv.py

demo: setup
	@$(RUN) scripts/demo.py

test: lint
	$(RUN) -m pytest -q -n 2 --dist loadfile -m "not slow"

test-all: lint
	$(RUN) -m pytest -q

lint: setup
	$(BIN)/ruff check $(CODE)
	$(BIN)/ruff format --check $(CODE)
	$(BIN)/mypy

format: setup
	$(BIN)/ruff check --fix-only $(CODE)
	$(BIN)/ruff format $(CODE)

docs: setup
	$(RUN) -m sphinx -W --keep-going -q -b html docs docs/_build/html
	@echo "documentation: $(CURDIR)/docs/_build/html/index.html"

assets: setup
	$(RUN) scripts/tools/author_assets.py

clean:
	rm -rf docs/_build docs/api docs/reference .mypy_cache .pytest_cache .ruff_cache build dist
