# sculler: every target does its own set-up (a virtual environment in .venv).
#   make demo    the main job end to end, files and pictures in build/demo
#   make test    lint and all tests
#   make lint    formatter, linter, type checker, import directions
#   make bench   speeds, medians of several runs
#   make accuracy  docs/accuracy.md and its pictures: the papers' figures beside ours
#   make hardware  docs/hardware.md and its pictures: real place-and-route, about half an hour
#   make clean   remove what the targets made

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready

.PHONY: demo test lint format bench accuracy hardware clean setup
.DEFAULT_GOAL := demo

setup: $(READY)

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
	  { echo "sculler needs Python 3.10 or newer: make PYTHON=python3.x" >&2; exit 2; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	  { echo "$(PYTHON) has no venv module: on Debian, apt-get install python3-venv" >&2; exit 2; }
	$(PYTHON) -m venv --clear $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

demo: $(READY)
	$(BIN)/sculler demo

test: lint
	$(BIN)/pytest -n auto --dist worksteal

lint: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	@# Python 3.10 ends at numpy 2.2, whose annotations are looser than those we are checked against
	@if $(BIN)/python -c 'import sys; sys.exit(sys.version_info < (3, 11))'; \
	  then echo $(BIN)/mypy; $(BIN)/mypy; else echo "mypy: left out on Python 3.10"; fi
	$(BIN)/lint-imports

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: $(READY)
	$(BIN)/python -m sculler.bench

accuracy: $(READY)
	$(BIN)/python -m sculler.accuracy

hardware: $(READY)
	$(BIN)/python -m sculler.hardware

clean:
	rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find build -mindepth 1 ! -name README.md -delete
