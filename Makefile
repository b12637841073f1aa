# Two commands are enough: `make demo` and `make test`; while you work, `make check`. Each sets itself up.

PYTHON ?= $(shell sh tools/find-python)
BIN := .venv/bin
CHECKED := src tests benchmarks tools
SPELT := *.md changelog.d docs examples src ui/src benchmarks tools ros
# The tests start hundreds of commands: each would be compiled anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup demo demo-ros lint check peers compiled test test-full test-page test-oldest test-fresh release calibrate prognostics new-user docs fuzz integrity soak bench clean
.DEFAULT_GOAL := help

help:
	@echo "make demo       a synthetic robot works for a day: its health as a report, and live on a page"
	@echo "make demo-ros   the case study live: a simulated robot over real ROS 1, or over DDS (ROS=2)"
	@echo "make check      lint, types, floors, and the tests that your change touches: a minute"
	@echo "make test       all checks and tests"
	@echo "make test-full  what takes long too, and the peers that pip can install, half an hour"
	@echo "make test-page  the page: what people come for in two clicks, and all its pictures (demo-output/pages), ten minutes"
	@echo "make test-oldest  with the oldest versions that pyproject.toml allows, half an hour"
	@echo "make test-fresh both commands on machines that have nothing (as root; docs/fresh-machines.md)"
	@echo "make release    the latest commit in dist/: wheel and sdist, what is in them (SBOM), SHA-256, some minutes"
	@echo "make calibrate  predictions against 20,000 robots that fail and 1,000 that wear (docs/calibration.md)"
	@echo "make fuzz       1,800,000 damaged recordings, hours (docs/guides/columns.md)"
	@echo "make integrity  1,000 kills and 1,000 cuts of power, an hour or less (docs/guides/unattended.md)"
	@echo "make soak       two days of a robot at 600 times their pace, over ROS 1 and over DDS, ten minutes"
	@echo "make prognostics  when real wear ends, beside SurPyval, two minutes (docs/theory/wear.md)"
	@echo "make new-user  from a wheel to the first report of five robots, two minutes (docs/guides/your-robot.md)"
	@echo "make docs       the documentation as a site, searchable and without a network, build/book/site; ten seconds"
	@echo "make bench      speed, as ratios against named peers (docs/benchmarks.md)"
	@echo "make clean      remove what the others made"

setup:
	@sh tools/setup "$(PYTHON)"
	@$(BIN)/python hatch_build.py || true

demo: setup
	@$(BIN)/robophm demo --to demo-output

demo-ros: setup peers
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[sim]"
	@$(BIN)/python examples/ota/live/demo.py $(ROS)

lint: setup
	$(BIN)/ruff format --check $(CHECKED)
	$(BIN)/ruff check $(CHECKED)
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell $(SPELT)

check: lint
	@$(BIN)/python tools/touched_tests.py $(if $(SECONDS),--seconds $(SECONDS))

peers:
	@sh tools/ros-peers
	@sh tools/browser

# Each of the processes that share the tests would compile all of them; what is wrong in one it is told by them.
compiled: setup
	@$(BIN)/pytest --collect-only -qq >/dev/null 2>&1 || true

# Checks and downloads go on beside each other. A test that hangs is a failed one: the slowest takes half a minute.
test: setup
	@$(MAKE) --no-print-directory --jobs 3 --output-sync=target lint peers compiled
	$(BIN)/pytest -n 3 --timeout 240 --durations=10 --durations-min=1

# `make test` has a twenty-fifth of the calibration, by a fixed seed, and skips the peers of the extra `peers`.
test-full: setup
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[peers,docs]"
	EXAMPLES=all $(MAKE) test calibrate
	EXAMPLES=all $(BIN)/pytest -n 2 -m full

test-page: setup
	@sh tools/browser
	$(BIN)/pytest -s tests/web/page/scripted_visit.py

test-fresh:
	@sh tools/test-fresh

test-oldest: setup
	@sh tools/test-oldest "$(BIN)/python"

release:
	@sh tools/release "$(PYTHON)"

fuzz: setup
	@$(BIN)/python -m tests.transports.recordings.columns.fuzz

integrity: setup peers
	@$(BIN)/python -m tests.integrity

soak: setup peers
	@$(BIN)/python -m tests.integrity.soak $(if $(HOURS),--hours $(HOURS))

calibrate: setup
	@$(BIN)/python -m benchmarks.honesty; chance=$$?; $(BIN)/python -m benchmarks.worn_honesty || chance=1; \
		$(BIN)/python -m benchmarks.replacement_advice && exit $$chance

prognostics: setup
	@$(BIN)/python -m benchmarks.prognostics --peers

new-user: setup
	@$(BIN)/python -m tests.drafting.new_user

docs: setup
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[docs]"
	@PYTHONPATH=tools $(BIN)/python -m book

bench: setup
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[bench]"
	@test -d .venv/peers/ramstk || $(BIN)/python -m pip install --quiet --disable-pip-version-check \
		--constraint constraints.txt --no-deps --target .venv/peers ramstk pypubsub
	$(BIN)/python -m benchmarks
	$(BIN)/python -m benchmarks.fault_trees --peer

clean:
	rm -rf .venv ui/node_modules src/robophm/web/static demo-output dist build .cache .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
