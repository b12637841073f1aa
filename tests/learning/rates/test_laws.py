"""What nobody doubts of rates that are learned, over random logs: more failures than promised never lower a rate."""

import math

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.learning.rates.failure_log import Seen, read_failure_log
from robophm.learning.rates.life_scale import at_rate
from robophm.learning.rates.rate_update import learn
from robophm.life import life_distributions

DESIGN = """
schema_version: 1
name: R
components:
  part: {quantity: %d, rate: 0.01 /h, life: {distribution: %s%s}%s}
"""


def shape_of(name, rng):
    """Its other parameters, as a design says them."""
    number = {
        "weibull": lambda: f", shape: {rng.uniform(0.4, 4):.3g}",
        "gamma": lambda: f", shape: {rng.uniform(0.4, 5):.3g}",
        "normal": lambda: f", deviation: {rng.uniform(10, 60):.3g} h",
        "lognormal": lambda: f", log_deviation: {rng.uniform(0.2, 1.5):.3g}",
        "loglogistic": lambda: f", shape: {rng.uniform(1.3, 6):.3g}",
        "extreme_value": lambda: f", scale: {rng.uniform(10, 40):.3g} h",
        "curve": lambda: f", shape: {rng.uniform(0.5, 2):.3g}",
    }.get(name, str)()
    located = name in ("weibull", "exponential", "lognormal", "gamma") and rng.random() < 0.25
    return number + (f", location: {rng.uniform(1, 20):.3g} h" if located else "")


def random_case(name, rng):
    """A design, and the rows of a log of it: several robots, used and repaired parts."""
    quantity = int(rng.integers(1, 4))
    sure = rng.choice(["", f", uncertainty: {{failures: {10 ** rng.uniform(-2, 3):.3g}}}",
                       f", uncertainty: {{error_factor: {rng.uniform(1.1, 30):.3g}}}"])  # fmt: skip
    rows = []
    for robot in range(rng.integers(1, 7)):
        lemon = 10 ** rng.uniform(-2, 0)
        for i in range(quantity):
            part = f"part[{i + 1}]" if quantity > 1 else "part"
            since = rng.uniform(0, 200) if rng.random() < 0.3 else 0.0
            age = since + 20 + lemon * 10 ** rng.uniform(-1, 2.3)
            failed = rng.random() < 0.5
            rows.append([part, f"r{robot}", age, since, failed, "repaired" if failed and rng.random() < 0.3 else ""])
            if rows[-1][-1]:
                rows.append([part, f"r{robot}", age + 10 ** rng.uniform(-1, 2), "", rng.random() < 0.5, ""])
    return parse(DESIGN % (quantity, name, shape_of(name, rng), sure)), rows


def seen_in(robot, rows, path):
    path.write_text("part,robot,exposure [h],since [h],censored,action,remaining\n" + "".join(
        f"{part},{name},{age!r},{since!r},{'' if failed else 'yes'},{action},{0.5 if action else ''}\n"
        for part, name, age, since, failed, action in rows
    ).replace("''", ""))  # fmt: skip
    return read_failure_log(path, robot).seen


def promised(mode, seen, times):
    """Failures that a rate so many times the stated one promises in what was seen."""
    if mode.life.degree is not None:
        return sum(one.expected for one in seen) * times**mode.life.degree
    life = at_rate(mode.life, times)
    return math.fsum(one.parts * float(life.increment(one.start, one.length)) for some in seen for one in some.lives)


@pytest.mark.parametrize("name", [one for one in life_distributions() if one not in ("markov", "piecewise")])
def test_laws(name, tmp_path):
    """What the learned rate promises lies between what the stated one does and what was seen; and one failure more
    never lowers it, of the fleet or of the robot that had it.
    """
    rng, told, refused = np.random.default_rng(sum(map(ord, name))), 0, []
    for _ in range(10):
        robot, rows = random_case(name, rng)
        try:
            seen = seen_in(robot, rows, tmp_path / "log.csv")
            (found,) = learn(robot, seen)
        except DataError as error:
            refused.append(str(error))
            continue
        told += 1
        mode, n, stated = found.mode, found.failures, found.expected
        assert stated == pytest.approx(promised(mode, seen, 1.0), rel=1e-9)
        low, high = sorted((stated, n))
        assert low * (1 - 1e-5) <= promised(mode, seen, found.factor) <= high * (1 + 1e-5)
        assert (found.factor - 1) * (n - stated) >= 0
        assert found.low <= found.factor <= found.high
        working = [i for i, row in enumerate(rows) if not row[4]]
        if not working:
            continue
        more = [list(row) for row in rows]
        i = working[rng.integers(len(working))]
        more[i][4] = True
        try:
            seen_more = seen_in(robot, more, tmp_path / "more.csv")
            (after,) = learn(robot, seen_more)
        except DataError:
            continue
        assert after.failures == n + 1
        assert after.factor >= found.factor * (1 - 1e-5)
        which = found.robots.index(rows[i][1])
        one, other = (some.fleet.robots[which].times for some in (found, after))
        assert other >= one * (1 - 1e-5)
    assert told >= 5
    assert all("whatever its rate" in one or "at which it cannot" in one for one in refused)


@pytest.mark.parametrize("shape", [1.2, 1.5, 2.0, 4.0])
@pytest.mark.parametrize("early", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("robots", [1, 2, 5])
def test_one_lemon_does_not_lower_the_rate_of_its_fleet(shape, early, robots):
    """Two failures of one robot where 0.0217 were promised of all: its rate was 0.59 times the stated one."""
    robot = parse(DESIGN % (1, "weibull", f", shape: {shape}", ""))
    (mode,) = robot.modes
    others = [Seen(mode, f"r{i}", 0, (0.0217 - early) / max(robots - 1, 1), 10) for i in range(1, robots)]
    (found,) = learn(robot, [Seen(mode, "r0", 2, 0.0217 if robots == 1 else early, 10), *others])
    assert 2 ** (1 / shape) < found.factor <= (2 / 0.0217) ** (1 / shape)


def test_nothing_seen_changes_nothing():
    """Of every shape: the mean of a power of a gamma is not 1, and was taken for it."""
    for shape in (0.5, 1.0, 3.0):
        robot = parse(DESIGN % (1, "weibull", f", shape: {shape}", ""))
        (found,) = learn(robot, [Seen(robot.modes[0], "a", 0, 0.0, 0.0)])
        assert found.factor == 1.0
