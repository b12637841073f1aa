"""From a design to the robot: inheritance, diagrams, lives, against what follows by hand."""

import math

import pytest

from robophm.blocks.diagram import KOutOfN, Parallel, Series, Unit
from robophm.core.errors import DesignError
from robophm.design.build import UNTAKEN
from robophm.design.file import load, parse

HEAD = "schema_version: 1\nname: R\n"


def robot(text):
    return parse(HEAD + text)


def modes(text):
    return {mode.path: mode for mode in robot(text).modes}


def signals(mode):
    return {name: channel.signal for stress in mode.stresses for name, channel in stress.channels.items()}


NESTED = """
signals: {temperature: {topic: /hall, field: t}}
acceleration: {model: q10}
components:
  Outer: {rate: 1 FIT}
modules:
  M:
    signals: {temperature: {topic: /m, field: t}}
    acceleration: {model: q10, q: 3}
    components:
      Middle: {rate: 1 FIT}
      Own: {rate: 1 FIT, signals: {temperature: {topic: /own, field: t}}}
      Calm: {rate: 1 FIT, acceleration: none}
      Other: {rate: 1 FIT, acceleration: {model: arrhenius, activation_energy: 0.7 eV}}
      Two: {failure_modes: {wear: {rate: 1 FIT}, dust: {rate: 1 FIT, acceleration: none}}}
    modules:
      Deep:
        components: {Part: {rate: 1 FIT}}
      Still:
        acceleration: none
        components: {Part: {rate: 1 FIT}}
"""


def test_the_nearest_signal_and_acceleration_win():
    found = modes(NESTED)
    assert {path: signals(mode) for path, mode in found.items()} == {
        "Outer": {"temperature": "/hall.t"},
        "M/Middle": {"temperature": "/m.t"},
        "M/Own": {"temperature": "/own.t"},
        "M/Calm": {},
        "M/Other": {"temperature": "/m.t"},
        "M/Two/wear": {"temperature": "/m.t"},
        "M/Two/dust": {},
        "M/Deep/Part": {"temperature": "/m.t"},
        "M/Still/Part": {},
    }
    assert {path: mode.stresses[0].design.get("q") for path, mode in found.items() if mode.stresses} == {
        "Outer": 2.0,
        "M/Middle": 3.0,
        "M/Own": 3.0,
        "M/Other": None,
        "M/Two/wear": 3.0,
        "M/Deep/Part": 3.0,
    }


def test_the_reference_is_25_degrees_unless_it_is_stated():
    found = modes(NESTED)
    assert found["Outer"].stresses[0].factor({"temperature": 35.0}).value == pytest.approx(2, rel=1e-14)
    assert found["M/Middle"].stresses[0].factor({"temperature": 25.0}).value == 1
    warmer = modes(NESTED.replace("{model: q10}", "{model: q10, reference_temperature: 55 degC}"))["Outer"]
    assert warmer.stresses[0].factor({"temperature": 35.0}).value == pytest.approx(1 / 4, rel=1e-14)


def test_nothing_is_accelerated_where_nothing_is_measured():
    (unmeasured,) = modes("acceleration: {model: q10}\ncomponents: {A: {rate: 1 FIT}}").values()
    assert (len(unmeasured.stresses), unmeasured.measured) == (1, ())  # a task may still state the stress
    assert modes("signals: {temperature: {topic: /t, field: t}}\ncomponents: {A: {rate: 1 FIT}}")["A"].stresses == ()


def test_the_nearest_environment_wins():
    capacitor = "{hazard: {model: mil_hdbk_217f.capacitor, inputs: {style: CDR, capacitance: 1 uF, %s"
    capacitor += "temperature: 40 degC, dc_voltage: 5 V, rated_voltage: 10 V}}}"
    found = modes(
        "environment: GB\n"
        f"components:\n  A: {capacitor % ''}\n"
        f"  C: {(capacitor % '').replace('{hazard', '{environment: AIC, hazard', 1)}\n"
        "modules: {M: {environment: GM, components: "
        f"{{B: {capacitor % ''}, D: {capacitor % 'environment: GF, '}}}}}}}"
    )
    assert {path: mode.stresses[0].design["environment"] for path, mode in found.items()} == {
        "M/B": "GM",
        "M/D": "GF",
        "A": "GB",
        "C": "AIC",
    }
    assert found["M/B"].rate == pytest.approx(20 * found["A"].rate, rel=1e-14)  # πE 20 and 1


def test_offsets_and_units_of_a_signal():
    text = """
acceleration: {model: q10}
signals:
  temperature: {topic: /t, field: t, unit: degF, range: [-40, 212], offset: 5 K, max_age: 2 min, stale: worst}
components:
  A: {rate: 1 FIT}
  B: {rate: 1 FIT, offsets: {temperature: 15 K}}
"""
    found = {path: mode.stresses[0].channels["temperature"] for path, mode in modes(text).items()}
    for path, shift in {"A": 5.0, "B": 20.0}.items():
        channel = found[path]
        assert channel.scale * 77 + channel.offset == pytest.approx(25 + shift, rel=1e-12)
        assert (channel.low, channel.high) == pytest.approx((-40 + shift, 100 + shift), rel=1e-12)
        assert (channel.max_age, channel.stale, channel.unit) == (120 * 10**9, "worst", "degF")


def test_a_share_of_a_rated_value():
    text = """
acceleration: {model: cubic_load}
signals: {load: {topic: /joint_states, field: "effort[1]", unit: N*m, rated: 80, range: [-160, 200], offset: 0.25}}
components: {A: {rate: 1 FIT}}
"""
    channel = modes(text)["A"].stresses[0].channels["load"]
    assert channel.scale * 40 + channel.offset == pytest.approx(0.5 + 0.25, rel=1e-15)
    assert (channel.low, channel.high, channel.unit) == (-2 + 0.25, 2.5 + 0.25, "N*m")


def test_the_nearest_clock_wins():
    text = """
usage: {kilometres: 1 km/h}
clocks: {kilometres: {topic: /odom, position: [x, y]}}
components: {A: {rate: 1e-5 /km, clock: kilometres}, H: {rate: 1 FIT}}
modules:
  M:
    clocks: {kilometres: {topic: /wheel, speed: v, unit: km/h}}
    components: {B: {rate: 1e-5 /km, clock: kilometres}}
"""
    found = modes(text)
    assert found["A"].measured_clock.signals == ("/odom.x", "/odom.y")
    assert found["M/B"].measured_clock.signals == ("/wheel.v",)
    assert found["M/B"].measured_clock.scale == pytest.approx(1 / 3.6, rel=1e-12)
    assert found["H"].measured_clock is None
    assert robot(text).signals == {"/odom.x": "m", "/odom.y": "m", "/wheel.v": "km/h"}


def test_edges_and_power_take_any_unit():
    text = "usage: {starts: 1 start/h}\npowered: {topic: /on, field: data}\nclocks: {starts: {topic: /m, edge: busy}}\n"
    found = robot(text + "components: {A: {rate: 1e-5 /start, clock: starts}}")
    assert found.signals == {"/on.data": None, "/m.busy": None}
    assert found.powered == "/on.data"


def test_parts_in_series_unless_they_are_drawn():
    found = robot("components: {A: {rate: 1 FIT}}\nmodules: {M: {components: {B: {rate: 1 FIT}, C: {rate: 1 FIT}}}}")
    assert found.wiring == Series("M", "A")
    assert found.diagram == Series(Series("M/B", "M/C"), "A")


def test_equal_parts_in_series_k_of_n_and_told_apart():
    text = "components:\n  A: {rate: 1 FIT, quantity: 3}\n  B: {rate: 1 FIT, quantity: 3, required: 2}\n"
    text += "  C: {rate: 1 FIT, quantity: 2}\ndiagram: {series: [A, B, {parallel: ['C[1]', 'C[2]']}]}"
    found = robot(text)
    assert found.diagram == Series("A", KOutOfN(2, "B[1]", "B[2]", "B[3]"), Parallel("C[1]", "C[2]"))
    assert {part.path: part.multiplicity for part in found.components} == {"A": 3, "B": 1, "C": 1}


def test_the_same_part_in_several_places():
    text = """
modules:
  Power: {components: {Battery: {rate: 1 FIT}, Fuse: {rate: 1 FIT}}}
  Drive:
    components: {Left: {rate: 1 FIT}, Right: {rate: 1 FIT}}
    diagram: {parallel: [{series: [Left, /Power/Battery]}, {series: [Right, /Power]}]}
diagram: Drive
functions:
  talk: Power/Battery
  move: {series: [Drive, Power]}
"""
    found = robot(text)
    power = Series("Power/Battery", "Power/Fuse")
    drive = Parallel(Series("Drive/Left", "Power/Battery"), Series("Drive/Right", power))
    assert found.diagram == drive
    assert found.functions == {"talk": Unit("Power/Battery"), "move": Series(drive, power)}
    assert found.warnings == ()


def test_what_is_drawn_nowhere_and_what_nobody_takes_are_warnings():
    text = "signals: {temperature: {topic: /t, field: t}}\nclocks: {kilometres: {topic: /o, speed: v}}\n"
    text += "components:\n  A: {rate: 1 FIT}\n  B: {rate: 1 FIT}\ndiagram: A"
    assert robot(text).warnings == ("B: used in no diagram", f"signals/temperature: {UNTAKEN}")


def test_a_part_does_not_listen_to_what_its_own_kind_does_not_need():
    """A Zener diode has no voltage stress; a rectifier beside it, under the same signals, has."""
    text = """
signals: {voltage: {topic: /v, field: data}, temperature: {topic: /t, field: data}}
environment: GM
components:
  Zener: {hazard: {model: mil_hdbk_217f.diode_low_frequency, inputs:
    {kind: zener, temperature: 40 degC, power: 0 W, contact: bonded}}}
  Rectifier: {hazard: {model: mil_hdbk_217f.diode_low_frequency, inputs:
    {kind: rectifier, temperature: 40 degC, power: 0 W, contact: bonded, voltage: 12 V, rated_voltage: 40 V}}}
"""
    found = modes(text)
    assert signals(found["Zener"]) == {"temperature": "/t.data"}
    assert signals(found["Rectifier"]) == {"temperature": "/t.data", "voltage": "/v.data"}


CHIP = """
signals: {case_temperature: {topic: /t, field: data}}
environment: GM
components:
  Chip: {hazard: {model: mil_hdbk_217f.microcircuit.processor, inputs: {family: CMOS, bits: 32 bit, package: LQFP,
    pins: 100, power: 0.3 W, years_in_production: 3 year%s}}}
"""


def test_what_would_count_is_not_left_unheard():
    """The environment's case temperature holds unless one is stated: a sensor of it has nothing to be compared with."""
    with pytest.raises(DesignError) as refused:
        robot(CHIP % "")
    assert str(refused.value) == (
        "design:7: components/Chip/hazard/inputs: 'case_temperature' is measured (signals/case_temperature), but its "
        "value as designed is not stated, and mil_hdbk_217f.microcircuit.processor answers to it; expected "
        "case_temperature: -55 … 175 degC"
    )
    assert signals(modes(CHIP % ", case_temperature: 50 degC")["Chip"]) == {"case_temperature": "/t.data"}
    other = CHIP.replace("case_temperature", "screening_points")  # which only custom screening has
    assert signals(modes(other % "")["Chip"]) == {}


TWO_RESISTORS = """
environment: GM
signals: {temperature: {topic: /t, field: data}}
components:
  A: {hazard: {model: mil_hdbk_217f.resistor, inputs: {style: RM, power: 9 mW, rated_power: 1 W, temperature: 40 degC}}}
  B: {hazard: {model: mil_hdbk_217f.resistor, inputs: {style: RM, power: 9 mW, rated_power: 1 W, temperature: %s}}%s}
"""


@pytest.mark.parametrize(
    ("temperature", "more", "rates", "heard"),
    [  # 217F §9.1: πE of RM is 1 in GB, 16 in GM
        ("40 degC", "", 1, ("/t.data", 0)),
        ("313.15 K", "", 1, ("/t.data", 0)),
        ("40 degC", ", offsets: {temperature: 5 K}", 1, ("/t.data", 5)),
        ("40 degC", ", signals: {temperature: {topic: /b, field: data}}", 1, ("/b.data", 0)),
        ("40 degC", ", environment: GB", 16, ("/t.data", 0)),
    ],
)
def test_parts_that_are_nearly_equal_keep_what_is_their_own(temperature, more, rates, heard):
    found = modes(TWO_RESISTORS % (temperature, more))
    assert found["A"].rate / found["B"].rate == pytest.approx(rates, rel=1e-12)
    channels = [found[name].stresses[0].channels["temperature"] for name in "AB"]
    assert [(channel.signal, channel.offset) for channel in channels] == [("/t.data", 0), heard]


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        ("40 degC", "40 W", "mil_hdbk_217f.resistor: temperature: unit 'W' does not measure what 'degC' does"),
        ("1", "true", "expected a quantity with its unit, e.g. '12 FIT', or a word where the input is a choice"),
        ("1", "[1]", "expected a quantity with its unit, e.g. '12 FIT', or a word where the input is a choice"),
    ],
)
def test_the_error_of_a_second_part_is_its_own(first, second, message):
    text = TWO_RESISTORS.replace("40 degC", first) % (second, "")
    with pytest.raises(DesignError) as refused:
        robot(text)
    assert str(refused.value) == f"design:8: components/B/hazard/inputs/temperature: {message}"


@pytest.mark.parametrize(
    ("life", "survival"),
    [
        ("{}", lambda t: math.exp(-t)),
        ("{distribution: weibull, shape: 2}", lambda t: math.exp(-((t * math.gamma(1.5)) ** 2))),
        ("{distribution: weibull, shape: 0.5}", lambda t: math.exp(-((t * 2) ** 0.5))),
        ("{distribution: rayleigh}", lambda t: math.exp(-math.pi / 4 * t**2)),
        ("{distribution: weibull, shape: 1, location: 400 h}", lambda t: math.exp(-max(t - 0.4, 0) / 0.6)),
        ("{distribution: gamma, shape: 2}", lambda t: math.exp(-2 * t) * (1 + 2 * t)),
        ("{distribution: loglogistic, shape: 2}", lambda t: 1 / (1 + (t * math.pi / 2) ** 2)),
        (
            "{distribution: lognormal, log_deviation: 0.5}",
            lambda t: math.erfc((math.log(t) + 0.125) / 0.5 / math.sqrt(2)) / 2,
        ),
        ("{distribution: curve, shape: 0.5}", lambda t: math.exp(-math.expm1(t**0.5))),  # keeps λ as its own
    ],
    ids=["exponential", "weibull 2", "weibull ½", "rayleigh", "location", "gamma", "loglogistic", "lognormal", "curve"],
)
def test_a_rate_with_a_shape_gives_the_scale_whose_mean_is_its_inverse(life, survival):
    mode = modes(f"components: {{A: {{rate: 1e-3 /h, life: {life}}}}}")["A"]
    for share in (0.1, 0.5, 1.0, 2.0):  # of the mean of 1000 h
        assert mode.life.survival(1000 * share) == pytest.approx(survival(share), rel=1e-10)
    assert mode.rate == 1e-3


@pytest.mark.parametrize(
    ("life", "mean"),
    [
        ("{distribution: weibull, shape: 2, scale: 100 h}", 100 * math.gamma(1.5)),
        ("{distribution: weibull, shape: 2, scale: 100 h, location: 50 h}", 50 + 100 * math.gamma(1.5)),
        ("{distribution: exponential, rate: 1e-3 /h}", 1000),
        ("{distribution: lognormal, log_mean: 3, log_deviation: 0.5}", math.exp(3.125)),
        ("{distribution: weibull, shape: 1, scale: 2 days}", 48),
    ],
)
def test_a_life_with_its_own_scale_needs_no_rate(life, mean):
    mode = modes(f"components: {{A: {{life: {life}}}}}")["A"]
    assert mode.rate == pytest.approx(1 / mean, rel=1e-12)
    assert mode.life.mean() == pytest.approx(mean, rel=1e-12)


def test_a_life_on_another_clock():
    text = "usage: {kilometres: 2 km/h}\ncomponents: {A: {clock: kilometres, initial_exposure: 1200 m, "
    text += "life: {distribution: weibull, shape: 2, scale: 500 km}, scaling: hazard}}"
    mode = modes(text)["A"]
    assert (mode.clock, mode.scaling, mode.initial_exposure, mode.life.scale) == ("kilometres", "hazard", 1.2, 500.0)


@pytest.mark.parametrize(
    ("task", "distance", "duration"),
    [
        ("{distance: 250 m, speed: 0.5 m/s}", 250, 500 / 3600),
        ("{duration: 20 min}", 0, 1 / 3),
        ("{distance: 1 km, duration: 20 min}", 1000, 1 / 3),
        ("{speed: 3.6 km/h, duration: 20 min}", 1200, 1 / 3),
    ],
)
def test_tasks(task, distance, duration):
    found = robot(f"task: {task}\ncomponents: {{A: {{rate: 1 FIT}}}}").task
    assert (found.distance, found.duration) == pytest.approx((distance, duration), rel=1e-12)


def test_usage_thresholds_and_silence():
    found = robot(
        "usage: {operating: 0.25, kilometres: 500 m/h}\nmax_gap: 2 min\nthresholds: {hazard_rate: 1000 FPMH}\n"
        "components: {A: {rate: 1 FIT, monitored: true, description: text}}"
    )
    assert (found.usage.operating, found.usage.kilometres, found.usage.cycles) == (0.25, 0.5, 0)
    assert found.max_gap == 120 * 10**9
    assert found.thresholds.hazard_rate.limit == pytest.approx(1e-3, rel=1e-15)
    assert found.components[0].monitored


def test_levels_as_deep_as_anyone_draws_them():
    text = "components: {P: {rate: 1 FIT}}"
    for level in range(40, 0, -1):
        text = f"modules: {{M{level}: {{{text}}}}}"
    assert [mode.path.count("/") for mode in robot(text).modes] == [40]


def test_the_papers_robot(examples):
    """Every row of the paper's Table 17, 269 parts in all; the sensing module has a parallel pair."""
    ota = load(examples / "ota" / "robot.yaml")
    assert ota.warnings == ()
    assert sum(part.quantity for part in ota.all_components()) == 269
    assert ota.modules[1].wiring == Series(Parallel("Sensing/SICK Laser Sensor", "Sensing/Camera"), "Sensing/IPS")
    assert all(len(mode.stresses) == 1 for mode in ota.modes)


def test_the_papers_robot_agrees_with_its_table(examples, shared):
    from ruamel.yaml import YAML

    rows = YAML(typ="safe").load(shared / "handbook" / "tables" / "ota_table17.yaml")["rows"]
    ota = load(examples / "ota" / "robot.yaml")
    written = sorted((row["module"], row["qty"], row["rate_per_h"]) for row in rows)
    parts = [(part.path.split("/")[0], part.quantity, part.modes[0].rate) for part in ota.all_components()]
    assert sorted(parts) == written


def test_members_that_are_drawn_nowhere_and_sensors_without_a_range_are_warned_of() -> None:
    robot = parse(
        """
schema_version: 1
name: R
signals: {temperature: {topic: /t, field: c}}
components: {motor: {quantity: 3, rate: 1 FIT, acceleration: {model: q10}}}
diagram: {parallel: ["motor[1]", "motor[2]"]}
"""
    )
    assert robot.warnings == (
        "motor[3]: used in no diagram",
        "signals/temperature: has no range: whatever a broken sensor says would count",
    )


def test_a_thousand_parts_can_be_told_apart_and_no_more() -> None:
    text = "schema_version: 1\nname: R\ncomponents: {led: {quantity: %d, required: 9, rate: 1 FIT}}\n"
    assert len(next(parse(text % 1000).all_components()).units) == 1000
    with pytest.raises(DesignError, match="1001 parts told apart; expected at most 1000"):
        parse(text % 1001)
