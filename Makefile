# make demo    one curve edited in three representations: installs, runs, says where the picture is
# make test    everything that is checked: lint, types, tests; .ci/run calls it
# make picture the picture of the README, from examples/cat.toml
# make gallery docs/gallery.md and its pictures, from the scripts that it shows
# make bench   measures everything beside its peers: docs/performance.md and .svg (about five minutes)
# make bench-full   the same up to a million vertices
# make bench-check  measures a quick part again; fails when a ratio lost more than a third
# make types   pyright beside mypy (fetches Node.js once)
# make clean   removes the virtual environment and what was built
#
# Needs Python >= 3.11 with venv and network access to a package index; a C compiler and Python's headers
# make edits five to eight times as fast. Another Python: make PYTHON=python3.13 test

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo test lint types picture gallery bench bench-full bench-check clean

demo: $(VENV)/demo.stamp
	$(BIN)/multirep run examples/cat.toml --out cat-out
	@echo
	@echo "The picture is $(CURDIR)/cat-out/cat.svg - open it in a browser."

test: lint
	$(BIN)/python -m pytest -q --slow -n auto --dist loadfile

lint: $(VENV)/test.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

types: $(VENV)/test.stamp
	$(BIN)/pip install -q pyright
	$(BIN)/pyright --pythonpath $(BIN)/python

picture: $(VENV)/demo.stamp
	$(BIN)/multirep render examples/cat.toml -o docs/cat.svg

gallery: $(VENV)/demo.stamp
	$(BIN)/python docs/make_gallery.py

bench: $(VENV)/bench.stamp
	$(BIN)/python -m benchmarks run

bench-full: $(VENV)/bench.stamp
	$(BIN)/python -m benchmarks run --full

bench-check: $(VENV)/bench.stamp
	$(BIN)/python -m benchmarks check

$(VENV)/demo.stamp: pyproject.toml setup.py $(wildcard core/*) multirep/splines/_core.pyi | $(VENV)/pip.stamp
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install -q -e .
	@touch $@

$(VENV)/test.stamp: pyproject.toml setup.py $(wildcard core/*) multirep/splines/_core.pyi | $(VENV)/pip.stamp
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install -q -e . --group test --group lint --group types
	@touch $@ $(VENV)/demo.stamp

# Peers are optional: the tables name those that this machine cannot install.
$(VENV)/bench.stamp: $(VENV)/demo.stamp
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install -q -e '.[plot]'
	-$(BIN)/python -m pip install -q --group bench
	@touch $@

# pip older than 25.1 does not know --group.
$(VENV)/pip.stamp:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "multirep needs Python >= 3.11; $(PYTHON) is older. Try: make PYTHON=python3.13 $(MAKECMDGOALS)"; exit 1; }
	@$(PYTHON) -m venv $(VENV) || \
		{ echo "$(PYTHON) cannot make a virtual environment; on Debian: apt-get install python3-venv"; exit 1; }
	$(BIN)/python -m pip install -q --upgrade 'pip>=25.1'
	@touch $@

clean:
	rm -rf $(VENV) build dist *.egg-info cat-out multirep/splines/_core.*so multirep/splines/_core.pyd
