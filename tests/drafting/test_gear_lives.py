"""Lives of gears at the work of their joints: by the catalogue's law, closed forms and sampling."""

import math

import numpy as np
import pytest
from tests.drafting.robots import joints, record

from robophm.core.units import quantity
from robophm.design.draft import DraftPart, inline
from robophm.design.file import parse
from robophm.drafting.drafting import evidence
from robophm.drafting.gear_lives import Spread, at_work, mean_speed
from robophm.drafting.seen import NOTHING, Seen, SeenSignal
from robophm.health.drawn_rates import draw_rates
from robophm.health.plant import Plant
from robophm.parts import graded

LOAD = {"signals": {"load": {"topic": "/joint_states", "field": "effort[elbow]", "rated": 50}}}
RATED = 7000
"""L10 of the series CSF at rated speed and torque [h], as its catalogue has it."""


def gear(entry="strain_wave_gear", velocity=2.0, **keys):
    return DraftPart("elbow", "gear", entry, "joint elbow", "", "elbow", 100.0, velocity, keys)


def seen(**speeds):
    return Seen((), (), tuple(SeenSignal("/joint_states", f"{kind}[elbow]", kind, "", 0, 1, 9, speed)
                              for kind, speed in speeds.items()))  # fmt: skip


def life(part):
    return quantity(part.keys["l10"], "h"), part.keys["uncertainty"]["error_factor"]


def part_text(name, part):
    keys = {key: said for key, said in part.content().items() if key != "signals"}
    return f"  {name}: {inline(keys)}\n"


def sampled(*ends):
    """Mean and error factor of a product of lognormal factors, each within ends that are its 5 and 95 %."""
    random = np.random.default_rng(1)
    logs = [np.log(low * high) / 2 + random.standard_normal(400_000) * np.log(high / low) / 2 / 1.6448536
            for low, high in ends]  # fmt: skip
    product = np.exp(sum(logs))
    return product.mean(), np.quantile(product, 0.95) / np.median(product)


@pytest.mark.parametrize("ends", [(0.1, 1.0), (1.0, 4.25), (0.5, 0.5000001)])
def test_a_spread_has_the_mean_of_its_lognormal_distribution(ends):
    assert Spread(*ends).mean == pytest.approx(sampled(ends)[0], rel=0.01)


def test_at_half_its_speed_a_gear_lives_twice_as_long():
    lives = [life(at_work([gear(**LOAD)], seen(velocity=speed))[0]) for speed in (0.4, 0.2)]
    assert lives[1][0] == pytest.approx(2 * lives[0][0], rel=1e-4)
    assert lives[1][1] == lives[0][1]


def test_what_is_recorded_narrows_the_range_and_what_is_not_is_as_wide_as_it_was_said():
    """The ends: 0.2 of the limit, which is 1 to 4.25 rated speeds; rated torque 0.4 to 0.6 of the limit where a half
    counts as 1; the error factor of 2 is the entry's own."""
    own = (0.5, 2.0)
    recorded, assumed = (at_work([gear(**keys)], heard)[0]
                         for keys, heard in ((LOAD, seen(position=0.4)), ({}, NOTHING)))  # fmt: skip
    of_load = ((0.5 / 0.6) ** 3, (0.5 / 0.4) ** 3)
    mean, _ = sampled((0.2, 0.85), of_load)
    hours, error = life(recorded)
    assert hours == pytest.approx(RATED / mean, rel=0.01)
    assert error == pytest.approx(sampled(own, (0.2, 0.85), of_load)[1], rel=0.02)
    mean, _ = sampled((0.1, 1.0), (0.125, 1.0))
    hours, wide = life(assumed)
    assert hours == pytest.approx(RATED / mean, rel=0.01)
    assert wide == pytest.approx(sampled(own, (0.1, 1.0), (0.125, 1.0))[1], rel=0.02)
    assert wide > error
    assert [graded(one.keys["source"]) for one in (recorded, assumed)] == [
        "strain_wave_gear, grade B", "strain_wave_gear, grade C"]  # fmt: skip


def test_a_load_that_is_bound_later_is_not_counted_twice():
    """At the rated torque a gear lives as long as if the torque had never been assumed."""
    at_once, later = (at_work([gear(**keys)], NOTHING)[0] for keys in (LOAD, {}))
    reference = later.keys["acceleration"]["reference_load"]
    bound = Spread((0.5 / 0.6) ** 3, (0.5 / 0.4) ** 3).mean
    assert life(later)[0] * reference**3 == pytest.approx(life(at_once)[0] * bound, rel=1e-3)


@pytest.mark.parametrize(
    ("heard", "velocity", "why"),
    [
        (NOTHING, 2.0, ""),
        (seen(velocity=0.4), None, ""),  # no limit says what it is a share of
        (seen(velocity=0.001), 2.0, "hardly moved"),
        (seen(position=2.5), 2.0, "faster than its limit"),  # a position that jumps
        (seen(position=0.0), 2.0, ""),
    ],
)
def test_a_speed_that_tells_nothing_is_no_speed(heard, velocity, why):
    (one,) = at_work([gear(velocity=velocity, **LOAD)], heard)
    assert life(one) == life(at_work([gear(**LOAD)], NOTHING)[0])
    assert "10% to 100% of the rated" in one.assumed
    assert why in one.assumed


def test_a_motor_that_turns_slower_than_its_makers_statement_lives_as_long_or_longer():
    """Between grease of the same age and as many turns: 20,000 h and 20,000 h over the share of the highest speed."""
    (slow,) = at_work([gear("servo_motor")], seen(velocity=0.2))
    mean, error = sampled((0.1, 1.0), (1 / 3, 3.0))
    own = math.exp((math.log(3) / 1.6448536) ** 2 / 2)  # the mean of the entry's own factor, which is in its L10
    assert life(slow) == pytest.approx((20_000 / (mean / own), error), rel=0.02)
    assert "grade B" in slow.keys["source"]
    for speeds in ({}, {"velocity": 0.001}, {"velocity": 3.0}):  # nothing tells: the maker's statement as it stands
        assert at_work([gear("servo_motor")], seen(**speeds)) == [gear("servo_motor")]


def test_other_parts_stay_as_they_are_and_a_gear_without_a_law_of_load_has_a_range_of_speed_alone():
    motor = gear("bldc_motor")
    assert at_work([motor], seen(velocity=1.0)) == [motor]
    (worm,) = at_work([gear("worm_gear")], NOTHING)
    assert "acceleration" not in worm.keys
    assert life(worm)[0] == pytest.approx(10_000 / sampled((0.1, 1.0))[0], rel=0.01)
    assert graded(worm.keys["source"]) == "worm_gear, grade C"


def test_the_mean_speed_is_of_the_velocity_and_of_the_position_where_that_is_zero(tmp_path):
    """A swing of ±1 rad in 12 s: four radians each time; the driver of the fixture fills velocities with zeros."""
    names = ["elbow"]
    swings = (joints(t / 20, names, [math.sin(2 * math.pi * t / 240)], [1.0]) for t in range(240 * 20 + 1))
    still = evidence(None, [record(tmp_path / "positions.mcap", swings)]).seen
    assert mean_speed("elbow", still) == pytest.approx(4 / 12, rel=1e-3)
    assert math.isnan(mean_speed("wrist", still))
    told = ((t, topic, type_, {**fields, "velocity": np.array([-0.5 if t < 10 else 0.1])})
            for t, topic, type_, fields in (joints(k / 10, names, [0.0], [1.0]) for k in range(201)))  # fmt: skip
    heard = evidence(None, [record(tmp_path / "velocities.mcap", told)]).seen
    assert mean_speed("elbow", heard) == pytest.approx((10 * 0.5 + 10 * 0.1) / 20, rel=0.01)


def test_gears_that_work_differently_share_what_is_not_known_of_their_kind():
    slow, fast = (part_text(f"{name} gear", at_work([gear(**LOAD)], seen(velocity=speed))[0])
                  for name, speed in (("slow", 0.1), ("fast", 1.0)))  # fmt: skip
    robot = parse(f"schema_version: 1\nname: arm\ncomponents:\n{slow}{fast}  imu: {{part: imu}}\n")
    assert robot.modes[1].rate == pytest.approx(10 * robot.modes[0].rate, rel=1e-3)
    drawn = draw_rates(Plant(robot), 100, seed=3)
    assert drawn[0] == pytest.approx(drawn[1], rel=1e-12)
    assert drawn[0] != pytest.approx(drawn[2], rel=0.1)
