"""A part of the library in a design that is edited: it stays what it is, and what is stated beside it wins."""

import math

import pytest

from robophm.parts import part

from .conftest import serving

TEXT = """\
schema_version: 1
name: R
components:
  Lidar: {part: lidar_2d}  # on the mast
  Fan:
    part: fan  # the big one
"""


@pytest.fixture
def served(tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_text(TEXT)
    with serving(design, seed=1) as found:
        yield found


def test_it_survives_an_edit(served):
    served.edit({"op": "put", "path": ["components", "Lidar", "quantity"], "value": 2})
    served.edit({"op": "rename", "path": ["components", "Fan"], "name": "Blower"})
    state = served.edit({"op": "put", "path": ["components", "Blower", "mtbf"], "value": "9000 h"})
    assert [one for one in state["problems"] if one["level"] == "error"] == []
    said = served.get("/api/design/text")["text"]
    for line in ("Lidar: {part: lidar_2d, quantity: 2} # on the mast", "part: fan  # the big one", "mtbf: 9000 h"):
        assert line in said
    shape, scale = 2, float(str(part("lidar_2d").part["l10"]).split()[0]) / (-math.log(0.9)) ** 0.5
    both = served.get("/api/analysis/curves", path="Lidar", horizon=1000, points=2)["nominal"]["reliability"]
    assert both[1] == pytest.approx(math.exp(-2 * (1000 / scale) ** shape), rel=1e-9)


def test_what_is_wrong_is_at_its_key(served):
    state = served.edit({"op": "put", "path": ["components", "Lidar", "part"], "value": "lidar_2e"})
    (problem,) = [one for one in state["problems"] if one["level"] == "error"]
    assert (problem["place"], problem["line"]) == (["components", "Lidar", "part"], 4)
    assert problem["message"] == "no part 'lidar_2e' in the library; did you mean 'lidar_2d'?"
