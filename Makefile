# sculler: every target does its own set-up (a virtual environment in .venv).
#   make demo    the main job end to end, files and pictures in build/demo
#   make test    lint and the tests of every change, some five minutes on two cores
#   make test-deep  all tests, those of a release too, within an hour
#   make test-breaks  faults made on purpose, and which test finds each (docs/explanation/testing.md)
#   make test-lowest  the tests of what depends on others, with every dependency at its floor
#   make fuzz SEED=1 N=5000  corrupted inputs of every verb; findings in build/fuzz
#   make lint    formatter, linter, type checker, import directions
#   make bench   speeds, medians of several runs
#   make accuracy  docs/explanation/accuracy.md and its pictures: the papers' figures beside ours
#   make campaigns docs/explanation/campaign-speed.md: how long a thousand flights take, half an hour
#   make budget    docs/explanation/error-budget.md: error budgets of 1 and 0.1 nmi/h flown, some minutes
#   make buses     docs/explanation/bus-area.md: area and rate of each bus, some minutes
#   make channels  docs/explanation/channels.md: area and rate of a core with 1 to 1024 channels, some minutes
#   make memories  docs/explanation/memories.md: which memories become block memory, some minutes
#   make host-c    docs/explanation/host-in-c-targets.md: the host in C for small processors, a minute
#   make soc       docs/explanation/chip.md: the whole chip flies a log in Verilator, and is placed; a quarter of an hour
#   make hardware  docs/explanation/hardware.md and its pictures: real place-and-route; half an hour or more, goes on where it stopped
#   make upsets    docs/explanation/hardening.md: bits of running cores turned over, one by one; an hour
#   make evidence  docs/explanation/evidence.md and build/evidence.json: requirements with their design, tests and proofs
#   make prove   docs/explanation/proof.md: port contract and arithmetic of small cores; hours, goes on where it stopped
#   make mutate  docs/explanation/mutants.md: changed cores against the test bench that is handed out; hours, goes on where it stopped
#   make mutate-python  docs/explanation/mutants-python.md: the Python changed in one place at a time, and whether its tests see it
#   make docs    the site of docs/ in build/site, without warnings; DOCS_FLAGS=... for MkDocs
#   make release-check  wheel and sdist, built and tried outside the tree; they stay in build/release
#   make clean   remove what the targets made

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
TOOLS  := $(VENV)/.tools-ready
DOCS   := $(VENV)/.docs-ready

.PHONY: demo docs test quick test-deep test-breaks test-lowest fuzz lint format bench accuracy hardware budget campaigns buses channels memories host-c soc upsets evidence prove mutate mutate-python release-check clean setup
.DEFAULT_GOAL := demo

setup: $(READY) $(TOOLS)

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
	  { echo "sculler needs Python 3.10 or newer: make PYTHON=python3.x" >&2; exit 2; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	  { echo "$(PYTHON) has no venv module: on Debian, apt-get install python3-venv" >&2; exit 2; }
	$(PYTHON) -m venv --clear $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

# Yosys and nextpnr are WebAssembly, which is translated once, when they first start: a minute
$(TOOLS): $(READY)
	for tool in yosys nextpnr-ecp5 nextpnr-ice40; do $(BIN)/yowasp-$$tool --version >/dev/null 2>&1; done
	@touch $@

demo: $(READY)
	$(BIN)/sculler demo

# compiled tests are kept, or each worker would rewrite them all
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/pytest -n auto --dist worksteal

# side by side: the type checker takes one core
test:
	@$(MAKE) --no-print-directory --jobs=2 lint quick

# what fails beside others is tried once more by itself: a fault fails again
AGAIN := --last-failed --last-failed-no-failures none

quick: $(TOOLS)
	$(PYTEST) -m "not deep" </dev/null || $(BIN)/pytest -m "not deep" $(AGAIN) </dev/null

test-deep: lint $(TOOLS)
	$(PYTEST) </dev/null

test-breaks: $(READY)
	cd tests && ../$(BIN)/python -m breaks

fuzz: SEED ?= 1
fuzz: N ?= 5000
fuzz: $(READY)
	cd tests && ../$(BIN)/python -m fuzz --seed $(SEED) --cases $(N)

# The floors are those of pyproject.toml, found by uv.  First without any extra, then with all.
LOWEST := .venv-lowest
UV     := $(LOWEST)/bin/uv pip install --quiet --python $(LOWEST)/bin/python
EXTRAS := sim,plots,formats,campaign,fast,frames,place,soc,package

test-lowest:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info >= (3, 13))' || \
	  { echo "the floors have no wheels for this Python: make test-lowest PYTHON=python3.11" >&2; exit 2; }
	$(PYTHON) -m venv --clear $(LOWEST)
	$(LOWEST)/bin/pip install --quiet --disable-pip-version-check 'uv>=0.5,<1'
	$(UV) --resolution lowest-direct --editable .
	$(UV) 'pytest>=8.2,<10' 'pytest-xdist>=3.5,<4' 'hypothesis>=6.100,<7'
	SCULLER_BASE=1 $(LOWEST)/bin/pytest -n auto -q tests/cli/test_base_install.py </dev/null
	$(UV) --resolution lowest-direct --editable '.[$(EXTRAS)]'
	@# old releases use what newer Pythons and each other give up
	$(LOWEST)/bin/pytest -n auto --dist worksteal -q -m "not deep" -W ignore::DeprecationWarning \
	  $(LOWEST_TESTS) </dev/null || \
	  $(LOWEST)/bin/pytest -m "not deep" -W ignore::DeprecationWarning $(AGAIN) $(LOWEST_TESTS) </dev/null

LOWEST_TESTS := tests/model tests/library tests/cli tests/hdl/test_verilog.py tests/sim/test_verilator_build.py \
  tests/sim/test_waves.py tests/sim/test_vectors_file.py --ignore=tests/cli/test_base_install.py

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

# what builds the site is installed when it is first asked for
$(DOCS): $(READY)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

prove: $(TOOLS)
	$(BIN)/python -m studies.prove --write

docs: $(DOCS)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --clean --quiet $(DOCS_FLAGS)

mutate: $(TOOLS)
	$(BIN)/python -m studies.mutate --write

mutate-python: $(READY)
	$(BIN)/python -m studies.mutate_python --draws 4 --write

bench: $(READY)
	$(BIN)/python -m studies.bench

accuracy: $(READY)
	$(BIN)/python -m studies.accuracy

hardware: $(READY)
	$(BIN)/python -m studies.hardware

campaigns: $(READY)
	$(BIN)/python -m studies.campaigns

budget: $(READY)
	$(BIN)/python -m studies.budget

buses: $(READY)
	$(BIN)/python -m studies.bus

channels: $(READY)
	$(BIN)/python -m studies.channels

memories: $(TOOLS)
	$(BIN)/python -m studies.memories

upsets: $(TOOLS)
	$(BIN)/python -m studies.upsets --every-bit

evidence: $(READY)
	$(BIN)/python -m studies.evidence

host-c: $(READY)
	$(BIN)/python -m studies.host_c

soc: $(TOOLS)
	$(BIN)/python -m studies.soc

release-check: $(READY)
	$(BIN)/python tools/release_check.py

clean:
	rm -rf $(VENV) $(LOWEST) .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find build -mindepth 1 ! -name README.md -delete
