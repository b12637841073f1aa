"""What the simulator reads of a design, and what it refuses in one line."""

import itertools
import re

import numpy as np
import pytest

from robophm.core.errors import DesignError
from robophm.simulation.design_file import read_design
from robophm.simulation.structure import fails_at, parts_of

NESTED = """
clocks: {kilometres: {topic: /w, speed: v}}
signals: {temperature: {topic: /t, field: t, unit: degF, offset: 2 K}}
acceleration: {model: q10}
duty: 0.5
functions: {go: {series: [/M/N, "M/wheel[2]"]}, look: eye}
modules:
  M:
    duty: 0.2
    components:
      wheel: {rate: 2e-3 /km, clock: kilometres, quantity: 3, required: 2, acceleration: none}
    modules:
      N:
        components:
          x: {rate: 12 FPMH, duty: 1}
          y: {rate: 12 FIT, offsets: {temperature: 5 K}}
        diagram: {parallel: [x, y]}
    diagram: {series: [wheel, N/y, N]}
components:
  eye: {failure_modes: {lens: {rate: 1 /h, initial_exposure: 3 h}, chip: {rate: 2 /h, acceleration: none}}}
"""


def test_a_nested_design(design):
    robot = design(NESTED)
    assert robot.parts == ("M/N/x", "M/N/y", "M/wheel[1]", "M/wheel[2]", "M/wheel[3]", "eye")
    x, y, wheel, _, _, lens, chip = robot.modes
    assert (x.rate, y.rate, wheel.rate, chip.rate) == pytest.approx((12e-6, 12e-9, 2e-3, 2.0))
    assert (x.duty, y.duty, wheel.duty, lens.duty) == (1, 0.2, 0.2, 0.5)
    assert [stress.shift for stress in (*x.stresses, *y.stresses, *lens.stresses)] == pytest.approx([2, 7, 2])
    assert (wheel.stresses, chip.stresses, lens.initial) == ((), (), 3.0)
    (signal,) = robot.signals
    assert signal.scale * 212 + signal.offset == pytest.approx(100.0)
    assert parts_of(robot.functions["go"]) == {0, 1, 3}
    assert parts_of(robot.functions["look"]) == {5}
    assert robot.speed == (("/w.v", 1.0),)
    assert robot.max_age == 5.0


def works(up):
    """The nested robot's diagram by hand."""
    x, y, w1, w2, w3, eye = up
    return (w1 + w2 + w3 >= 2) and y and (x or y) and eye


def test_every_order_of_failures(design):
    """Brute force: parts fail one by one in every order, and the robot with the one after which it does not work."""
    orders = np.array(list(itertools.permutations(range(6))), dtype=float)
    expected = [next(t for t in range(6) if not works([bool(moment > t) for moment in order])) for order in orders]
    assert fails_at(design(NESTED).whole, orders).tolist() == expected


NETWORK = """
components: {a: {rate: 1 /h}, b: {rate: 1 /h}, c: {rate: 1 /h, quantity: 2, required: 1}, d: {rate: 1 /h}}
diagram:
  network:
    from: in
    to: out
    junctions: [x, y]
    links: [[in, a, x, b, out], {between: [x, y], through: d}, {from: y, to: out}, [in, c, y]]
"""


def test_a_network_fails_with_its_last_path(design):
    """Over all orders of failure of a, b, two of c, d: a–b, a–d, c, and c–d–b, less what cannot be best."""
    orders = np.array(list(itertools.permutations(range(5))), dtype=float)
    expected = []
    for a, b, c1, c2, d in orders:
        c = max(c1, c2)
        expected.append(max(min(a, b), min(a, d), c, min(c, d, b)))
    assert fails_at(design(NETWORK).whole, orders).tolist() == expected


REFUSED = {
    "components: {a: {rate: 1 /h}}\ndiagram: {network: {from: in, to: out, links: [[in, a]]}}": "no path leads",
    "components: {a: {rate: 1 /h}}\ndiagram: {network: {from: in, to: out, links: [[in, b, out]]}}": "unknown part 'b'",
    "components: {a: {rate: 1 /h}}\ndiagram: {network: {from: in, to: out, links: [{between: 3}]}}": "3 joins no two",
    "components: {a: {rate: 1 /h}}\ndiagram: {network: {from: in, to: out, links: 3}}": "expected lists of links",
    "components: {a: {hazard: {model: x}}}": "components/a/hazard: 'hazard' is not simulated",
    "components: {a: {life: {distribution: weibull, shape: 2}}}": "a: has no rate",
    "components: {a: {rate: 1 /km}}": "unit '/km' does not measure what '1/h' does",
    "components: {a: {rate: 0 /h}}": "rate: 0 /h is too small",
    "components: {a: {rate: 1 /km, clock: kilometres}}": "kilometres are not measured",
    "components: {a: {rate: 1 /h, clock: sidereal}}": "no clock 'sidereal'",
    "components: {a: {rate: 1 /h, life: {distribution: gumbel}}}": "distribution 'gumbel' is not simulated",
    "components: {a: {rate: 1 /h, life: {distribution: weibull}}}": "life/shape: None is not a quantity",
    "components: {a: {rate: 1 /h, life: {distribution: weibull, shape: 2, location: 3 h}}}": "'location' is not",
    "components: {a: {rate: 1 /h, life: {shape: 2}}}": "is no parameter of exponential",
    "components: {a: {rate: 1 /h, acceleration: {model: peck}}}": "acceleration 'peck' is not simulated",
    "components: {a: {rate: 1 /h, acceleration: {model: arrhenius}}}": "arrhenius needs 'activation_energy'",
    "components: {a: {rate: 1 /h, depends_on: b}, b: {rate: 1 /h}}": "components/a/depends_on: 'depends_on' is not sim",
    "components: {a: {rate: 1 /h, quantity: 2}}\ncommon_causes: {x: {of: [a], beta: 0.1}}": "'common_causes' is not",
    "components: {a: {rate: 1 /h, standby: cold}}": "'standby' is not simulated",
    "components: {a: {rate: 1 /h, quantity: 20000}}": "expected a whole number, 1 … 10000",
    "components: {a: {rate: 1 /h, quantity: 2, required: 3}}": "required: 3; expected a whole number, 1 … 2",
    "components: {a: {rate: 1 /h, failure_modes: {x: {rate: 1 /h}}}}": "has failure_modes and its own rate",
    "components: {a: {rate: 1 /h, offsets: {temperature: 1 K}}}": "no signal 'temperature' is bound",
    "components: {a: {rate: 1 /h, duty: 1.2}}": "duty: 1.2; expected 0 … 1",
    "components: {a: {rate: 1 /h, uncertainty: {error_factor: 1}}}": "uncertainty: 1 is too small",
    "components: {a: {rate: 1 /h, uncertainty: {mean: 1}}}": "expected exactly one of error_factor",
    "components: {a: 3}": "components/a: expected keys with values, not 3",
    "components: {1: {rate: 1 /h}}": "1 is not a name",
    "modules: {M: {}}": "modules/M: has no parts",
    "components: {a: {rate: 1 /h}}\ndiagram: b": "diagram: unknown part 'b'; known: a",
    "components: {a: {rate: 1 /h}}\ndiagram: a[2]": "'a[2]': expected [1] … [1]",
    "components: {a: {rate: 1 /h}}\ndiagram: {standby: {of: [a]}}": "standby: parts that depend on each other",
    "components: {a: {rate: 1 /h}}\ndiagram: {serie: [a]}": "not a block",
    "components: {a: {rate: 1 /h}}\ndiagram: {series: []}": "series of nothing",
    "components: {a: {rate: 1 /h}}\ndiagram: {k_of_n: {k: 2, of: [a]}}": "2; expected a whole number, 1 … 1",
    "components: {a: {rate: 1 /h}}\nfunctions: {'a;b': a}": "holds ';'",
    "modules: {M: {components: {a: {rate: 1 /h}}, diagram: {series: [a, /M]}}}": "cycle: 'M' contains itself",
    "components: {a: {rate: 1 /h}}\nsignals: {humidity: {topic: /h, field: h}}": "input 'humidity' is not simulated",
    "components: {a: {rate: 1 /h}}\nsignals: {load: {topic: /power, field: on}}": "/power.on is bound to different",
    "components: {a: {rate: 1 /h}}\nsignals: {load: {topic: /l, field: x, max_age: 1 ms}}": "0.001 s; a simulated",
    "components: {a: {rate: 1 /h}}\nclocks: {kilometres: {topic: /o, position: [x]}}": "only kilometres by a 'speed'",
    "components: {a: {rate: 1 /h}}\nclocks: {cycles: {topic: /o, edge: x}}": "only kilometres by a 'speed'",
    "signals: {load: {topic: /l, field: x}}\n"
    "components: {a: {rate: 1 /h, clock: calendar, acceleration: {model: cubic_load}}}": "a calendar clock is not",
    "components: {a: {rate: !!python/object 1}}": "is not a quantity",
    "components: {a: {rate: 1 /h}, a: {rate: 1 /h}}": "is not YAML: found duplicate key",
}  # fmt: skip


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_not_simulated_is_refused_in_one_line(design, text):
    with pytest.raises(DesignError) as refusal:
        design(text)
    assert REFUSED[text] in str(refusal.value)
    assert re.search(r"robot\.yaml:\d+: ", str(refusal.value))
    assert "\n" not in str(refusal.value)


def test_the_line_is_that_of_the_fault(design):
    with pytest.raises(DesignError, match=r"robot.yaml:7: components/b/rate: "):
        design("components:\n  a: {rate: 1 /h}\n  b: {rate: 1 V}\n")


def test_a_clock_that_nothing_drives(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(
        "schema_version: 1\nname: x\npowered: {topic: /p, field: on}\n"
        "components: {a: {rate: 1 /start, clock: starts}}\n"
    )
    with pytest.raises(DesignError, match="usage: says nothing of 'starts'"):
        read_design(path)


def test_a_robot_that_does_not_say_when_it_is_off(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text("schema_version: 1\nname: x\ncomponents: {a: {rate: 1 /h}}\n")
    with pytest.raises(DesignError, match="needs 'powered'"):
        read_design(path)
    path.write_text("- 1\n")
    with pytest.raises(DesignError, match="holds no design"):
        read_design(path)
    path.write_bytes(b"\xff")
    with pytest.raises(DesignError, match="is not UTF-8 text"):
        read_design(path)
    with pytest.raises(DesignError, match="No such file"):
        read_design(tmp_path / "none.yaml")


def test_what_unfolds_without_end(design):
    bomb = "modules:\n  m0: &m0 {components: {c: {rate: 1 /h}}}\n"
    for i in range(1, 30):
        bomb += f"  m{i}: &m{i} {{modules: {{a: *m{i - 1}, b: *m{i - 1}}}}}\n"
    with pytest.raises(DesignError, match="more than 10,000 parts"):
        design(bomb)
    with pytest.raises(DesignError, match="50 deep"):
        design("components: {a: {rate: 1 /h}}\ndiagram: " + "{series: [" * 60 + "a" + "]}" * 60)
    with pytest.raises(DesignError, match="nested too deeply"):
        design("components: {a: {rate: 1 /h}}\ndiagram: " + "[" * 1_000)


def test_a_text_of_too_many_values_is_not_read_to_its_end(design, monkeypatch):
    monkeypatch.setattr("robophm.core.yaml_nodes.MAX_SLOW_NODES", 100)
    with pytest.raises(DesignError, match=r":\d+: has more than .* keys and values up to here$"):
        design(f"components: {{a: {{rate: 1 FPMH}}}}\ntags: [{', '.join(['1'] * 101)}]\n")
