"""How robots fail, against closed forms. All tests of chance have p > 0.001 at a fixed seed."""

import math

import numpy as np
import pytest
from scipy import integrate, stats

from robophm.simulation.robots import END, FAILED, INSPECTED, REPLACED, ROBOT, live

HOUR = 3600.0
RATE = 0.05


def events(lives, what, part=ROBOT):
    """Robots and times [s] of one kind of event of one part, by robot and time."""
    robots = np.concatenate([r[p == part] for r, p, _, _, w in lives.events if w == what])
    times = np.concatenate([t[p == part] for _, p, _, t, w in lives.events if w == what])
    order = np.lexsort((times, robots))
    return robots[order], times[order]


def first(lives, robots):
    """The first system failure of each robot [s]: in the record, or the one after it."""
    which, times = events(lives, FAILED)
    result = np.full(robots, np.nan)
    result[which[::-1]] = times[::-1]
    assert np.isfinite(result).all()
    return result


def fits(values, distribution):
    return stats.kstest(values, distribution.cdf).pvalue > 0.001


def weibull(shape, rate):
    return stats.weibull_min(shape, scale=1 / rate / math.gamma(1 + 1 / shape))


def worked(times, legs, every):
    """Hours of operation by a time, legs being done at the beginning of every round."""
    rounds, rest = np.divmod(times, every)
    return (rounds * legs + np.minimum(rest, legs)) / HOUR


# Each law twice: within the record (tasks that are done), and after it (by the plan alone).
IN_AND_AFTER = pytest.mark.parametrize("tasks", [1, 300], ids=["after the record", "within the record"])


@IN_AND_AFTER
def test_an_exponential_part(design, same_plan, tasks):
    robot = design(f"components: {{part: {{rate: {RATE} /h}}}}")
    plans = same_plan(robot, 3000, 2 * HOUR, [[(HOUR, 0.0, None)]])
    lives = live(robot, plans, tasks, np.random.default_rng(1))
    assert fits(worked(first(lives, 3000), HOUR, 2 * HOUR), stats.expon(scale=1 / RATE))


Q10 = """
signals: {temperature: {topic: /t, field: t, unit: degC, range: [0, 90]}}
components:
  part:
    rate: 0.05 /h
    life: {distribution: weibull, shape: 2.5}
    scaling: SCALING
    acceleration: {model: q10, q: 2, reference_temperature: 25 degC}
    offsets: {temperature: 10 K}
"""
LEGS = [(HOUR, 0.0, None, 15.0), (HOUR / 2, 0.0, None, 35.0)]  # with the offset: ψ = 1, then 4


@IN_AND_AFTER
def test_weibull_at_alternating_temperatures(design, same_plan, tasks):
    robot = design(Q10.replace("SCALING", "age"))
    plans = same_plan(robot, 3000, 4 * HOUR, [LEGS])
    times = first(live(robot, plans, tasks, np.random.default_rng(2), jitter=0.0), 3000)
    rounds, rest = np.divmod(times, 4 * HOUR)
    effective = rounds * 3 + (np.minimum(rest, HOUR) + 4 * np.clip(rest - HOUR, 0, HOUR / 2)) / HOUR
    assert fits(effective, weibull(2.5, RATE))


@pytest.mark.full
@IN_AND_AFTER
def test_hazard_that_is_scaled(design, same_plan, tasks):
    """H(t) = ∫ψ·h₀(a)da is Exp(1) at the failure; by the definition, round by round."""
    robot = design(Q10.replace("SCALING", "hazard"))
    plans = same_plan(robot, 3000, 4 * HOUR, [LEGS])
    times = first(live(robot, plans, tasks, np.random.default_rng(3), jitter=0.0), 3000)
    eta = 1 / RATE / math.gamma(1.4)
    hazards = np.zeros(3000)
    for i in range(200):
        for begin, end, factor in ((0.0, 1.0, 1), (1.0, 1.5, 4)):
            age, at = i * 1.5 + begin, i * 4.0 + begin
            lived = np.clip(times / HOUR - at, 0, end - begin)
            hazards += factor * (((age + lived) / eta) ** 2.5 - (age / eta) ** 2.5)
    assert times.max() < 200 * 4 * HOUR
    assert fits(hazards, stats.expon())


@pytest.mark.full
@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_after_the_record_it_goes_on_as_within(design, same_plan, scaling):
    """The same lives, lived task by task and computed at once, over a thousand rounds and more."""
    robot = design(Q10.replace("SCALING", scaling).replace("0.05 /h", "5e-4 /h"))
    plans = same_plan(robot, 40, 4 * HOUR, [[(HOUR, 0.0, None, 15.0), (HOUR / 2, 0.0, None, 45.0)]])
    lived, computed = (first(live(robot, plans, n, np.random.default_rng(9), jitter=0.0), 40) for n in (2500, 1))
    assert (lived < 2500 * 4 * HOUR).all()
    assert (lived > 300 * 4 * HOUR).sum() > 20  # beyond what is followed piece by piece
    assert computed == pytest.approx(lived, rel=1e-5 if scaling == "hazard" else 1e-12)


def test_what_the_sensors_say_is_what_is_lived(design, same_plan):
    """With ten times the jitter, ±10 K: the age at failure, from the readings alone, has the law of the design."""
    robot = design(Q10.replace("SCALING", "age"))
    plans = same_plan(robot, 2000, 4 * HOUR, [LEGS])
    lives = live(robot, plans, 100, np.random.default_rng(2), jitter=10.0)
    failures = first(lives, 2000)
    ages = np.zeros(2000)
    for piece in lives.pieces:
        lived = np.clip(failures - piece.begin, 0, piece.end - piece.begin)
        ages += 2 ** ((piece.stress[:, 0] + 10 - 25) / 10) * lived / HOUR
    assert (failures < lives.end).all()
    assert fits(ages, weibull(2.5, RATE))
    said = np.concatenate([piece.stress[:, 0] for piece in lives.pieces[0::3]])  # of the first leg, planned at 15
    assert stats.kstest(said, "uniform", (5, 20)).pvalue > 0.001


@IN_AND_AFTER
def test_a_pair_lives_half_as_long_again(design, same_plan, tasks):
    robot = design("components: {a: {rate: 0.05 /h}, b: {rate: 0.05 /h}}\ndiagram: {parallel: [a, b]}")
    plans = same_plan(robot, 4000, 2 * HOUR, [[(HOUR, 0.0, None)]])
    hours = worked(first(live(robot, plans, tasks, np.random.default_rng(4)), 4000), HOUR, 2 * HOUR)
    assert abs(hours.mean() - 1.5 / RATE) < 3.5 * hours.std() / 4000**0.5


def test_two_of_three(design, same_plan):
    robot = design("components: {a: {rate: 0.05 /h, quantity: 3, required: 2}}")
    plans = same_plan(robot, 4000, 2 * HOUR, [[(HOUR, 0.0, None)]])
    hours = worked(first(live(robot, plans, 1, np.random.default_rng(5)), 4000), HOUR, 2 * HOUR)
    assert abs(hours.mean() - (1 / 3 + 1 / 2) / RATE) < 3.5 * hours.std() / 4000**0.5


def test_share_of_failed_tasks(design, same_plan):
    robot = design(f"components: {{part: {{rate: {RATE} /h}}}}")
    plans = same_plan(robot, 2000, 5 * HOUR, [[(HOUR, 0.0, None), (2 * HOUR, 0.0, None)]])
    lives = live(robot, plans, 10, np.random.default_rng(6))
    failed = int(np.sum(lives.failed))
    assert stats.binomtest(failed, 20_000, -math.expm1(-RATE * 3)).pvalue > 0.001
    assert lives.refused == 0  # what a task needs is seen to have failed, at once
    lengths = np.array(lives.ends) - np.array(lives.starts)
    assert (lengths[~np.array(lives.failed)] == 3 * HOUR).all()
    assert (lengths[np.array(lives.failed)] < 3 * HOUR).all()


@pytest.mark.full
def test_duty(design, same_plan):
    """A part that no leg needs ages by its duty."""
    robot = design("components: {a: {rate: 1e-9 /h}, b: {rate: 0.05 /h, duty: 0.25}}\ndiagram: b\nfunctions: {f: a}")
    plans = same_plan(robot, 3000, 2 * HOUR, [[(HOUR, 0.0, ["f"])]])
    for tasks in (1, 300):
        times = first(live(robot, plans, tasks, np.random.default_rng(7)), 3000)
        assert fits(worked(times, HOUR, 2 * HOUR) * 0.25, stats.expon(scale=1 / RATE))


def test_duty_does_not_stop_the_calendar(design, same_plan):
    robot = design(
        "duty: 0\ncomponents: {a: {rate: 1e-9 /h}, b: {rate: 0.05 /h, clock: calendar}}\ndiagram: b\nfunctions: {f: a}"
    )
    plans = same_plan(robot, 3000, 2 * HOUR, [[(HOUR, 0.0, ["f"])]])
    assert fits(first(live(robot, plans, 1, np.random.default_rng(7)), 3000) / HOUR, stats.expon(scale=1 / RATE))


@pytest.mark.parametrize(
    ("clock", "rate", "per_round"),
    [("kilometres", "0.05 /km", 3.6 * 0.5), ("cycles", "0.05 /cycle", 60.0), ("calendar", "0.05 /h", 2.0)],
)
def test_clocks(design, same_plan, clock, rate, per_round):
    """One leg of an hour at 0.5 m/s, half an hour that stands, half an hour off; 40 cycles an hour."""
    robot = design(
        "clocks: {kilometres: {topic: /w, speed: v, unit: km/h}}\n"
        f"components: {{part: {{rate: {rate}, clock: {clock}, life: {{distribution: gamma, shape: 4}}}}}}"
    )
    plans = same_plan(robot, 3000, 2 * HOUR, [[(HOUR, 0.5, None), (HOUR / 2, 0.0, None)]])
    gained = {"kilometres": [1.8, 0.0, 0.0], "cycles": [40.0, 20.0, 0.0], "calendar": [1.0, 0.5, 0.5]}[clock]
    ages = np.append(0.0, np.cumsum(gained))
    for tasks in (1, 60):
        rounds, rest = np.divmod(first(live(robot, plans, tasks, np.random.default_rng(8)), 3000), 2 * HOUR)
        age = rounds * per_round + np.interp(rest, np.array([0.0, 1.0, 1.5, 2.0]) * HOUR, ages)
        assert fits(age, stats.gamma(4, scale=1 / RATE / 4))


@pytest.mark.parametrize(
    ("clock", "unit", "hours"),
    # 20 km are 11 rounds of 1.8 km and 1/9 h; 20 cycles half an hour's; 20 starts 13 rounds of 1.5 and half an hour's.
    [("operating", "h", 26.5), ("calendar", "h", 20), ("kilometres", "km", 22 + 1 / 9), ("cycles", "cycle", 0.5),
     ("starts", "start", 26.5)],
)  # fmt: skip
def test_the_hour_of_a_part_that_lives_exactly_so_long(design, same_plan, clock, unit, hours):
    life = f"{{distribution: normal, deviation: 1e-9 {unit}}}"
    robot = design(
        "clocks: {kilometres: {topic: /w, speed: v}}\n"
        f"components: {{part: {{rate: 0.05 /{unit}, clock: {clock}, life: {life}}}}}"
    )
    plans = same_plan(robot, 2, 2 * HOUR, [[(HOUR, 0.5, None), (HOUR / 2, 0.0, None)]])
    for tasks in (1, 20):
        assert first(live(robot, plans, tasks, np.random.default_rng(8)), 2) / HOUR == pytest.approx(hours, rel=1e-8)


def test_a_new_part_has_spent_no_hazard(design, same_plan):
    """Second lives at ψ = 4 throughout, hazard scaled: 4·H₀ is Exp(1)."""
    robot = design(Q10.replace("SCALING", "hazard"))
    plans = same_plan(robot, 2000, HOUR, [[(HOUR, 0.0, None, 35.0)]])
    which, times = events(live(robot, plans, 200, np.random.default_rng(16), jitter=0.0), FAILED)
    first_one = np.append(True, which[1:] != which[:-1])
    second = np.flatnonzero(np.append(False, first_one[:-1]) & ~first_one)
    hours = times[second] / HOUR - np.ceil(times[second - 1] / HOUR)
    assert len(second) == 2000
    assert fits(4 * (hours * RATE * math.gamma(1.4)) ** 2.5, stats.expon())


def test_a_used_part(design, same_plan):
    """Of a Weibull part that has 20 h behind it: S(20 + t) / S(20). The new one that replaces it has none."""
    life = "life: {distribution: weibull, shape: 2.5}"
    robot = design(f"components: {{part: {{rate: {RATE} /h, {life}, initial_exposure: 20 h}}}}")
    plans = same_plan(robot, 3000, HOUR, [[(HOUR, 0.0, None)]])
    lives = live(robot, plans, 400, np.random.default_rng(9))
    law = weibull(2.5, RATE)
    which, times = events(lives, FAILED)
    first_one = np.append(True, which[1:] != which[:-1])
    chances = 1 - law.sf(20 + times[first_one] / HOUR) / law.sf(20)
    assert stats.kstest(chances, "uniform").pvalue > 0.001
    second = np.append(False, first_one[:-1]) & ~first_one
    # It is off until its next task, an hour's beginning.
    begun = np.ceil(times[np.flatnonzero(second) - 1] / HOUR)
    assert fits(times[second] / HOUR - begun, law)


def test_repair_makes_failed_parts_new_and_looks_at_the_others(design, same_plan):
    robot = design(
        "components:\n  a: {rate: 0.05 /h, life: {distribution: weibull, shape: 5}}\n  b: &b {rate: 0.08 /h}\n  c: *b\n"
        "diagram: {series: [a, {parallel: [b, c]}]}"
    )
    plans = same_plan(robot, 500, HOUR, [[(HOUR, 0.0, None)]])
    lives = live(robot, plans, 100, np.random.default_rng(10))
    robots, repaired = (np.concatenate([r for r, *_, w in lives.events if w in (REPLACED, INSPECTED)]),
                        np.concatenate([t for *_, t, w in lives.events if w in (REPLACED, INSPECTED)]))  # fmt: skip
    repairs = {(r, t) for r, t in zip(robots.tolist(), repaired.tolist(), strict=True)}
    assert len(robots) == 3 * len(repairs)  # every part has its word at every repair
    within = lives.end[0]
    down = set(zip(*(column.tolist() for column in events(lives, FAILED)), strict=True))
    assert repairs == {(r, t) for r, t in down if t <= within}  # everything else failed silently, and nobody knew
    for part in range(3):
        failed = set(zip(*(column.tolist() for column in events(lives, FAILED, part)), strict=True))
        replaced = events(lives, REPLACED, part)[0]
        still_down = sum((r, t) not in repairs for r, t in failed) if part else 0
        assert len(replaced) <= len(failed) <= len(replaced) + still_down
    which, times = events(lives, FAILED, 0)
    same = which[1:] == which[:-1]
    lived = (times[1:] / HOUR - np.ceil(times[:-1] / HOUR))[same]
    # Only lives that began early enough to be seen to their end, whatever it is.
    early = (times[:-1][same] / HOUR) < 30
    assert early.sum() > 400
    assert fits(lived[early], weibull(5, RATE))


def test_what_fails_while_it_is_off_is_repaired_before_the_task(design, same_plan):
    robot = design("components: {seal: {rate: 0.02 /h, clock: calendar}}")
    plans = same_plan(robot, 2000, 50 * HOUR, [[(HOUR, 0.0, None)]])
    lives = live(robot, plans, 4, np.random.default_rng(11))
    assert stats.binomtest(int(np.sum(lives.failed)), 8000, -math.expm1(-0.02)).pvalue > 0.001
    _, times = events(lives, REPLACED, 0)
    at_start = np.isin(times, [0, 50 * HOUR, 100 * HOUR, 150 * HOUR])
    assert at_start.sum() == lives.refused > 1000
    # At the end of the record the robot is tried, and repaired: it works then.
    assert (times == 200 * HOUR).sum() > 500
    assert (lives.end == 200 * HOUR).all()
    _, failures = events(lives, FAILED)
    after = failures[failures > 200 * HOUR]
    assert len(after) == 2000
    assert fits(after / HOUR - 200, stats.expon(scale=50))
    assert sum(len(r) for r, *_, w in lives.events if w == END) == 2000


def test_a_task_fails_when_a_later_leg_needs_what_has_failed(design, same_plan):
    """b fails in a leg that does not need it: the leg goes on, the next one cannot begin."""
    robot = design("components: {a: {rate: 1e-9 /h}, b: {rate: 0.5 /h}}\nfunctions: {first: a, second: b}")
    plans = same_plan(
        robot, 2000, 5 * HOUR, [[(HOUR, 0.0, ["first"]), (HOUR, 0.0, ["second"])], [(HOUR, 0.0, ["first"])]]
    )
    lives = live(robot, plans, 2, np.random.default_rng(12))
    failed, ends = lives.failed[0], lives.ends[0]
    assert stats.binomtest(int(failed.sum()), 2000, -math.expm1(-0.5 * 2)).pvalue > 0.001
    assert stats.binomtest(int((ends == HOUR).sum()), 2000, -math.expm1(-0.5)).pvalue > 0.001
    assert (ends[failed] >= HOUR).all()
    assert not lives.failed[1].any()  # the second task does not need b


UNCERTAIN = {
    "{failures: 2}": stats.lomax(2, scale=2 / RATE).cdf,  # gamma of the rate: Lomax lives
    "{samples: [0.02 /h, 0.08 /h]}": lambda t: 1 - (np.exp(-0.02 * t) + np.exp(-0.08 * t)) / 2,
    "{error_factor: 3}": lambda t: _lognormal_mixture(t),
}


def _lognormal_mixture(hours):
    """P(T ≤ t), the mean of 1 − exp(−rate·t) over rates of mean RATE and error factor 3."""
    sigma = math.log(3) / stats.norm.ppf(0.95)
    z = np.linspace(-8, 8, 801)
    rates = RATE * np.exp(sigma * z - sigma**2 / 2)
    return integrate.trapezoid(stats.norm.pdf(z) * -np.expm1(-np.multiply.outer(hours, rates)), z)


@pytest.mark.parametrize("uncertainty", UNCERTAIN)
def test_rates_that_each_robot_draws(design, same_plan, uncertainty):
    robot = design(f"uncertainty: {uncertainty}\ncomponents: {{part: {{rate: {RATE} /h}}}}")
    plans = same_plan(robot, 800, HOUR, [[(HOUR, 0.0, None)]])
    times = first(live(robot, plans, 1, np.random.default_rng(13), uncertain_rates=True), 800)
    assert stats.kstest(times / HOUR, UNCERTAIN[uncertainty]).pvalue > 0.001
    known = first(live(robot, plans, 1, np.random.default_rng(13)), 800)
    assert fits(known / HOUR, stats.expon(scale=1 / RATE))


def test_equal_parts_share_a_draw_of_the_rate(design, same_plan):
    """Ten in parallel, each robot's rate one of two far apart: no robot lives in between."""
    robot = design("components: {p: {rate: 1 /h, quantity: 10, required: 1, uncertainty: {samples: [1e-3 /h, 1 /h]}}}")
    plans = same_plan(robot, 400, HOUR, [[(HOUR, 0.0, None)]])
    hours = first(live(robot, plans, 1, np.random.default_rng(14), uncertain_rates=True), 400) / HOUR
    assert ((hours < 30) | (hours > 200)).all()
    assert 150 < (hours < 30).sum() < 250


@pytest.mark.parametrize(("own", "between"), [("", False), (", rate: 0.5 /h", True)])
def test_parts_of_one_entry_share_a_draw_and_figures_of_their_own_do_not(design, same_plan, own, between):
    """Of ten side by side, each of two rates far apart: a robot lives in between only where each has its own draw."""
    said = f"{{part: imu{own}, uncertainty: {{samples: [1e-3 /h, 1 /h]}}}}"
    parts = ", ".join(f"p{i}: {said}" for i in range(10))
    diagram = ", ".join(f"p{i}" for i in range(10))
    robot = design(f"components: {{{parts}}}\ndiagram: {{parallel: [{diagram}]}}")
    plans = same_plan(robot, 400, HOUR, [[(HOUR, 0.0, None)]])
    hours = first(live(robot, plans, 1, np.random.default_rng(14), uncertain_rates=True), 400) / HOUR
    assert ((hours > 30) & (hours < 200)).any() == between


def test_failure_modes_are_in_series(design, same_plan):
    robot = design("components: {p: {failure_modes: {x: {rate: 0.03 /h}, y: {rate: 0.02 /h}}}}")
    plans = same_plan(robot, 3000, HOUR, [[(HOUR, 0.0, None)]])
    assert fits(first(live(robot, plans, 1, np.random.default_rng(15)), 3000) / HOUR, stats.expon(scale=1 / RATE))


@pytest.mark.parametrize(
    ("acceleration", "signal", "reading", "factor"),
    [
        (
            "{model: arrhenius, activation_energy: 0.7 eV, reference_temperature: 40 degC}",
            "temperature",
            60.0,
            4.745831,
        ),
        ("{model: cubic_load, reference_load: 0.5}", "load", 0.8, 4.096),
        ("{model: inverse_power, exponent: 7, reference_voltage: 20 V}", "voltage", 24.0, 3.5831808),
    ],
)
def test_accelerations(design, acceleration, signal, reading, factor):
    """Hand-worked: exp(0.7/8.617333e-5·(1/313.15 − 1/333.15)) = exp(1.557266), 1.6³, 1.2⁷."""
    robot = design(
        f"signals: {{{signal}: {{topic: /t, field: t, range: [0, 90]}}}}\nacceleration: {acceleration}\n"
        "components: {p: {rate: 1 /h}}"
    )
    (stress,) = robot.modes[0].stresses
    assert stress.factor(np.array([reading]))[0] == pytest.approx(factor, rel=1e-5)


def test_each_failure_tells_its_mode(design, same_plan):
    """Modes of a part compete: each fails it in the share of its rate, exposed as long as its clock runs."""
    robot = design(
        "components:\n  other: {rate: 1e-3 /h}\n  part:\n    failure_modes:\n      chip: {rate: 0.06 /h}\n"
        "      corrosion: {rate: 0.01 /h, clock: calendar}"
    )
    assert [mode.name for mode in robot.modes] == ["", "chip", "corrosion"]
    plans = same_plan(robot, 400, 2 * HOUR, [[(HOUR, 0.0, None)]])
    lives = live(robot, plans, 60, np.random.default_rng(12))
    every = sorted((t, w, r, p, m) for *columns, w in lives.events for r, p, m, t in zip(*columns, strict=True))
    times, modes = (np.array(one) for one in zip(*((t, m) for t, w, _, p, m in every if (w, p) == (FAILED, 1)),
                                                 strict=True))  # fmt: skip
    on = times % (2 * HOUR) < HOUR
    assert set(modes[~on]) == {2}  # a chip cannot fail while the robot is off
    assert stats.binomtest(int((modes[on] == 1).sum()), int(on.sum()), 0.06 / 0.07).pvalue > 0.001
    assert min((~on).sum(), (modes[on] == 2).sum()) > 100
    failed_by = {}
    for _, what, number, part, mode in every:
        if what == FAILED and part != ROBOT:
            failed_by[number, part] = mode
        else:
            assert mode == (failed_by.pop((number, part)) if what == REPLACED else -1)
