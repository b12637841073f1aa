"""What the tests of the sections share: a model's factors, published cases, and the second transcription of tables."""

import json

import numpy as np
import pytest
from ruamel.yaml import YAML


@pytest.fixture(scope="session")
def factors():
    """The leaves of a model's explanation, by symbol."""
    return lambda model, inputs: {f.symbol: float(np.asarray(f.value)) for f in model.explain(inputs).leaves()}


@pytest.fixture(scope="session")
def answers(factors):
    """Whether a model gives a case's published answer: its rate, or one factor of it."""

    def assert_answer(model, case, given, symbol=None):
        inputs = model.settle(given)
        found = factors(model, inputs)[symbol] if symbol else float(model.evaluate(inputs).value) * 1e6
        tolerance = case["tolerance"]
        expected = pytest.approx(case["expected"]["value"], rel=tolerance.get("rel", 0), abs=tolerance.get("abs", 0))
        assert found == expected
        assert case["source"]

    return assert_answer


@pytest.fixture(scope="session")
def as_published(shared):
    """Whether carried cases are, every one and word for word, the undisputed ones of those sections."""

    def assert_same(cases, *sections):
        published = json.loads((shared / "cases" / "handbook.json").read_text())["cases"]
        there = [case for case in published if case["handbook"].startswith("MIL") and case["section"] in sections]
        there = {case["name"]: case for case in there if not case.get("disputed")}
        assert {case["name"] for case in cases} == there.keys()
        for case in cases:
            assert all(there[case["name"]][key] == value for key, value in case.items()), case["name"]

    return assert_same


@pytest.fixture(scope="session")
def second(shared):
    """A second transcription of the tables, by the name of its file."""
    return lambda name: YAML(typ="safe").load(shared / "handbook" / "tables" / f"mil217_{name}.yaml")
