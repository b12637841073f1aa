"""What is not known of a handbook's model is one unknown for all parts that it rates; closed forms of the sum."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.drafting.first_look import look_at
from robophm.health.drawn_rates import draw_rates, drawn_together
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.rate_sensitivity import largest_unknowns, ranges
from robophm.report.first_look import advice

Z = norm.ppf(0.95)
HALF_HOUR = Task((Leg(0.5),))
RESISTOR = "hazard: {{model: mil_hdbk_217f.resistor, inputs: {{style: RM, power: {} W, rated_power: 1 W, "
RESISTOR += "temperature: 40 degC}}}}"
COIL = "hazard: {model: mil_hdbk_217f.coil, inputs: {kind: fixed, temperature: 40 degC, temperature_rise: 10 K}}"
BATTERY = "hazard: {model: general.battery, inputs: {chemistry: lithium_ion}}"
STATED = "hazard: {model: general.constant, inputs: {rate: 2e-6 /h, source: its maker}}"


def robot(parts, factor=4):
    lines = "".join(f"  {name}: {{{said}}}\n" for name, said in parts.items())
    return parse(
        f"schema_version: 1\nname: r\nenvironment: GM\nuncertainty: {{error_factor: {factor}}}\ncomponents:\n{lines}"
    )


def hazard_rate(design):
    now = as_designed(Plant(design))
    return ranges(now, design.diagram, HALF_HOUR).hazard_rate


def quantile(mean, factor, z):
    """Of a lognormal of this mean, whose 95th percentile is ``factor`` times its median."""
    deviation = math.log(factor) / Z
    return mean * math.exp(deviation * z - deviation**2 / 2)


def test_the_range_of_a_sum_is_the_sum_of_the_ranges_of_parts_of_one_model():
    """Of twelve resistors, each at a load of its own, the quantiles of the sum are Σλ times those of one factor."""
    design = robot({f"R{i}": RESISTOR.format(0.05 * i) for i in range(1, 13)})
    total = sum(mode.rate for mode in design.modes)
    assert len({mode.rate for mode in design.modes}) == 12
    expected = [quantile(total, 4, z) for z in (-Z, 0, Z)]
    assert hazard_rate(design) == pytest.approx(expected, rel=5e-3)


def test_models_and_stated_figures_are_off_each_by_themselves():
    """Variances of independent factors add up: of the sum it is Σ (λ of a model)² (exp(σ²) - 1)."""
    design = robot({
        "R1": RESISTOR.format(0.1), "R2": RESISTOR.format(0.5), "L1": COIL, "L2": COIL, "A": STATED, "B": STATED,
    })  # fmt: skip
    drawn = draw_rates(Plant(design), 200_000, seed=2)
    rate = {mode.path: mode.rate for mode in design.modes}
    row = {mode.path: drawn[i] for i, mode in enumerate(design.modes)}
    assert np.array_equal(row["R1"], row["R2"])
    assert np.array_equal(row["L1"], row["L2"])
    independent = [rate["R1"] + rate["R2"], rate["L1"] + rate["L2"], rate["A"], rate["B"]]
    variance = (math.exp((math.log(4) / Z) ** 2) - 1) * sum(one**2 for one in independent)
    total = sum(rate[path] * row[path] for path in rate)
    assert np.var(total) == pytest.approx(variance, rel=0.03)


def test_an_entry_that_takes_a_model_shares_what_is_not_known_of_the_model():
    """Each is as unsure as it says, by the same draw of what the handbook is off by."""
    design = robot({"pack": "part: battery_li_ion", "cell": BATTERY})
    drawn = np.log(draw_rates(Plant(design), 1000, seed=2))
    row = {mode.path: drawn[i] - np.median(drawn[i]) for i, mode in enumerate(design.modes)}
    assert row["pack/cell failure"] / math.log(5) == pytest.approx(row["cell"] / math.log(4), rel=1e-9, abs=1e-9)


def test_what_the_field_has_said_of_one_part_is_its_own():
    learned = ", learned: {factor: 1.5, shape: 3, failures: 2, expected: 1}"
    design = robot({"R1": RESISTOR.format(0.1), "R2": RESISTOR.format(0.1), "R3": RESISTOR.format(0.1) + learned})
    drawn = draw_rates(Plant(design), 5000, seed=2)
    assert np.array_equal(drawn[0], drawn[1])
    assert abs(np.corrcoef(drawn[0], drawn[2])[0, 1]) < 0.05


def test_modes_are_drawn_together_by_what_they_share_through_others():
    """Board one and board two have nothing in common but the model of their resistors."""
    boards = "".join(
        f"  {board}:\n    quality: unknown\n    components: {{R: {{{RESISTOR.format(0.1)}}}, {part}}}\n"
        for board, part in (("one", "X: {rate: 1e-6 /h}"), ("two", f"L: {{{COIL}}}"))
    )
    text = f"schema_version: 1\nname: r\nenvironment: GM\nuncertainty: {{error_factor: 4}}\nmodules:\n{boards}"
    design = parse(text)
    paths = [mode.path for mode in design.modes]
    found = drawn_together(design, range(len(paths)))
    assert sorted(sorted(paths[i] for i in group) for group in found) == [["one/R", "two/R"], ["one/X"], ["two/L"]]
    apart = parse(text.replace("uncertainty: {error_factor: 4}\n", ""))
    found = drawn_together(apart, [i for i, mode in enumerate(apart.modes) if mode.uncertainty])
    assert sorted(len(group) for group in found) == [1, 1]  # two boards, each bought by itself


def test_parts_of_one_model_are_known_together():
    design = robot({"R1": RESISTOR.format(0.1), "R2": RESISTOR.format(0.5), "A": STATED})
    now = as_designed(Plant(design))
    found = {tuple(part.path for part in one.parts): one for one in largest_unknowns(now, design.diagram, HALF_HOUR)}
    assert found.keys() == {("R1", "R2"), ("A",)}
    assert any("mil_hdbk_217f.resistor rates (R1, R2)" in said for said in advice(look_at(design, now)))
