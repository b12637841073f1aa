"""Readings made of samples as they come: those of plain loops, bit for bit however samples are split, within bounds."""

import itertools
import json
import math

import numpy as np
import pytest

from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.health.ledger import Ledger
from robophm.health.wear_readings import MOST_READINGS, Ageing, WearCourse

DESIGN = """
schema_version: 1
name: cart
components:
  motor:
    rate: 20 FPMH
    wear: {{topic: /a, field: x, every: {every} s, reading: {reading}, threshold: 8, range: [-1e9, 1e9],
           load: {{topic: /l, field: x, range: [2, 3], max_age: 2 s}}, ambient: {{topic: /t, field: x, max_age: 3 s}}}}
  fan: {{rate: 1 FPMH, wear: {{topic: /a, field: x, every: {every} s, reading: {reading}, threshold: 8}}}}
"""
RNG = np.random.default_rng(3)
N = 6000
TIMES = np.sort(RNG.integers(0, 2000 * SECOND, N))
VALUES = 1e3 + RNG.standard_t(5, N)
OTHERS = np.sort(RNG.integers(0, 2000 * SECOND, 1500))
LOAD, AIR = RNG.uniform(1, 4, 1500), RNG.uniform(15, 25, 1500)
COLUMNS = {"/a.x": (TIMES, VALUES), "/l.x": (OTHERS, LOAD), "/t.x": (OTHERS, AIR)}


def wear(reading="mean", every=20, part=0):
    return parse(DESIGN.format(reading=reading, every=every)).modes[part].wear


def ageing(begin, end):
    """Age is a second for each, effective age three times that."""
    hours = np.array([[begin / SECOND], [3 * begin / SECOND]]), np.array([[(end - begin) / SECOND]] * 2) * [[1], [3]]
    return Ageing(np.array([begin, end]), *hours)


def take(course, said, cuts):
    for begin, end in itertools.pairwise(cuts):
        some = {
            signal: (times[(times > begin) & (times <= end)], values[(times > begin) & (times <= end)])
            for signal, (times, values) in COLUMNS.items()
        }
        course.take(said, some, ageing(begin, end))
    return course


@pytest.mark.parametrize("reading", ["mean", "rms", "kurtosis", "highest", "lowest"])
def test_they_are_those_of_plain_loops(reading):
    said = wear(reading)
    found = take(WearCourse.begin(said), said, [-1, 2000 * SECOND]).readings(said)
    by_stretch, ages = {}, {}
    for time, value in zip(TIMES.tolist(), VALUES.tolist(), strict=True):
        k = int(np.searchsorted(OTHERS, time, side="right")) - 1
        if k >= 0 and time - OTHERS[k] < 2 * SECOND and 2 <= LOAD[k] <= 3:
            by_stretch.setdefault(time // (20 * SECOND), []).append(value - AIR[k])
            ages.setdefault(time // (20 * SECOND), []).append(time / SECOND)
    usual = np.median([len(some) for some in by_stretch.values()])
    kept = [key for key, some in by_stretch.items() if len(some) >= usual / 4]
    x = [np.array(by_stretch[key]) for key in kept]
    expected = {
        "mean": [one.mean() for one in x],
        "rms": [one.std() for one in x],
        "kurtosis": [((one - one.mean()) ** 4).mean() / one.var() ** 2 for one in x],
        "highest": [one.max() for one in x],
        "lowest": [one.min() for one in x],
    }[reading]
    assert found.values == pytest.approx(expected, rel=1e-9)
    assert found.ages == pytest.approx([np.mean(ages[key]) for key in kept], rel=1e-9)
    assert found.effective == pytest.approx(3 * found.ages, rel=1e-12)
    assert found.when / SECOND == pytest.approx(found.ages, abs=1e-8)


def test_they_do_not_depend_on_how_samples_come_bit_for_bit():
    said = wear()
    whole = take(WearCourse.begin(said), said, [-1, 2000 * SECOND])
    cuts = [-1, *np.unique(RNG.integers(0, 2000 * SECOND, 300)).tolist(), 2000 * SECOND]
    pieces = WearCourse.begin(said)
    for part in (cuts[:150], cuts[149:]):  # killed between, and read back
        pieces = WearCourse.from_json(json.loads(json.dumps(take(pieces, said, part).to_json())))
    for one, other in zip(whole.stretches, pieces.stretches, strict=True):
        assert one[:7] == other[:7]  # ages are of other periods here, and evenly in each
        assert one.age == pytest.approx(other.age, rel=1e-12)
    assert pieces.left_out == whole.left_out


def test_stretches_double_when_there_are_too_many():
    said = wear("kurtosis", every=1, part=1)
    course = take(WearCourse.begin(said), said, [-1, *range(SECOND, 2001 * SECOND, SECOND)])
    assert course.doubled == 1
    assert len(course.stretches) == len({time // (2 * SECOND) for time in TIMES.tolist()}) < MOST_READINGS
    wide = wear("kurtosis", every=2, part=1)
    expected = take(WearCourse.begin(wide), wide, [-1, 2000 * SECOND]).readings(wide)
    found = course.readings(said)
    assert found.when == pytest.approx(expected.when, abs=1)
    assert found.values == pytest.approx(expected.values, rel=1e-6)
    assert found.ages == pytest.approx(expected.ages, rel=1e-9)


def test_thin_and_constant_stretches_and_times_of_rest_are_left_out():
    said = wear("kurtosis", every=10, part=1)
    course = WearCourse.begin(said)
    for k in range(9):
        times = np.arange(10) * SECOND + k * 10 * SECOND
        values = np.ones(10) if k == 4 else np.arange(10.0)
        how = ageing(0, 1) if k == 7 else ageing(k * 10 * SECOND, (k + 1) * 10 * SECOND)
        course.take(said, {"/a.x": (times, values)}, how)
    course.take(said, {"/a.x": (np.array([95 * SECOND]), np.array([100.0]))}, ageing(90 * SECOND, 100 * SECOND))
    found = course.readings(said)
    assert len(found.values) == 7
    assert found.left_out == {
        "stretches with less than 0.25 of the usual 10 samples, left out": 1,
        "stretches of one value alone, of which there is no kurtosis": 1,
        "readings while the part did not age, left out": 1,
    }


def test_a_new_part_begins_anew_and_an_older_ledger_still_opens():
    robot = parse(DESIGN.format(reading="mean", every=20))
    ledger = Ledger.new(robot)
    for mode in robot.modes:
        ledger.wear[mode.key] = take(WearCourse.begin(mode.wear), mode.wear, [-1, 2000 * SECOND])
    data = json.loads(json.dumps(ledger.to_json()))
    assert Ledger.of(robot, data).to_json() == data
    del data["wear"]  # as it was kept before wear was read live
    assert Ledger.of(robot, data).wear == {}
    ledger.replace([robot.modes[0].key])
    assert [*ledger.wear] == [robot.modes[1].key]
    assert math.isfinite(ledger.wear[robot.modes[1].key].stretches[0].mean)
