"""Wear under conditions that speed it up: laws that are simulated, Device-B of the book, and what cannot be."""

import csv

import numpy as np
import pytest
from scipy import optimize

from robophm.core.errors import DataError
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.conditions import acceleration, forecast_under, life_under

K = 8.617333e-5  # eV/K


def factor(energy, celsius, reference):
    return np.exp(energy / K * (1 / (reference + 273.15) - 1 / (celsius + 273.15)))


def units_tested(rng, count, celsius, energy=0.55, life=50_000.0):
    """Units that wear straight to 1 in a life at 40 °C, each at a pace of its own; twenty readings of a test."""
    found = []
    for _ in range(count):
        own = life * np.exp(0.1 * rng.standard_normal()) / factor(energy, celsius, 40)
        t = np.linspace(0, 0.8 * life / factor(energy, celsius, 40), 20)
        wear = t / own + 0.005 * rng.standard_normal(20)
        found.append(Unit(t, wear, conditions={"temperature": np.full(20, celsius)}))
    return found


def test_an_activation_energy_and_a_life_of_use_by_tests_that_are_hotter():
    rng = np.random.default_rng(4)
    units = [one for celsius in (80.0, 100.0, 125.0) for one in units_tested(rng, 8, celsius)]
    found = acceleration(units, {"temperature": 40.0}, 1.0)
    assert found.mean[0] == pytest.approx(0.55, abs=3 * found.covariance[0, 0] ** 0.5)
    assert found.covariance[0, 0] ** 0.5 < 0.1
    low, median, high = np.quantile(life_under({"temperature": 40.0}, units, 1.0), [0.05, 0.5, 0.95])
    assert low < 50_000 < high
    assert median == pytest.approx(50_000, rel=0.35)


def test_device_b_at_the_temperature_of_use(shared):
    """Meeker and Escobar 1998: from 150, 195 and 237 °C to 80 °C, where no device was tested.

    Their path D·(1 − exp(−R·t)), ln R straight in 1/kT, is fitted to all devices by least squares in this test.
    """
    rows = {}
    with (shared / "degradation/device_b_power_drop.csv").open() as table:
        for row in csv.DictReader(table):
            rows.setdefault(row["device"], []).append([float(row[name]) for name in ("hours", "powerdrop", "celsius")])
    devices = [np.array(known).T for known in rows.values()]
    inverse = np.array([1 / (K * (celsius[0] + 273.15)) for *_, celsius in devices])

    def off(at):
        logs = at[1] - at[2] * (inverse - inverse.mean()) + at[3:]
        fitted = [-np.exp(at[0]) * -np.expm1(-np.exp(r) * t) for (t, *_), r in zip(devices, logs, strict=True)]
        return np.concatenate([y - f for (_, y, _), f in zip(devices, fitted, strict=True)] + [0.05 * at[3:]])

    start = np.concatenate([[0.3, -8, 0.7], np.zeros(len(devices))])
    path, log_rate, energy = optimize.least_squares(off, start).x[:3]
    rate = np.exp(log_rate - energy * (1 / (K * 353.15) - inverse.mean()))
    expected = -np.log(1 - 0.5 / np.exp(path)) / rate
    units = [Unit(t, y, conditions={"temperature": celsius}) for t, y, celsius in devices]
    found = acceleration(units, {"temperature": 80.0}, -0.5, falls=True)
    assert found.mean[0] == pytest.approx(energy, abs=2 * found.covariance[0, 0] ** 0.5)
    low, median, high = np.quantile(life_under({"temperature": 80.0}, units, -0.5, falls=True), [0.05, 0.5, 0.95])
    assert median == pytest.approx(expected, rel=0.2)
    assert low < expected < high


def test_time_to_come_counts_by_what_is_to_come():
    """Steady conditions so far: at 20 K more what remains is less by the factor, and wider by what is unknown of it."""
    t = np.arange(40.0)
    wear = 0.01 * t + 0.002 * np.random.default_rng(1).standard_normal(40)
    unit = Unit(t, wear, conditions={"temperature": np.full(40, 40.0)})
    same, hotter = (forecast_under({"temperature": celsius}, unit, 1.0) for celsius in (40.0, 60.0))
    assert same.remaining.median == pytest.approx(forecast(t, wear, 1.0).remaining.median, rel=0.02)
    assert same.remaining.median / hotter.remaining.median == pytest.approx(factor(0.7, 60, 40), rel=0.05)
    assert hotter.remaining.high / hotter.remaining.low > 1.5 * same.remaining.high / same.remaining.low


def test_a_threshold_that_was_reached_keeps_its_time_on_the_units_own_clock():
    t = np.arange(40.0)
    wear = 0.05 * t + 0.002 * np.random.default_rng(1).standard_normal(40)
    unit = Unit(t, wear, conditions={"temperature": np.linspace(40, 80, 40)})
    assert forecast_under({"temperature": 20.0}, unit, 1.0).reached == pytest.approx(20, abs=0.3)


def test_what_cannot_be():
    t, flat = np.arange(10.0), {"temperature": np.full(10, 40.0)}
    unit = Unit(t, 0.01 * t**1.1, conditions=flat)
    for to_come, others, said in (
        ({"heat": 3.0}, (), "'heat' is no condition that is known"),
        ({"temperature": -300.0}, (), "temperature is -300 somewhere; expected more than -273.15"),
        ({"temperature": 40.0}, (Unit(t, t / 9),), "unit 2 of 2 has the conditions none; expected temperature"),
        ({"temperature": 40.0, "stress": 1.0}, (), "readings have no column stress, so what it would change cannot"),
    ):
        with pytest.raises(DataError, match=said):
            forecast_under(to_come, unit, 1.0, others)
    with pytest.raises(DataError, match="readings have no column temperature"):
        forecast_under({"temperature": 40.0}, Unit(t, 0.01 * t), 1.0)
    with pytest.raises(DataError, match="no unit reached the threshold"):
        life_under({"temperature": 40.0}, [Unit(t, np.zeros(10), conditions=flat)], 1.0)
