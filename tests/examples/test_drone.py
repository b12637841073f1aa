"""The drone: its figures against the enumeration of all that can happen to its rotors."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.design.file import load
from robophm.design.task import Knowledge, Leg, Task
from robophm.design.task_file import load_plan
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import completion, repetitions
from robophm.health.outlooks import as_designed, nominal_outlook, outlooks
from robophm.health.plant import Plant

DRONE = Path(__file__).parents[2] / "examples" / "drone"
ROTORS = range(8)

# Per hour, start or cycle.
BEARING, WINDING, START, ESC, PROPELLER = 120e-6, 10e-6, 4e-6, 25e-6, 15e-6
WEAR, CELL, SHELF, DISTRIBUTION = 0.002, 20e-6, 2e-6, 3e-6
AUTOPILOT, IMU, CAMERA, GIMBAL, GPS = 8e-6, 12e-6, 40e-6, 90e-6, 6e-6


@pytest.fixture(scope="module")
def robot():
    return load(DRONE / "robot.yaml")


@pytest.fixture(scope="module")
def plant(robot):
    return Plant(robot)


@pytest.fixture
def new(plant):
    """Of a drone that has not flown yet."""

    def look(*failed):
        known = Knowledge(failed=frozenset(failed))
        return outlooks(plant, ExposureIntegrator(plant.robot), Ledger.new(plant.robot), knowledge=known)[
            "sensor_based"
        ]

    return look


def weibull(age, rate, shape):
    """H of a Weibull life whose mean is 1/rate."""
    return (age * rate * math.gamma(1 + 1 / shape)) ** shape


def q10(temperature, reference=40.0):
    return 2 ** ((temperature - reference) / 10)


def rotor(legs):
    """H of a new rotor after each leg of (hours, starts, load, temperature, voltage)."""
    sums = np.zeros(4)
    found = []
    for hours, starts, thrust, temperature, voltage in legs:
        electric = ESC * q10(temperature + 15, 55) * (voltage / 46) ** 4 + WINDING * q10(temperature)
        sums += thrust**3 * hours, hours * electric, thrust**3 * hours * PROPELLER, starts * START
        found.append(weibull(sums[0], BEARING, 1.5) + sums[1:].sum())
    return found


def battery(legs):
    """H of a new battery after each leg of (hours, cycles, temperature)."""
    hazard = charges = 0.0
    found = []
    for hours, cycles, temperature in legs:
        hazard += hours * (CELL * q10(temperature) + SHELF)
        charges += cycles
        found.append(hazard + weibull(charges, WEAR, 4))
    return found


def level(failed):
    """Which rotors may fail in flight: those of one pair of opposite ones."""
    return len({i % 4 for i in failed}) <= 1


def full_thrust(failed):
    return len(failed) <= 1


def enumerated(needs, hazards, given=None):
    """(P(all needs are met), P(not)), summed over every interval in which every rotor may fail.

    ``needs[k]`` says of the rotors failed by the end of leg k whether that will do; ``hazards[i][k]`` is H then.
    Interval 0 is before now: what is ``given`` is that the rotors failed then will do.
    """
    chances = []
    for of_rotor in hazards:
        ends = [0.0, *of_rotor]
        ways = [math.exp(-a) * -math.expm1(a - b) for a, b in itertools.pairwise(ends)]
        chances.append([*ways, math.exp(-ends[-1])])
    good, bad = [], []
    for ways in itertools.product(range(len(chances[0])), repeat=len(chances)):
        chance = math.prod(of[way] for of, way in zip(chances, ways, strict=True))
        if not chance:
            continue
        by_then = [[i for i, way in enumerate(ways) if way <= k] for k in range(len(needs))]
        if given and not given([i for i, way in enumerate(ways) if way == 0]):
            continue
        met = all(need(failed) for need, failed in zip(needs, by_then, strict=True))
        (good if met else bad).append(chance)
    works, fails = math.fsum(good), math.fsum(bad)
    return works / (works + fails), fails / (works + fails)


def failing(*chances):
    """P(any of independent things fails), without a difference from one."""
    return -math.expm1(math.fsum(math.log1p(-chance) for chance in chances))


def both(hazard):
    return math.expm1(-hazard) ** 2


def exponential(hazard):
    return -math.expm1(-hazard)


def cruise(hours=1.0, **stresses):
    return Task((Leg(hours, starts=0, cycles=0, functions=("cruise",), stresses=stresses),))


def test_it_says_nothing_odd(robot):
    assert robot.warnings == ()
    assert {mode.clock for mode in robot.modes} == {"operating", "calendar", "cycles", "starts"}
    assert all(mode.uncertainty and mode.source for mode in robot.modes)
    samples = next(mode.uncertainty.samples for mode in robot.modes if mode.path == "Propulsion/Rotor 8/Motor/bearing")
    assert samples == pytest.approx((60 / 120, 100 / 120, 1, 200 / 120), rel=1e-15)
    assert math.fsum(samples) / 4 == pytest.approx(1, rel=1e-15)


def test_the_table_is_the_list(robot):
    listed, table = (load_plan(DRONE / name, robot) for name in ("tasks.yaml", "tasks.csv"))
    assert table.tasks == listed.tasks
    assert [len(task.legs) for task in table.tasks] == [5, 3]
    assert [task.distance for task in table.tasks] == pytest.approx([6000, 6000], rel=1e-15)
    assert (listed.every, table.every) == (24, None)  # a table holds no such word


def test_a_new_drones_hazard_rate_is_that_of_its_single_points(robot, plant):
    by_hand = DISTRIBUTION + AUTOPILOT + CAMERA + GIMBAL + GPS
    assert as_designed(plant).hazard_rate(robot.diagram) == pytest.approx(by_hand, rel=1e-12)


@pytest.mark.parametrize("hours", [0.1, 1.0, 100.0])
@pytest.mark.parametrize("thrust", [0.8, 1.5])
def test_cruise_by_enumeration_of_its_rotors(new, hours, thrust):
    stresses = {"load": thrust, "temperature": 30, "Propulsion/temperature": 60, "voltage": 48}
    found = completion(new(), cruise(hours, **stresses))
    _, fails = enumerated([level], [rotor([(hours, 0, thrust, 60, 48)])] * 8)
    single = (DISTRIBUTION + AUTOPILOT + GPS) * q10(30) * hours
    pairs = both(battery([(hours, 0, 30)])[0]), both(IMU * q10(30) * hours)
    assert found.failure == pytest.approx(failing(fails, exponential(single), *pairs), rel=1e-12)
    assert found.probability == pytest.approx(1 - failing(fails, exponential(single), *pairs), rel=1e-12)


def test_a_flight_by_enumeration(robot, new):
    """The parcel: one rotor may be out at take-off, an opposite pair later; the GPS may be out when landing."""
    task = load_plan(DRONE / "tasks.csv", robot).tasks[1]
    hours = [1 / 60, 500 / 3600, 1 / 60]
    warmth, thrust, volts, starts = (25, 40, 40), (1.6, 1.4, 1.2), (46, 48, 46), (1, 0, 0)
    hazards = rotor(list(zip(hours, starts, thrust, warmth, volts, strict=True)))
    _, fails = enumerated([full_thrust, level, level], [hazards] * 8)
    warm = [time * q10(degrees) for time, degrees in zip(hours, warmth, strict=True)]
    single = (DISTRIBUTION + AUTOPILOT) * sum(warm) + GPS * sum(warm[:2])
    batteries = both(battery(list(zip(hours, starts, warmth, strict=True)))[-1])
    expected = failing(fails, exponential(single), batteries, both(IMU * sum(warm)))
    assert completion(new(), task).failure == pytest.approx(expected, rel=1e-12)


def test_a_worn_drone_by_enumeration(robot, plant):
    """Rotors that nobody has looked at may have failed already: all that is known is that it flies."""
    ages = np.array([300.0 * (1 + i % 7) if mode.clock == "operating" else 0.0 for i, mode in enumerate(robot.modes)])
    aged = dict(zip((mode.path for mode in robot.modes), ages, strict=True))

    def lived(i, more):
        a = [aged[f"Propulsion/Rotor {i + 1}/{part}"] + more
             for part in ("Motor/bearing", "Motor/winding", "ESC", "Propeller")]  # fmt: skip
        return weibull(a[0], BEARING, 1.5) + WINDING * a[1] + ESC * a[2] + PROPELLER * a[3]

    hours = 2.0
    now = [lived(i, 0.0) for i in ROTORS]
    assert max(now) > 0.1
    assert min(now) != max(now)
    _, fails = enumerated([level, level], [[lived(i, 0.0), lived(i, hours)] for i in ROTORS], given=level)
    b = aged["Power/Battery/cell"] * CELL
    more = (CELL + SHELF) * hours
    worked = 1 - both(b)
    batteries = (both(b + more) - both(b)) / worked
    single = (DISTRIBUTION + AUTOPILOT + GPS) * hours
    expected = failing(fails, exponential(single), batteries, both(IMU * hours))  # IMUs are monitored: both work
    found = completion(nominal_outlook(plant, ages), cruise(hours))
    assert found.failure == pytest.approx(expected, rel=1e-9)


MOTOR = "Propulsion/Rotor {}/Motor".format


def test_one_rotor_out_is_flown_with_six(new):
    """Known to have lost the first: the fifth, opposite, no longer matters, and each of the others does."""
    six = 6 * rotor([(1.0, 0, 1.0, 40, 46)])[0]
    others = six + DISTRIBUTION + AUTOPILOT + GPS
    expected = failing(exponential(others), both(battery([(1.0, 0, 40)])[0]), both(IMU))
    assert completion(new(MOTOR(1)), cruise()).failure == pytest.approx(expected, rel=1e-12)
    assert completion(new(MOTOR(1), MOTOR(5)), cruise()).failure == pytest.approx(expected, rel=1e-12)


def test_two_rotors_out(new):
    """Neighbours bring it down; opposites do not, but with them it does not take off again."""
    off = Task((Leg(0.1, functions=("take off",)),))
    assert completion(new(MOTOR(1), MOTOR(2)), cruise()).probability == 0
    assert completion(new(MOTOR(1), MOTOR(5)), cruise()).probability > 0.999
    assert completion(new(MOTOR(1), MOTOR(5)), off).probability == 0
    assert completion(new(MOTOR(1)), off).probability > 0.99


def test_what_films_sleeps_while_it_is_carried(plant):
    """An hour of cruise at a duty of 0.05, then an hour in which camera and gimbal must work."""
    legs = cruise().legs, (Leg(1.0, starts=0, cycles=0, functions=("film",)),)
    both_legs = completion(as_designed(plant), Task(legs[0] + legs[1]))
    flown = completion(as_designed(plant), cruise())
    more = -math.log1p(-both_legs.failure) + math.log1p(-flown.failure)
    assert more == pytest.approx((CAMERA + GIMBAL) * 1.05, rel=1e-9)


def test_batteries_fail_last_and_fast(robot, plant):
    """Charge by charge nothing, until both come to their end: what a pair of Weibull shape 4 does."""
    climb = [Task((Leg(0.1, starts=0, cycles=1, functions=("land",)),))]
    failures = np.concatenate(list(repetitions(as_designed(plant), climb, 600)), axis=1)[1]

    def fails(n):
        """P(both have failed after n flights), P(flown n times) of all that landing needs but the rotors."""
        hazard = n * 0.1 * (CELL + SHELF) + weibull(n, WEAR, 4)
        return both(hazard)

    for n in (400, 500, 600):
        batteries = (fails(n) - fails(n - 1)) / (1 - fails(n - 1))
        assert failures[n - 1] == pytest.approx(batteries, rel=0.01)  # the rotors' share is far below
    assert failures[0] < 1e-5 < 1e-3 < failures[599]
