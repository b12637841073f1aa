"""The arm: its figures against sums by hand from its data sheet, which is repeated here."""

import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import DesignError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.design.task import Knowledge, Leg, Task
from robophm.design.task_file import load_plan, parse_plan
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import completion, deciding_components
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant

ARM = Path(__file__).parents[2] / "examples" / "arm"
JOINTS = range(1, 7)

# Per hour, start or cycle.
WINDING, BEARING, COIL, ENCODER = 1.5e-6, 2.5e-6, 0.3e-6, 5.8e-6
DRIVE, LINING, SEAL, VALVE = 9.2e-9, 2e-7, 3.66e-8, 1e-8
CONTROLLER, SAFETY, CAMERA = 6e-6, 0.8e-6, 0.9e-6


@pytest.fixture(scope="module")
def robot():
    return load(ARM / "robot.yaml")


@pytest.fixture(scope="module")
def plan(robot):
    return load_plan(ARM / "tasks.yaml", robot)


@pytest.fixture(scope="module")
def plant(robot):
    return Plant(robot)


@pytest.fixture
def new(plant):
    """Of an arm that has not worked yet; what is known as a keyword."""

    def look(**known):
        knowledge = Knowledge(**{kind: frozenset(paths) for kind, paths in known.items()})
        return outlooks(plant, ExposureIntegrator(plant.robot), Ledger.new(plant.robot), knowledge=knowledge)[
            "sensor_based"
        ]

    return look


def weibull(age, rate, shape):
    """H of a Weibull life whose mean is 1/rate."""
    return (age * rate * math.gamma(1 + 1 / shape)) ** shape


def pair_fails(hazard):
    """Of two that worked, both fail."""
    return math.expm1(-hazard) ** 2


def joint(hours, cycles, starts, load=1.0, temperature=40.0):
    """H of all of a new joint but its encoders; the windings are 20 K above the sensor, as at the reference of 60."""
    q10 = 2 ** ((temperature - 40) / 10)
    return math.fsum((
        WINDING * q10 * hours, weibull(load**3 * hours, BEARING, 1.5), weibull(load**3 * cycles, DRIVE, 1.17),
        COIL * q10 * hours, weibull(starts, LINING, 2),
    ))  # fmt: skip


def gripper(cycles):
    return 2 * weibull(cycles, SEAL, 2) + VALVE * cycles


def test_it_says_nothing_odd(robot, plan):
    assert robot.warnings == ()
    assert sum(part.quantity for part in robot.all_components()) == 6 * 5 + 3 + 4
    assert {mode.clock for mode in robot.modes} == {"operating", "cycles", "starts"}
    assert all(mode.uncertainty and mode.source for mode in robot.modes)
    assert [task.name for task in plan.tasks] == ["empty boxes", "full boxes", "full boxes, arm stretched out"]
    assert plan.every == 12
    assert plan.knowledge.working == {"Joint 2/Encoder[1]", "Joint 2/Encoder[2]", "Control/Camera"}


def test_the_drive_is_the_catalogues(robot):
    """L50 = 35000 h at 2000 rpm and rated torque, L10 a fifth of that, with 50 turns to a cycle."""
    life = next(mode.life for mode in robot.modes if mode.path == "Joint 1/Drive")
    cycles = 35_000 * 60 * 2000 / 50
    assert life.quantile(0.5) == pytest.approx(cycles, rel=0.01)
    assert life.quantile(0.1) == pytest.approx(cycles / 5, rel=0.01)


def test_a_new_arms_hazard_rate_is_that_of_its_single_points(robot, plant):
    """What wears out does not yet, and an encoder of two that fails is not missed; 300 cycles in an hour."""
    by_hand = 6 * (WINDING + COIL) + 300 * VALVE + CONTROLLER + 2 * SAFETY + CAMERA
    assert as_designed(plant).hazard_rate(robot.diagram) == pytest.approx(by_hand, rel=1e-12)


@pytest.mark.parametrize("hours", [1.0, 1000.0, 20_000.0])
def test_reliability_as_designed(robot, plant, hours):
    state = as_designed(plant).survival_curve(robot.diagram, np.array([hours]))
    pair = pair_fails(ENCODER * hours)
    hazard = 6 * joint(hours, 300 * hours, 4 * hours) + gripper(300 * hours)
    hazard += (CONTROLLER + 2 * SAFETY + CAMERA) * hours - 6 * math.log1p(-pair)
    assert state.works[0] == pytest.approx(math.exp(-hazard), rel=1e-12)
    assert state.failed[0] == pytest.approx(-math.expm1(-hazard), rel=1e-12)


def test_the_first_task_as_lived(plan, new):
    """Empty boxes at half the rated torque and reference temperature: one leg of the whole arm."""
    warm = ENCODER * 4
    hazard = 6 * joint(4, 1200, 16, load=0.5) - 6 * math.log1p(-pair_fails(warm)) + gripper(1200)
    hazard += (CONTROLLER + 2 * SAFETY + CAMERA) * 4
    found = completion(new(), plan.tasks[0])
    assert found.failure == pytest.approx(-math.expm1(-hazard), rel=1e-12)
    assert found.probability == pytest.approx(math.exp(-hazard), rel=1e-12)


def test_who_only_holds_needs_only_what_holds(plan, new):
    """Full boxes: 3 h at 50 °C, then 20 min on the brakes, the gripper and the safety controller, which is at 35 °C."""
    hot, third = 2.0, 20 / 60
    hazard = 6 * joint(3, 900, 12, load=0.9, temperature=50) - 6 * math.log1p(-pair_fails(ENCODER * hot * 3))
    hazard += gripper(900) + (CONTROLLER + 2 * SAFETY + CAMERA) * hot * 3
    hazard += 3 * COIL * third + 2 * SAFETY * 2**-0.5 * third
    assert completion(new(), plan.tasks[1]).failure == pytest.approx(-math.expm1(-hazard), rel=1e-12)


def carrying(**stresses):
    return Task((Leg(8.0, cycles=2400, starts=32, functions=("pick", "place"), stresses=stresses),))


def hazards_apart(outlook, one, other):
    """How much more cumulative hazard one task brings than another."""
    failures = (completion(outlook, task).failure for task in (one, other))
    return -math.log1p(-next(failures)) + math.log1p(-next(failures))


@pytest.mark.parametrize("heavier", [0.8, 1.0, 1.5])
def test_a_heavier_payload_costs_its_cube(new, heavier):
    """Age goes with the cube of the load; what a Weibull of shape β makes of it, with the 3β-th power."""
    bearings, drives = 6 * weibull(8, BEARING, 1.5), 6 * weibull(2400, DRIVE, 1.17)
    more = bearings * (heavier**4.5 - 0.5**4.5) + drives * (heavier**3.51 - 0.5**3.51)
    assert hazards_apart(new(), carrying(load=heavier), carrying(load=0.5)) == pytest.approx(more, rel=1e-9)


def test_the_nearest_load_holds(new):
    """The second joint bears 1.3 where the others bear 0.9."""
    more = joint(8, 2400, 32, load=1.3) - joint(8, 2400, 32, load=0.9)
    stretched = carrying(load=0.9, **{"Joint 2/load": 1.3})
    assert hazards_apart(new(), stretched, carrying(load=0.9)) == pytest.approx(more, rel=1e-9)


def test_as_designed_no_payload_counts(plant):
    nominal = as_designed(plant)
    assert completion(nominal, carrying(load=1.5)) == completion(nominal, carrying())


def test_with_an_encoder_lost_the_other_decides(new):
    lost = new(failed=["Joint 2/Encoder[1]"])
    both, one = (completion(outlook, carrying(load=0.5)) for outlook in (new(), lost))
    ratio = math.exp(-ENCODER * 8) / (1 - pair_fails(ENCODER * 8))
    assert one.probability / both.probability == pytest.approx(ratio, rel=1e-12)
    at_once = [found.path for found in deciding_components(lost, carrying(load=0.5))].index("Joint 2/Encoder")
    assert at_once < [found.path for found in deciding_components(lost, carrying(load=0.5))].index("Joint 1/Encoder")


def test_a_broken_brake_stops_what_needs_it(new):
    """Gravity pulls at the second, third and fifth joint."""
    hold = Task((Leg(1.0, cycles=0, starts=0, functions=("hold",)),))
    hazard = 3 * COIL + 2 * SAFETY
    assert completion(new(), hold).failure == pytest.approx(-math.expm1(-hazard), rel=1e-12)
    for number in JOINTS:
        broken = new(failed=[f"Joint {number}/Brake"])
        assert (completion(broken, hold).probability == 0) == (number in (2, 3, 5))
        assert completion(broken, carrying()).probability == 0


def test_a_module_does_not_fail_as_such(robot):
    text = "schema_version: 1\ntasks: [{duration: 1 h}]\nknowledge: {failed: [Joint 3]}"
    with pytest.raises(DesignError, match=r"tasks:3: .*'Joint 3' is a module; expected a part of it .* Joint 3/Motor$"):
        parse_plan(text, robot)


def test_a_shift_under_half_the_rated_torque(robot):
    """Fifty cycles in ten minutes: an eighth of each is lived, whichever way the torque points."""
    samples = []
    for i in range(600):
        samples += [
            Sample(i * SECOND, f"/joint_states.effort[joint_{k + 1}]", -70.0 if k < 3 else 20.0) for k in range(6)
        ]
        samples.append(Sample(i * SECOND, "/gripper/carrying.data", float(i % 12 >= 6)))
    ledger = Ledger.new(robot)
    ledger.started = 0
    ExposureIntegrator(robot).integrate(ledger, samples, 600 * SECOND)
    for mode, age, effective in zip(robot.modes, ledger.age.value, ledger.effective.value, strict=True):
        if mode.path.endswith("/Drive"):
            assert (age, effective) == pytest.approx((50, 50 / 8), rel=1e-12)
        elif mode.path.endswith("/bearing"):
            assert (age, effective) == pytest.approx((1 / 6, 1 / 48), rel=1e-12)


def test_torque_is_measured_as_a_share_of_the_rated_one(robot):
    motors = {mode.path: mode for mode in robot.modes}
    for number in JOINTS:
        (stress,) = motors[f"Joint {number}/Drive"].stresses
        channel, rated = stress.channels["load"], 140 if number < 4 else 40
        assert channel.signal == f"/joint_states.effort[joint_{number}]"
        assert channel.unit == "N*m"
        assert channel.scale * -70 + channel.offset == pytest.approx(-70 / rated, rel=1e-15)
        assert (channel.low, channel.high) == pytest.approx((-3, 3), rel=1e-15)
