# Two commands are enough: `make demo` and `make test`. Both set themselves up.

PYTHON ?= $(shell sh tools/find-python)
BIN := .venv/bin
CHECKED := src tests benchmarks

.PHONY: setup demo test test-full lint bench bench-setup clean
.DEFAULT_GOAL := help

help:
	@echo "make demo   a synthetic robot works for a day: its health, live and as a report"
	@echo "make test   all checks and tests"
	@echo "make bench  speed, as ratios against named peers (docs/benchmarks.md)"
	@echo "make clean  remove what the others made"

setup: .venv/ready

.venv/ready: pyproject.toml constraints.txt tools/make-venv
	@sh tools/make-venv "$(PYTHON)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[dev]"
	@touch $@

demo: setup
	@$(BIN)/robophm demo --output demo-output

lint: setup
	$(BIN)/ruff format --check $(CHECKED)
	$(BIN)/ruff check $(CHECKED)
	$(BIN)/mypy
	$(BIN)/lint-imports

test: lint
	$(BIN)/pytest -n 2

test-full: lint
	ROBOPHM_FULL=1 $(BIN)/pytest -n 2

.venv/bench-ready: .venv/ready
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable ".[bench]"
	@touch $@

bench: .venv/bench-ready
	$(BIN)/python -m benchmarks

clean:
	rm -rf .venv demo-output dist build .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
