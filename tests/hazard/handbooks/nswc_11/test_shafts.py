"""NSWC-11 chapter 20 by hand, its table of grooves cell by cell."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.nswc_11.shaft import GROOVE, groove_factor

PLAIN = dict.fromkeys(("step_diameter", "step_length", "fillet_radius", "groove_depth", "groove_radius"))
BY_HAND = {
    **PLAIN, "cycles_to_failure": "1e8 cycle", "finish": "polished", "temperature": "20 degC", "force": "100 lbf",
    "material": "alloy_steel", "elastic_modulus": None, "equipment": "motor", "allowable_bending": None,
    "diameter": "0.5 inch", "length": "10 inch",
}  # fmt: skip


def inertia(inches):
    return math.pi * inches**4 / 64


def test_a_plain_shaft_by_hand(part):
    """C_SC is 1; the rate is of cycles, and divided by 10⁶ once."""
    bending = 0.0043 * 100 / (30e6 * 0.01) * 10**3 / inertia(0.5)
    assert part("shaft").rate(**BY_HAND) == pytest.approx(1e-8 * bending, rel=1e-9)
    assert part("shaft").model.unit == "1/cycle"


def test_the_fourth_power_of_the_diameter(part):
    """The 2020 tool multiplied by 4."""
    thin, thick = (part("shaft").rate(**{**BY_HAND, "diameter": f"{d} inch"}) for d in (0.5, 1.0))
    assert thin / thick == pytest.approx(16, rel=1e-12)


def test_a_step_adds_its_bending_and_its_concentration(part):
    stepped = {**BY_HAND, "step_diameter": "0.75 inch", "step_length": "4 inch", "fillet_radius": "0.1 inch"}
    found = part("shaft").factors(**stepped)
    sum_of = 10**3 / inertia(0.5) + 4**3 / inertia(0.75)
    assert found["C_DY"] == pytest.approx(0.0043 * 100 / (30e6 * 0.01) * sum_of, rel=1e-9)
    assert found["C_SC,R"] == pytest.approx((0.3 / 0.2) ** 0.2 * 1.5**0.8, rel=1e-9)
    assert found["C_SC,G"] == 1
    whole = part("shaft").rate(**stepped)
    assert whole == pytest.approx(1e-8 * found["C_DY"] * (found["C_SC,R"] + 1), rel=1e-12)


@each_case("wrong", [{"step_diameter": "0.4 inch"}, {"fillet_radius": "0.6 inch"}])
def test_a_step_goes_up_by_a_fillet(wrong, part):
    stepped = {**BY_HAND, "step_diameter": "0.75 inch", "step_length": "4 inch", "fillet_radius": "0.1 inch"}
    with pytest.raises(ModelError, match=r"a step from .* mm up to .* mm with a fillet of .* mm is none: outside"):
        part("shaft").inputs(**{**stepped, **wrong})


@each_case("missing", ["step_length", "fillet_radius", "groove_radius"])
def test_half_a_step_or_groove_is_none(missing, part):
    with pytest.raises(ModelError, match=f"nswc_11.shaft: a (step|groove) needs .*'{missing}'"):
        part("shaft").inputs(**{missing: None})


def test_every_cell_of_the_grooves(second):
    cells = 0
    for depth, row in second("nswc_motors_couplings_shafts_actuators")["shaft"]["C_SCG[h_over_D][h_over_r]"].items():
        for column in map(float, GROOVE.columns):
            value, outside = groove_factor(float(depth), column)
            assert outside == (column not in row)
            if column in row:
                assert value == pytest.approx(row[column], rel=1e-12)
                cells += 1
    assert cells == 25


def test_between_cells_it_is_linear():
    value, outside = groove_factor(np.array([0.05, 0.075, 0.15, 0.25]), np.array([0.3, 0.5, 3.0, 7.0]))
    middle = (1.31 + 1.6 + 1.7 + 2.0) / 4
    assert value.tolist() == pytest.approx(
        [1.275, (1.45 + 1.27) / 2, middle, (1.75 + 2.0 + 1.48 + 1.55) / 4], rel=1e-12
    )
    assert not outside.any()


def test_where_the_table_is_blank_there_is_no_answer(part):
    value, outside = groove_factor(
        np.array([0.05, 0.07, 0.1, 0.04, 0.31, 0.2, 0.2]), np.array([6, 5, 8, 1, 1, 0.09, 8.1])
    )
    assert outside.all()
    assert np.all(np.isfinite(value))
    with pytest.raises(
        ModelError, match=r"the table has no groove .* mm deep with a radius of .* mm in a shaft of .* mm: outside"
    ):
        part("shaft").inputs(groove_depth="0.6 mm", groove_radius="0.1 mm", diameter="12 mm")


@each_case(
    ("finish", "kpsi", "factor"),
    [
        ("polished", 150, 1), ("ground", 150, 0.89), ("hot_rolled", 100, 0.94 - 0.46 + 0.0837),
        ("machined_cold_drawn", 100, 1.07 - 0.51 + 0.221 - 0.0357), ("forged", 100, 0.75 - 0.406 + 0.0758),
    ],
)  # fmt: skip
def test_finishes_by_hand(finish, kpsi, factor, part):
    """A rough finish lowers the rate, as printed."""
    found = part("shaft").factors(finish=finish, tensile_strength=f"{kpsi * 1000} psi")["C_f"]
    assert found == pytest.approx(factor, rel=1e-9)
    assert found <= 1
