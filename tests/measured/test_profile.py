"""Stress profiles: levels as plain loops count them, and a load to come that ages every part as the recordings did."""

import math
from pathlib import Path

import pytest
import yaml

from robophm.core.errors import DesignError, RobophmError, SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.design.file import load, parse
from robophm.design.task_file import parse_plan
from robophm.health.mission import consecutive_completions, plan_future, planned
from robophm.health.outlooks import outlooks
from robophm.measured import profile
from robophm.measured.levels import marginal
from robophm.measured.profile import stress_profiles, task_text
from robophm.measured.recordings import recordings
from robophm.monitoring.monitor import Monitor
from robophm.transports.recordings.recording import Recording

from .plain import START, samples, stretches, write

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"

MIXED = """
schema_version: 1
name: Mixed
usage: {kilometres: 2 km/h, cycles: 7 cycle/h}
signals:
  temperature: {topic: /motor/temperature, field: temperature, unit: degC, range: [-40, 125]}
components:
  Old: {rate: 1e-5 /h, acceleration: {model: q10}, quantity: 3}
  Warm:
    rate: 2e-5 /h
    acceleration: {model: arrhenius, activation_energy: 0.5 eV}
    offsets: {temperature: 15 K}
    life: {distribution: weibull, shape: 2}
  Board:
    rate: 1e-6 /h
    signals: {humidity: {topic: /level, field: data, unit: percent, range: [0, 100]}}
    acceleration: {model: peck, reference_humidity: 50 percent, reference_temperature: 25 degC}
  Wheel: {rate: 2e-5 /km, clock: kilometres, acceleration: {model: q10}}
  Lever: {rate: 1e-7 /cycle, clock: cycles, acceleration: {model: q10, q: 3}}
  Seal: {rate: 1e-6 /h, clock: calendar, acceleration: {model: q10}}
  Both:
    failure_modes:
      hot: {rate: 1e-6 /h, acceleration: {model: q10}}
      worn: {rate: 1e-6 /h, acceleration: {model: arrhenius, activation_energy: 0.9 eV}}
  Cold: {rate: 1e-6 /h}
"""


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    """Two hours of temperature and humidity at 1 Hz that go together, silent for a while and off for longer."""
    messages = []
    for i in range(7200):
        if 2000 <= i < 2030 or 4000 <= i < 4600:
            continue
        at = START + i * SECOND
        warm = 30 + 12 * math.sin(i / 500) + 3 * math.sin(i / 7)
        messages += [(at, at, warm), (at + 1000, None, 60 + warm / 2 + 10 * math.cos(i / 300))]
    return write(tmp_path_factory.mktemp("mixed") / "drive.mcap", messages, 5000), parse(MIXED)


def replayed(robot, path):
    monitor = Monitor(robot)
    with Recording(path) as recording:
        for sample in recording.samples(robot.signals):
            monitor.observe(sample)
        monitor.end(max(end for _, end in recording.spans()))
    return monitor, monitor.exposure.settled(monitor.ledger)


@pytest.fixture(scope="module", params=["ota", "mixed"])
def drive(request):
    """A recording, a robot, and the monitor and ledger after a replay."""
    path, robot = (
        (request.getfixturevalue("day"), load(OTA)) if request.param == "ota" else request.getfixturevalue("mixed")
    )
    return path, robot, *replayed(robot, path)


def test_exposure_is_that_of_a_replay(drive):
    path, robot, _, ledger = drive
    found = stress_profiles(robot, recordings([path])[0], 20)
    for one, other in ((found.ledger.age, ledger.age), (found.ledger.effective, ledger.effective),
                       (found.ledger.hazard, ledger.hazard), (found.ledger.clocks, ledger.clocks)):  # fmt: skip
        assert one.value == pytest.approx(other.value, rel=1e-11)
    assert found.ledger.stale == ledger.stale


def test_time_at_level_is_that_of_a_plain_loop(day):
    """Of the OTA's power module, which is on throughout: temperature as it holds for 5 s, else as designed."""
    name = "/ota/power/temperature.temperature"
    found = stress_profiles(load(OTA), recordings([day])[0], 20)
    power = next(one for one in found.profiles if one.inputs[0].signal == name)
    begins, hours = marginal(power.levels, 0)
    width = power.levels.widths[0]
    held = stretches(samples(day, name), 5 * SECOND)
    for begin, time in zip(begins, hours, strict=True):
        expected = sum(end - start for start, end, value, _ in held if begin <= value < begin + width) / HOUR
        assert time == pytest.approx(expected, abs=1e-6)  # its last value holds until the last of all
    mean = sum((end - start) * 2 ** ((value - 25) / 10) for start, end, value, _ in held)
    assert power.factor == pytest.approx(mean / sum(end - start for start, end, _, _ in held), rel=1e-6)


@pytest.mark.parametrize("levels", [2, 7, 20])
def test_the_load_to_come_ages_every_part_as_the_recording_did(drive, levels):
    path, robot, monitor, ledger = drive
    found = stress_profiles(robot, recordings([path])[0], levels)
    assert all(abs(one.error) < 1e-12 for one in found.profiles)
    plan = parse_plan(task_text(found, "as lived", "day"), robot)
    new = outlooks(monitor.plant, monitor.exposure, Monitor(robot).ledger)["sensor_based"]
    steps = planned(new, plan.tasks[0])
    off = monitor.plant.calendar & (plan.every > ledger.clocks.value[0] * (1 + 1e-9))
    assert steps.advance.sum(axis=1)[~off] == pytest.approx(ledger.age.value[~off], rel=1e-11)
    assert steps.effective.sum(axis=1)[~off] == pytest.approx(ledger.effective.value[~off], rel=1e-11)
    future = plan_future(new, plan)
    assert future.hours[-1] == pytest.approx(ledger.clocks.value[1], rel=1e-11)
    assert future.operating[-1] == pytest.approx(ledger.clocks.value[0], rel=1e-11)
    # off, a part on the calendar clock is as designed in the plan, and was for max_age what it had last in the past
    assert future.advance[off, -1] == pytest.approx(ledger.age.value[off], rel=1e-11)
    assert future.effective[off, -1] == pytest.approx(ledger.effective.value[off], rel=0.01)


def test_prognosis_of_the_profile_is_that_of_the_recordings_own_history(day):
    """All lives are exponential but for none, all scale by age: survival over one round is that of the day lived."""
    robot = load(OTA)
    found = stress_profiles(robot, recordings([day])[0], 20)
    plan = parse_plan(task_text(found, "as lived", "day"), robot)
    monitor, ledger = replayed(robot, day)
    fresh = outlooks(monitor.plant, monitor.exposure, Monitor(robot).ledger)["sensor_based"]
    lived_through = outlooks(monitor.plant, monitor.exposure, ledger)["sensor_based"].survival(robot.diagram)
    (ahead,) = consecutive_completions(fresh, plan.tasks)
    assert ahead.failure == pytest.approx(lived_through.failed, rel=1e-10)
    assert ahead.probability == pytest.approx(lived_through.works, rel=1e-12)


@pytest.mark.full
def test_hazard_scaling_depends_on_the_order_and_comes_close(day):
    """Where stress scales hazard and life is not exponential, levels in another order age a little differently."""
    text = OTA.read_text().replace("rate: 2e-08 /h", "rate: 2e-4 /h\n        scaling: hazard\n        "
                                   "life: {distribution: weibull, shape: 3}")  # fmt: skip
    robot = parse(text)
    i = next(i for i, mode in enumerate(robot.modes) if mode.path == "Power/Battery")
    found = stress_profiles(robot, recordings([day])[0], 20)
    plan = parse_plan(task_text(found, "as lived", "day"), robot)
    monitor, ledger = replayed(robot, day)
    fresh = outlooks(monitor.plant, monitor.exposure, Monitor(robot).ledger)["sensor_based"]
    hazard = fresh.increments(monitor.plant.everything, *planned(fresh, plan.tasks[0])).sum(axis=1)
    assert robot.modes[i].scaling == "hazard"
    assert hazard[i] == pytest.approx(ledger.hazard.value[i], rel=0.1)


def test_the_task_may_stand_in_a_design(day):
    robot = load(OTA)
    found = stress_profiles(robot, recordings([day])[0], 10)
    text = task_text(found, "as lived", "day")
    (task,) = yaml.safe_load(text)["tasks"]
    design = yaml.safe_load(OTA.read_text())
    design["task"] = task
    with_task = parse(yaml.safe_dump(design, allow_unicode=True))
    assert with_task.task == parse_plan(text, robot).tasks[0]


def test_what_is_the_same_in_a_module_is_said_once(day):
    found = stress_profiles(load(OTA), recordings([day])[0], 10)
    (task,) = yaml.safe_load(task_text(found, "as lived", "day"))["tasks"]
    modules = ("Power", "Sensing", "Communication", "Mobility", "Computation")
    assert set(task["legs"][0]["stresses"]) == {f"{module}/temperature" for module in modules}
    assert math.fsum(float(leg["duration"].split()[0]) for leg in task["legs"]) == pytest.approx(found.operating)


def test_beyond_what_a_model_is_printed_for_its_limit_is_taken_and_said(tmp_path):
    at = [START + i * SECOND for i in range(100)]
    path = write(tmp_path / "drive.mcap", [(t, t, 60.0 if i < 50 else 90.0) for i, t in enumerate(at)])
    design = """
schema_version: 1
name: Hot
components:
  Part:
    hazard: {formula: "base * temperature", unit: 1/h, source: none, variables: {base: {value: 1e-6},
             temperature: {value: 40 degC, unit: degC, range: [-20, 80]}}}
    signals: {temperature: {topic: /motor/temperature, field: temperature, unit: degC, range: [-40, 125]}}
"""
    robot = parse(design)
    found = stress_profiles(robot, recordings([path])[0], 20)
    (hot,) = found.profiles
    assert any("beyond what its model is printed for" in note for note in found.notes)
    # 50 s at 60 and 49 s at 90, of which 80 stands for the latter
    assert hot.error == pytest.approx((50 * 60 + 49 * 80) / (50 * 60 + 49 * 90) - 1, rel=1e-9)
    (task,) = parse_plan(task_text(found, "hot", "drive"), robot).tasks
    assert task.legs[-1].stresses["temperature"] == 80


def test_what_cannot_be_profiled(tmp_path):
    path = write(tmp_path / "drive.mcap", [(START, START, 20.0)])
    robot = load(OTA)
    with pytest.raises(SourceError, match="no topic '/ota/odom'"):
        stress_profiles(robot, recordings([path])[0], 20)
    unmeasured = parse("schema_version: 1\nname: R\npowered: {topic: /level, field: data}\n"
                       "components: {A: {rate: 1 FIT}}")  # fmt: skip
    with pytest.raises(SourceError, match="no part of R has a measured input"):
        stress_profiles(unmeasured, recordings([path])[0], 20)
    with pytest.raises(SourceError, match="never on for any time"):
        stress_profiles(parse(MIXED.replace("/level, field: data", "/motor/temperature, field: variance")),
              recordings([path])[0], 20)  # fmt: skip


def test_more_legs_than_a_task_may_have(day, monkeypatch):
    found = stress_profiles(load(OTA), recordings([day])[0], 20)
    legs = yaml.safe_load(task_text(found, "as lived", "day"))["tasks"][0]["legs"]
    monkeypatch.setattr(profile, "MOST_LEGS", len(legs) - 1)
    with pytest.raises(RobophmError, match=f"{len(legs)} legs; expected at most {len(legs) - 1}, as with fewer levels"):
        task_text(found, "as lived", "day")


def test_names_that_yaml_would_read_otherwise(tmp_path):
    path = write(tmp_path / "drive.mcap", [(START + i * SECOND, START + i * SECOND, 20.0 + i) for i in range(5)])
    part = "components:\n  'a: #1, {\"x\"}':\n    rate: 1 FIT\n    acceleration: {model: q10}\n" + (
        "    signals: {temperature: {topic: /motor/temperature, field: temperature, unit: degC}}\n"
        "  other: {rate: 1 FIT, acceleration: {model: q10}}\n"
    )
    robot = parse(f"schema_version: 1\nname: R\n{part}")
    text = task_text(stress_profiles(robot, recordings([path])[0], 20), 'name: "x" #', "drive\nwith: break")
    (task,) = parse_plan(text, robot).tasks
    assert task.name == 'name: "x" #'
    assert list(task.legs[0].stresses) == ['a: #1, {"x"}/temperature']
    with pytest.raises(DesignError):
        parse_plan(text.replace('a: #1, {\\"x\\"}', "b"), robot)
