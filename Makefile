# One command for each thing that a newcomer or a machine wants. `make demo` and `make test` set up by themselves.
#
# PYTHON chooses the interpreter (3.11 or later), OUT where the demo writes, JOBS how many test processes run.

PYTHON ?= $(shell for it in python3 python3.11 python3.12 python3.13 python3.14; do \
	$$it -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$it; break; }; done)
OUT ?= out
JOBS ?= 2
MISSIONS := line circles interlocks faults pursuit thesis steering_failed stuck left_failed video survey

BIN := .venv/bin
READY := .venv/.ready
MEASURED := .venv/.measured
# The robots among them; the example of a device family is installed beside the product by its own test, as its
# user would: the product knows none of its names.
EXAMPLES := $(patsubst %/pyproject.toml,%,$(shell grep -L '"firmware_bridge.families"' examples/*/pyproject.toml))
BESIDE := validation $(EXAMPLES)
COMPILED := .venv/compiled
INSTALLED := .venv/installed
RELEASE := .venv/.release
BRIDGE := $(BIN)/firmware-bridge

# Each library's name when pip turns to it, in place of pip's five lines about it.
FETCHED := awk '/^Collecting /{ sub(/[^[:alnum:]_.-].*/, "", $$2); at += length($$2) + 1; \
	if (at > 100) { printf "\n"; at = length($$2) + 1 } printf " %s", $$2; fflush() } \
	/^Building wheels? for/{ if (!built++) { printf "\nsetup: compiling what has to be compiled\n"; at = 0; fflush() } } \
	/^Installing collected/{ printf "\nsetup: installing all of it\n"; at = 0; fflush() }'

# The live page's plots: npm's package, by its lock file, beside the page; without npm the page shows values alone.
define UPLOT
if command -v npm >/dev/null && npm ci --prefix tools/uplot --silent --no-audit --no-fund >/dev/null 2>&1; then \
	cp tools/uplot/node_modules/uplot/dist/uPlot.iife.min.js firmware_bridge/live/uplot.js && \
	cp tools/uplot/node_modules/uplot/dist/uPlot.min.css firmware_bridge/live/uplot.css && \
	cp tools/uplot/node_modules/uplot/LICENSE firmware_bridge/live/uplot.LICENSE; \
else echo "setup: without npm, or its registry, the live page has no plots"; fi
endef

# Each plant that is installed, and the name of each when it is there; who drives would wait for them else.
# The sources' other models are built where they are used: no shipped robot stands on one.
define PLANTS
import sys
from fmu.build import ensure
from fmu.plants import find, names
for name in names():
    if not find(name).package.startswith("validation."):
        ensure(name, int(sys.argv[1]))
        print(f" {name}-{sys.argv[1]}", end="", flush=True)
endef
export PLANTS

TESTED = @begun=$$(date +%s); \
	$(TESTER) -m pytest -n $(JOBS) --dist worksteal -q $(LANE); status=$$?; \
	$(ALSO) echo "$@: $$(( $$(date +%s) - begun )) s"; exit $$status

# In a container that forbids bytecode each process would compile all sources again.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
SHELL := bash
.PHONY: help setup compiled installed wheels same demo studies test long nightly test-all check docs site golden bench \
	adversary fuzz compare-sketch mutants hour clean

help: ## list these commands
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' Makefile

setup: $(READY) ## make .venv with the program and everything that its tests need

$(READY): pyproject.toml setup.py $(wildcard emulators/servo/native/*.[ch] $(BESIDE:%=%/pyproject.toml))
	@[ -n "$(PYTHON)" ] || { echo "setup: no Python 3.11 or later found; install one, or name it: make PYTHON=python3.11 ..." >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "setup: $(PYTHON) is not Python 3.11 or later; name another one: make PYTHON=python3.11 ..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
		{ echo "setup: $(PYTHON) has no venv module; on Debian or Ubuntu: apt-get install python3-venv" >&2; exit 1; }
	@command -v "$${CC:-cc}" >/dev/null || command -v gcc >/dev/null || command -v clang >/dev/null || \
		{ echo "setup: no C compiler found (the plants are built from C); on Debian or Ubuntu: apt-get install gcc libc6-dev" >&2; exit 1; }
	@echo "setup: two minutes or three, once; what is made is in .venv, and the plants in ~/.cache"
	@echo "setup: 1 of 4, a virtual environment with $$($(PYTHON) --version)"
	@[ -x $(BIN)/python ] || $(PYTHON) -m venv .venv
	@echo "setup: 2 of 4, pip 25.1 or later"
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
	@# The example's name until 0.1.0: its entry points would name a folder that is gone.
	@$(BIN)/python -m pip uninstall --quiet --quiet --yes carrier
	@echo "setup: 3 of 4, the program, the libraries that it needs, and those that its tests need"
	@set -o pipefail; $(BIN)/python -m pip install --disable-pip-version-check --progress-bar off \
		--editable ".[plants,plots]" $(BESIDE:%=--editable %) --group dev 2>&1 | tee .venv/pip.log | $(FETCHED) || \
		{ echo "setup: pip failed; its output:" >&2; cat .venv/pip.log >&2; exit 1; }
	@echo "setup: 4 of 4, the plants: from their equations to C, and compiled, for FMI 2.0 and 3.0"
	@printf '%s\n' 2 3 | xargs -n 1 -P 2 $(BIN)/python -c "$$PLANTS" && echo
	@$(UPLOT)
	@echo "setup: done"
	@touch $@

# It takes the libraries, and the tests, from here; the program itself is its own.
$(COMPILED)/.ready: $(READY) $(shell find firmware_bridge emulators fmu -name '*.py')
	@$(BIN)/python -c 'import pathlib, sysconfig, sys; sys.exit(not pathlib.Path(sysconfig.get_path("include"), "Python.h").exists())' || \
		{ echo "compiled: Python's headers are missing; on Debian or Ubuntu: apt-get install python3-dev" >&2; exit 1; }
	@echo "compiled: translating the core to C; this takes two minutes or three"
	@rm -rf dist/wheel
	@FIRMWARE_BRIDGE_COMPILE=1 FIRMWARE_BRIDGE_PLANTS=1 $(BIN)/python -m pip wheel --quiet \
		--disable-pip-version-check --no-deps --wheel-dir dist/wheel .
	@rm -rf build
	@[ -x $(COMPILED)/bin/python ] || $(BIN)/python -m venv --without-pip $(COMPILED)
	@$(BIN)/python -m pip --python $(COMPILED)/bin/python install --quiet \
		--disable-pip-version-check --no-deps --force-reinstall dist/wheel/*.whl
	@$(BIN)/python -c 'import site; print(site.getsitepackages()[0]); [print(f"$(CURDIR)/{it}") for it in ". $(EXAMPLES)".split()]' > \
		"$$($(COMPILED)/bin/python -c 'import site; print(site.getsitepackages()[0])')/checkout.pth"
	@touch $@

# What may come out otherwise where the core is compiled: what is on the wires, states put back, sessions played again.
same: $(COMPILED)/.ready ## test that the compiled core gives the same bits
	@$(COMPILED)/bin/python -P -m pytest -n $(JOBS) --dist worksteal -q -m 'not interpreted and not long' \
		hil_tests/golden hil_tests/scenarios/test_golden_traces.py hil_tests/scenarios/test_re*.py hil_tests/wire \
		hil_tests/stability hil_tests/unit/cia402 hil_tests/unit/epos2_serial hil_tests/unit/imu hil_tests/unit/rewind \
		hil_tests/unit/world

compiled: $(COMPILED)/.ready ## install the program with its core compiled, in .venv/compiled

# The installation of a user: the wheel, and pytest.
$(INSTALLED)/.ready: $(COMPILED)/.ready
	@rm -rf $(INSTALLED)
	@$(BIN)/python -m venv $(INSTALLED)
	@$(INSTALLED)/bin/python -m pip install --quiet --disable-pip-version-check "$$(ls dist/wheel/*.whl)[testing]"
	@touch $@

installed: $(INSTALLED)/.ready ## install this machine's wheel in an environment of its own, .venv/installed

wheels: ## make the release, in dist/: a wheel for this machine, one for any, sources, SBOM
	@echo "wheels: this takes seven minutes; the core is translated to C, once"
	@$(MAKE) --no-print-directory $(RELEASE) $(COMPILED)/.ready
	@rm -rf dist/*.whl dist/any dist/*.tar.gz dist/*.json .venv/bare
	@cp dist/wheel/*.whl dist/
	@FIRMWARE_BRIDGE_COMPILE=0 $(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist/any .
	@rm -rf build
	@$(BIN)/python -m build --sdist --outdir dist . > dist/sources.log || { cat dist/sources.log; exit 1; }
	@$(BIN)/python -m venv .venv/bare
	@.venv/bare/bin/python -m pip install --quiet --disable-pip-version-check dist/*.whl
	@$(BIN)/cyclonedx-py environment --pyproject pyproject.toml --output-reproducible --of JSON -o dist/sbom.cdx.json \
		.venv/bare/bin/python
	@rm -rf .venv/bare
	@ls dist/*.whl dist/any/*.whl dist/*.tar.gz dist/*.json

demo: $(READY) ## drive the shipped missions in virtual time; results in out/
	@begun=$$(date +%s); \
	for mission in $(MISSIONS); do \
		echo "demo: driving the mission '$$mission' in virtual time, into $(OUT)/rars-$$mission/"; \
		$(BRIDGE) bench rars --mission $$mission --out $(OUT)/rars-$$mission || exit $$?; \
	done; \
	echo "demo: $(MISSIONS) driven in $$(( $$(date +%s) - begun )) s; tables, plots and recordings are in $(OUT)/rars-*/"

studies: $(READY) ## reproduce the sources' figures and numbers; one page, in out/studies
	@$(BRIDGE) study all --out $(OUT)/studies

# Two lanes that together contain all tests: a test checks it. Each skips what this machine's kernel lacks.
# Of Hypothesis's tests the first draws a tenth of the examples, and the second all of them again.
test: LANE := -m 'not long' --hypothesis-profile=first-lane --ignore=hil_tests/architecture
test: TESTER := $(BIN)/python
test: $(READY) ## run the tests, each behavior once; `make check` checks the sources
	$(TESTED)

# Three times as fast there, and the compiled core is what `make same` shows to be the same.
long: LANE = -m '(long or hypothesis) and not interpreted' --ignore=hil_tests/architecture $(SHARE:%=-p hil_tests.lanes --share %)
long: TESTER := $(COMPILED)/bin/python -P
long: ALSO = $(BIN)/python -m pytest -n $(JOBS) --dist worksteal -q -m '(long or hypothesis) and interpreted' \
	--ignore=hil_tests/architecture $(SHARE:%=-p hil_tests.lanes --share %) || test $$? = 5 || status=1;
long: $(COMPILED)/.ready ## run the long tests, or a share of them: make long SHARE=3/20
	$(TESTED)

# Takes hours: all on one commit, step by step; an interrupted run continues where it was.
nightly: $(COMPILED)/.ready ## run everything that .ci/run omits; hours, can be interrupted; docs/nightly.md has the results
	@$(BIN)/python tools/nightly.py

test-all: test long ## run every test

check: $(READY) ## lint, format, types, import contracts, documents in step
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports
	@$(BIN)/python -m pytest -q -n $(JOBS) hil_tests/architecture

site: $(READY) ## the documentation as a site, in build/site; every warning is an error
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --group site
	@$(BIN)/sphinx-build -q -W --keep-going -E -c tools/site docs build/site
	@echo "site: build/site/index.html"

docs: $(READY) ## write the pages of docs/ that are generated from the code's tables
	@$(BIN)/python tools/make_docs.py

golden: $(READY) ## renew the reference traces, after an intended change of the bytes on the wires
	@$(BIN)/python tools/golden_traces.py --renew

$(RELEASE): $(READY)
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --group release
	@touch $@

$(MEASURED): $(READY)
	@$(BIN)/python -m pip install --quiet --quiet --disable-pip-version-check --group bench
	@touch $@

bench: $(MEASURED) $(COMPILED)/.ready ## measure how fast the bench is, what it costs, and against what; three minutes
	@$(COMPILED)/bin/python -P -m benchmarks

ROBOT ?= rars
HOURS ?= 1
PROFILES ?= honest
SEED ?= 0
adversary: $(COMPILED)/.ready ## search HOURS simulated hours for violations of a rule of ROBOT; results in out/adversary
	@$(COMPILED)/bin/python -P -m hil_tests.adversary $(ROBOT) --hours $(HOURS) --profiles $(PROFILES) --seed $(SEED)

FRAMES ?= 1000000
fuzz: $(COMPILED)/.ready ## let a foreign node send a drive FRAMES random frames, its winding's current monitored
	@FOREIGN_FRAMES=$(FRAMES) $(COMPILED)/bin/python -P -m pytest -q -p no:xdist -m long hil_tests/unit/epos2/test_foreign_node_bursts.py

LINES ?= 100000
compare-sketch: $(READY) ## send LINES lines to the sketch's binary in simavr and to the emulated board, and compare
	@$(BIN)/python -m hil_tests.interop.simavr $(LINES)

mutants: $(READY) ## break the program in one place at a time, for new results; hours, can be interrupted
	@$(BIN)/python tools/mutate.py -j $(JOBS)

hour: $(READY) ## drive a simulated hour and watch the memory, and another and look for false alarms
	@$(BIN)/python -m benchmarks.memory 60
	@$(BIN)/python -m benchmarks.memory 10 --live
	@$(BIN)/python -m benchmarks.false_alarms 60

clean: ## remove what was built and measured; .venv stays
	rm -rf build dist out .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
