"""MIL-HDBK-217F Notice 2 §16.2 against its worked example and the second transcription."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.surface_mount import (
    CUMULATIVE_FAILURES,
    CYCLING,
    LEAD,
    PACKAGE,
    SUBSTRATE,
    TEMPERATURE_SWING,
)

CASES = json.loads((Path(__file__).parents[3] / "data" / "surface_mount.json").read_text())["cases"]
JOINTS = handbook_model("mil_hdbk_217f.surface_mount")
MIL = 0.0254
EXAMPLE = {
    "lead": "leadless", "package": "plastic", "substrate": "epoxy-glass", "package_side": f"{1480 * MIL} mm",
    "power": "0.5 W", "thermal_resistance": "20 K/W", "application": "military-ground", "design_life": "175200 h",
    "environment": "GF",
}  # fmt: skip


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {"environment": "GB"}  # its temperature swing is given
    for name, value in published.items():
        match name:
            case "d_mil":
                ours["package_side"] = f"{2 * value * MIL} mm"
            case "h_mil":
                ours["joint_height"] = f"{value * MIL} mm"
            case "alphaS_ppm":
                ours["substrate"] = next(word for word, number in SUBSTRATE.items() if number == value)
            case "alphaCC_ppm":
                ours["package"] = next(word for word, number in PACKAGE.items() if number == value)
            case "dT_C":
                ours["temperature_swing"] = f"{value} K"
            case "thetaJC":
                ours["thermal_resistance"] = f"{value} K/W"
            case "P_W":
                ours["power"] = f"{value} W"
            case "CR_per_h":
                ours["application"] = next(word for word, number in CYCLING.items() if number == value)
            case "LC_h":
                ours["design_life"] = f"{value} h"
            case "lead":
                ours["lead"] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    answers(JOINTS, case, given(case["inputs"]))


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 1
    as_published(CASES, "16.2")


def test_tables_agree_row_by_row(second):
    theirs = second("interconnection")["smt_16_2"]
    assert dict(CYCLING) == {key.replace("_", "-"): value for key, value in theirs["CR_cycles_per_h"].items()}
    assert list(LEAD.values()) == list(theirs["piLC"].values())
    assert dict(PACKAGE) == theirs["alphaCC_ppm"]
    assert dict(SUBSTRATE) == {key.replace("_", "-"): value for key, value in theirs["alphaS_ppm"].items()}
    assert dict(TEMPERATURE_SWING) == theirs["dT_C"]


def test_cumulative_failures_are_those_of_motors():
    """§12.1's λ1, λ2 by life / α: the first row whose limit is not below; above 0.90 it is 1."""
    assert [(float(limit), value) for limit, value in CUMULATIVE_FAILURES.items()] == [
        (0.1, 0.13), (0.2, 0.15), (0.3, 0.23), (0.4, 0.31), (0.5, 0.41), (0.6, 0.51), (0.7, 0.61), (0.8, 0.68),
        (0.9, 0.76), (math.inf, 1.0),
    ]  # fmt: skip


def test_by_hand():
    """The worked example: 1480 mil, joints of 5 mil by lead, ΔT 21 K by environment, Trise 10 K: LC/α 0.28."""
    strain = 740 / (0.65 * 5) * abs(15 * 21 - 7 * (21 + 10)) * 1e-6
    cycles = 3.5 * strain**-2.26
    assert 0.27 < 175200 * 0.03 / cycles < 0.29
    inputs = JOINTS.settle(EXAMPLE)
    assert JOINTS.evaluate(inputs).value == pytest.approx(0.23 * 0.03 / cycles, rel=1e-12)
    leaded = JOINTS.settle({**EXAMPLE, "lead": "SOIC"})  # 8 mil high
    assert JOINTS.evaluate(leaded).value == pytest.approx(0.13 * 0.03 / (cycles * 1.6**2.26 * 5000), rel=1e-12)


def test_what_moves_with_its_board_does_not_wear():
    """Plastic at 7 ppm on a board of 7 ppm without heat of its own, and any part that is never cycled."""
    design = JOINTS.settle({**EXAMPLE, "substrate": "epoxy-kevlar", "power": "0 W"})
    assert JOINTS.evaluate(design).value == 0
    assert JOINTS.evaluate({**design, "temperature_swing": np.array([0.0, 20.0])}).value.tolist() == [0, 0]


@pytest.mark.parametrize("environment", ["MF", "ML", "CL"])
def test_missiles_and_cannons_have_no_model(environment):
    with pytest.raises(ModelError, match=f"environment '{environment}' is not one of its choices"):
        JOINTS.settle({**EXAMPLE, "environment": environment})
