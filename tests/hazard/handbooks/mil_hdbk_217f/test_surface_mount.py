"""MIL-HDBK-217F Notice 2 §16.2, surface-mounted joints: the worked example by hand."""

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

JOINTS = handbook_model("mil_hdbk_217f.surface_mount")
MIL = 0.0254
EXAMPLE = {
    "lead": "leadless", "package": "plastic", "substrate": "epoxy-glass", "package_side": f"{1480 * MIL} mm",
    "power": "0.5 W", "thermal_resistance": "20 K/W", "application": "military-ground", "design_life": "175200 h",
    "environment": "GF",
}  # fmt: skip


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


@each_case("environment", ["MF", "ML", "CL"])
def test_missiles_and_cannons_have_no_model(environment):
    with pytest.raises(ModelError, match=f"environment '{environment}' is not one of its choices"):
        JOINTS.settle({**EXAMPLE, "environment": environment})
