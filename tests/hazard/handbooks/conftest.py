"""What the tests of the sections share: published cases beside a model, and the second transcription."""

import json
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from robophm.hazard.handbooks import handbook_model

DATA = Path(__file__).parents[2] / "data"


class Section:
    """One model, its factors and its published cases."""

    def __init__(self, name):
        self.model = handbook_model(f"mil_hdbk_217f.{name}")

    def factors(self, inputs, **measured):
        """The factors of inputs as a user writes them, then of numbers that are measured."""
        explained = self.model.explain({**self.model.settle(inputs), **measured})
        return {factor.symbol: np.asarray(factor.value, dtype=float) for factor in explained.leaves()}

    def rate(self, inputs):
        """Failures/10⁶ h."""
        return float(self.model.evaluate(self.model.settle(inputs)).value) * 1e6


@pytest.fixture
def section():
    """The section of a name."""
    return Section


@pytest.fixture
def agrees():
    """Whether a value is a case's published one, within its tolerance."""

    def agrees(case, found):
        tolerance = case["tolerance"]
        expected = pytest.approx(case["expected"]["value"], rel=tolerance.get("rel", 0), abs=tolerance.get("abs", 0))
        assert case["source"]
        assert float(found) == expected, case["name"]

    return agrees


@pytest.fixture
def carried(shared):
    """Fails where the cases of a file in tests/data are not those published for its sections, all of them."""
    published = json.loads((shared / "cases" / "handbook.json").read_text(encoding="utf-8"))["cases"]

    def carried(name, *sections):
        here = {case["name"]: case for case in json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))["cases"]}
        there = {
            case["name"]: {key: value for key, value in case.items() if key != "handbook"}
            for case in published
            if case["handbook"].startswith("MIL") and case["section"] in sections and not case.get("disputed")
        }
        assert here == there
        return len(here)

    return carried


@pytest.fixture
def second(shared):
    """The second transcription of a handbook table."""
    return lambda name: YAML(typ="safe").load(shared / "handbook" / "tables" / f"mil217_{name}.yaml")


@pytest.fixture
def original(shared):
    """What the 2020 tool answers for a section, where that is the handbook's answer."""
    cases = json.loads((shared / "cases" / "handbook_original_tool.json").read_text(encoding="utf-8"))["cases"]

    def original(section):
        found = [case for case in cases if case["section"] == section]
        assert found
        assert all(case["verdict"].startswith("agrees") for case in found)
        return found

    return original
