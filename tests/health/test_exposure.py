"""Exposure against closed forms and against a slow integrator written straight from the theory."""

from __future__ import annotations

import gc
import json
import math
import random
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from robophm.core.errors import StoreError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger, Total
from robophm.health.outlooks import outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.sample_stretch import SampleStretch
from robophm.monitoring.monitor import WINDOW, Monitor

START = 1_700_000_000 * SECOND
Figures = dict[str, tuple[mpf, mpf, mpf]]


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def monitor(design: Robot, samples: Sequence[Sample], period: float = 60.0, ledger: Ledger | None = None) -> Monitor:
    observer = Monitor(design, ledger, period=period)
    for sample in samples:
        observer.observe(sample)
    return observer


def settled(design: Robot, samples: Sequence[Sample], period: float = 60.0) -> Ledger:
    return ExposureIntegrator(design).settled(monitor(design, samples, period).ledger)


def lived(design: Robot, samples: Sequence[Sample]) -> Outlook:
    return outlooks(Plant(design), ExposureIntegrator(design), settled(design, samples))["sensor_based"]


def kept(ledger: Ledger) -> Ledger:
    """A ledger that has been through a file."""
    return Ledger.from_json(json.loads(json.dumps(ledger.to_json(), allow_nan=False)), ledger.modes, ledger.odometers)


def exact(value: Any) -> Any:
    return pytest.approx(float(value), rel=1e-12, abs=0)


# Closed forms: three hours, each at a constant stress, on a robot that is always heard.

TEMPERATURE = {"topic": "/t", "field": "c", "unit": "degC", "max_age": "2 h"}
HOURS = [(25.0, 0.5), (45.0, 1.25), (15.0, 2.0)]  # °C, h
Q10 = {"model": "q10"}
ALWAYS_ON = {"signals": {"temperature": TEMPERATURE}, "max_gap": "3 h"}


def three_hours(signal: str = "/t.c", steps: Sequence[tuple[float, float]] = HOURS) -> list[Sample]:
    found, now = [], START
    for value, hours in steps:
        found.append(Sample(now, signal, value))
        now += round(hours * HOUR)
    return [*found, Sample(now, CLOCK, 0.0)]


def test_exponential_gathers_rate_times_time() -> None:
    rates = [(2e-5, 0.5), (7e-4, 1.25), (1e-6, 2.0)]
    measured = {"rate": {"topic": "/m", "field": "rate", "max_age": "2 h"}}
    part = {"hazard": {"model": "general.constant", "inputs": {"rate": "1e-5 /h"}}}
    design = robot({"part": part}, signals=measured, max_gap="3 h")
    expected = sum(Fraction(rate) * Fraction(hours) for rate, hours in rates)
    assert lived(design, three_hours("/m.rate", rates)).cumulative_hazard[0] == exact(expected)


@pytest.mark.parametrize("initial", [0, 70])
@pytest.mark.parametrize("beta", [0.6, 1, 2.5])
@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_weibull_under_both_scalings(scaling: str, beta: float, initial: int) -> None:
    life = {"distribution": "weibull", "scale": "100 h", "shape": beta}
    part = {"life": life, "acceleration": Q10, "scaling": scaling, "initial_exposure": f"{initial} h"}
    design = robot({"part": part}, **ALWAYS_ON)
    age, effective, hazard = mpf(initial), mpf(initial), (mpf(initial) / 100) ** beta
    for celsius, hours in HOURS:
        factor = mpf(2) ** ((mpf(celsius) - 25) / 10)
        hazard += factor * (((age + hours) / 100) ** beta - (age / 100) ** beta)
        age, effective = age + hours, effective + factor * hours
    expected = hazard if scaling == "hazard" else (effective / 100) ** beta
    assert lived(design, three_hours()).cumulative_hazard[0] == exact(expected)


@pytest.mark.parametrize("required", [1, 2, 3, 4])
def test_quantity_is_separate_parts(required: int) -> None:
    life = {"distribution": "weibull", "scale": "3 h", "shape": 2}
    design = robot({"part": {"life": life, "quantity": 4, "required": required}}, **ALWAYS_ON)
    works = mp.exp(-((mpf(15) / 4 / 3) ** 2))
    expected = [mp.binomial(4, k) * works**k * (1 - works) ** (4 - k) for k in range(5)]
    survival = lived(design, three_hours()).survival(design.diagram)
    assert survival.works == exact(sum(expected[required:]))
    assert survival.failed == exact(sum(expected[:required]))


def test_failure_modes_are_in_series() -> None:
    wear = {"life": {"distribution": "weibull", "scale": "3 h", "shape": 2}, "acceleration": Q10}
    design = robot({"part": {"failure_modes": {"wear": wear, "shock": {"rate": "0.01 /h"}}}}, **ALWAYS_ON)
    effective = sum(mpf(2) ** ((mpf(celsius) - 25) / 10) * hours for celsius, hours in HOURS)
    expected = (effective / 3) ** 2 + mpf("3.75") * mpf(0.01)
    assert lived(design, three_hours()).survival(design.diagram).works == exact(mp.exp(-expected))


def clocked(clock: str, binding: dict[str, Any] | None = None) -> Robot:
    unit = {"operating": "h", "calendar": "h", "kilometres": "km", "cycles": "cycle", "starts": "start"}[clock]
    usage = {"usage": {clock: f"3 {unit}/h"}} if clock not in ("operating", "calendar") else {}
    clocks = {"clocks": {clock: binding}} if binding else {}
    parts = {"part": {"rate": f"0.01 /{unit}", "clock": clock}}
    return robot(parts, powered={"topic": "/power", "field": "on"}, max_gap="10 h", **usage, **clocks)


ON_AND_OFF = [
    Sample(START, "/power.on", 1.0),
    Sample(START + HOUR, "/power.on", 0.0),
    Sample(START + 4 * HOUR, CLOCK, 0.0),
]
DRIVEN = [Sample(START + i * SECOND, "/o.v", v) for i, v in enumerate([0.25, -0.5, 0.75])]
WALKED = [
    sample
    for i, (x, y) in enumerate([(0, 0), (300, 400), (300, 400), (-300, -400)], 1)
    for sample in (Sample(START + i * SECOND, "/o.x", x), Sample(START + i * SECOND, "/o.y", y))
]
PRESSED = [Sample(START + i * SECOND, "/b.on", on) for i, on in enumerate([1, 1, 0, 1, 0, 0, 1, 1, 0], 1)]


@pytest.mark.parametrize(
    ("clock", "binding", "samples", "expected"),
    [
        ("operating", None, [], 1),
        ("calendar", None, [], 4),
        ("kilometres", None, [], 3),  # as the design says, while on
        ("kilometres", {"topic": "/o", "position": ["x", "y"]}, WALKED, Fraction("1.5")),
        ("kilometres", {"topic": "/o", "position": ["x"], "unit": "cm"}, WALKED[::2], Fraction("0.009")),
        ("kilometres", {"topic": "/o", "speed": "v", "max_age": "2 h"}, DRIVEN, Fraction("0.75") * (1 + 3598)),
        ("kilometres", {"topic": "/o", "speed": "v", "max_age": "1 s"}, DRIVEN, 1.5 + 3597 * 3000 / 3600),
        ("cycles", {"topic": "/b", "edge": "on"}, PRESSED, 2),
        ("starts", {"topic": "/b", "edge": "on", "threshold": 1.5}, PRESSED, 0),
    ],
)  # fmt: skip
def test_clocks(clock: str, binding: dict[str, Any] | None, samples: list[Sample], expected: Fraction) -> None:
    design = clocked(clock, binding)
    if binding and "speed" in binding:
        expected /= 1000  # m to km
    ledger = settled(design, sorted([*ON_AND_OFF, *samples]))
    assert ledger.age.value[0] == exact(expected)
    assert ledger.clocks.value[:2].tolist() == [exact(1), exact(4)]


def test_reference_stress_need_not_be_stated() -> None:
    part = {"rate": "1e-5 /h", "acceleration": {"model": "q10"}}
    (stress,) = robot({"part": part}, **ALWAYS_ON).modes[0].stresses
    assert stress.factor({"temperature": np.array([25.0, 35.0])}).value.tolist() == [1.0, 2.0]


def test_the_first_instant_can_be_looked_at() -> None:
    """No time has passed, so that no stress has acted; a handbook model is not asked about nothing."""
    design = shop(dict.fromkeys(SCHEDULES, SECOND), "nominal", SECOND, powered=False)
    assert not settled(design, [Sample(START, "/a.t", 20.0)]).effective.value.any()


def test_a_sample_out_of_range_is_counted_once_and_hides_no_other() -> None:
    design = shop(dict.fromkeys(SCHEDULES, 9 * SECOND), "nominal", SECOND, powered=False)
    samples = [Sample(START, "/a.t", 35.0), Sample(START, "/a.t", 999.0), Sample(START + HOUR // 3600, CLOCK, 0.0)]
    ledger = settled(design, samples)
    assert ledger.counts == {"out of range: /a.t": 1}
    seal = [mode.path for mode in design.modes].index("seal")
    assert ledger.effective.value[seal] == exact(mpf(2) / 3600)


def test_parts_whose_sensors_alone_differ_live_as_if_each_were_alone() -> None:
    """They are asked about together, to the last bit: one is silent, one speaks now and then, one leaves its range."""
    chance = random.Random(5)
    parts = {
        f"p{i}": {
            "rate": "1e-5 /h",
            "acceleration": {"model": "q10", "reference_temperature": f"{25 + 5 * (i == 4)} degC"},
            "signals": {"temperature": TEMPERATURE | {"topic": f"/t{i}", "max_age": "7 s"}},
        }
        for i in range(6)
    }
    always = {"powered": {"topic": "/on", "field": "data"}}
    samples = [Sample(START, "/on.data", 1.0)]
    for i, (count, warmest) in enumerate([(90, 60), (0, 60), (9, 60), (90, 1500), (90, 60), (90, 60)]):
        times = (START + chance.randrange(180 * SECOND) for _ in range(count))
        samples += [Sample(time, f"/t{i}.c", chance.uniform(-5, warmest)) for time in times]
    samples = [*sorted(samples), Sample(START + 180 * SECOND, CLOCK, 0.0)]
    together = settled(robot(parts, **always), samples, 30.0)
    for i, (name, part) in enumerate(parts.items()):
        own = [sample for sample in samples if sample.signal in ("/on.data", CLOCK, f"/t{i}.c")]
        alone = settled(robot({name: part}, **always), own, 30.0)
        assert together.effective.value[i] == alone.effective.value[0] > 0
        assert together.extrapolated[name] == alone.extrapolated[name]


# The same laws by brute force: every instant at which anything may change, one after the other.

OFFSET = 15  # K, of the capacitor above its module
SCHEDULES = ("/a.t", "/b.v", "/o.v", "/o.x", "/o.y", "/s.on", "/power.on")
RANGES = {"/a.t": (-40, 125), "/b.v": (0, 40)}  # what is outside is no sample


def shop(max_age: dict[str, int], stale: str, gap: int, *, powered: bool) -> Robot:
    """A robot with every clock, both scalings, one and two measured inputs."""
    age = {signal: f"{ns / SECOND!r} s" for signal, ns in max_age.items()}
    wear = {"distribution": "weibull", "scale": "0.05 h", "shape": 2.5}
    infancy = {"distribution": "weibull", "scale": "0.02 km", "shape": 0.7}
    inputs = {"style": "CK", "capacitance": "1 uF", "temperature": "40 degC", "dc_voltage": "15 V"}
    capacitor = {
        "hazard": {
            "model": "mil_hdbk_217f.capacitor",
            "inputs": {**inputs, "rated_voltage": "50 V", "environment": "GB"},
        },
        "offsets": {"temperature": f"{OFFSET} K"},
    }
    arrhenius = {"model": "arrhenius", "activation_energy": "0.5 eV"}
    on_speed = {"kilometres": {"topic": "/o", "speed": "v", "max_age": age["/o.v"]}}
    on_path = {"kilometres": {"topic": "/o", "position": ["x", "y"], "max_age": age["/o.x"]}}
    kilometres = {"life": infancy, "clock": "kilometres", "acceleration": Q10}
    signals = {
        name: {"topic": s[:2], "field": s[3], "range": [*RANGES[s]], "max_age": age[s], "stale": stale}
        for name, s in (("temperature", "/a.t"), ("dc_voltage", "/b.v"))
    }
    return robot(
        {
            "plain": {"rate": "0.01 /h"},
            "capacitor": capacitor,
            "worn": {"life": wear, "clock": "calendar", "acceleration": arrhenius, "initial_exposure": "0.01 h"},
            "seal": {"life": wear, "scaling": "hazard", "acceleration": Q10, "initial_exposure": "0.02 h"},
            "tyre": {**kilometres, "clocks": on_speed, "scaling": "hazard"},
            "track": {**kilometres, "clocks": on_path, "scaling": "hazard"},
            "belt": {**kilometres, "clock": "cycles", "life": {"distribution": "rayleigh", "scale": "9 cycle"}},
            "switch": {
                "rate": "1e-4 /start",
                "clock": "starts",
                "acceleration": Q10,
                "clocks": {"starts": {"topic": "/s", "edge": "on"}},
            },
        },
        signals=signals,
        usage={"kilometres": "2 km/h", "starts": "1 start/h", "cycles": "40 cycle/h"},
        max_gap=f"{gap / SECOND!r} s",
        **({"powered": {"topic": "/power", "field": "on"}} if powered else {}),
    )  # fmt: skip


class BruteForce:
    """Mathematics §2 in plain Python: samples in the order received, integrated in exact arithmetic."""

    def __init__(
        self, received: list[Sample], period: int, max_age: dict[str, int], stale: str, gap: int, *, powered: bool
    ) -> None:
        self.max_age, self.policy, self.gap, self.powered = max_age, stale, gap, powered
        self.counts: Counter[str] = Counter()
        self.stale: Counter[str] = Counter()
        taken = self.take(received, period)
        self.heard = sorted({time for time, signal, _ in taken if signal != CLOCK})
        self.values: dict[str, dict[int, float]] = {signal: {} for signal in SCHEDULES}
        for time, signal, value in taken:  # a later one of the same time replaces it
            low, high = RANGES.get(signal, (-mp.inf, mp.inf))
            if low <= value <= high:
                self.values.get(signal, {})[time] = value
            else:
                self.counts[f"out of range: {signal}"] += 1
        self.integrate()

    def take(self, received: list[Sample], period: int) -> list[Sample]:
        """What is not refused: integration trails the newest sample by the window, in whole periods."""
        taken: list[Sample] = []
        done = newest = None
        for sample in received:
            if sample.signal != CLOCK and not mp.isfinite(sample.value):
                self.counts[f"not finite: {sample.signal}"] += sample.time > (done or 0)
                self.counts[f"late: {sample.signal}"] += sample.time <= (done or 0)
            elif done is not None and sample.time <= done:
                self.counts[f"late: {sample.signal}"] += sample.signal != CLOCK
            else:
                taken.append(sample)
                if sample.time > (newest or 0):
                    newest = sample.time
                    tick = (newest - WINDOW) // period * period
                    done = tick if tick > (done or min(time for time, *_ in taken)) else done
        self.start, self.until = min(time for time, *_ in taken), newest or 0
        return sorted(taken)

    def last(self, signal: str, now: int) -> tuple[int, float] | None:
        return max(((time, value) for time, value in self.values[signal].items() if time <= now), default=None)

    def observed(self, signal: str, now: int, nominal: float, worst: float, policy: str) -> mpf:
        last = self.last(signal, now)
        if last and (now < last[0] + self.max_age[signal] or policy == "hold"):
            return mpf(last[1])
        return mpf(worst if policy == "worst" else nominal)

    def fresh(self, signal: str, now: int) -> bool:
        last = self.last(signal, now)
        return last is not None and now < last[0] + self.max_age[signal]

    def on(self, now: int) -> bool:
        power = self.last("/power.on", now) if self.powered else None
        return power[1] > 0.5 if power else any(time <= now < time + self.gap for time in self.heard)

    def factors(self, now: int) -> dict[str, mpf]:
        """Conservative: of all that silent inputs may be, last values or nominal ones, the worst for each part."""
        if self.policy != "conservative":
            return self.assumed(now, self.policy, self.policy)
        if not self.on(now):
            return self.assumed(now, "nominal", "nominal")
        each = [self.assumed(now, *both) for both in product(("hold", "nominal"), repeat=2)]
        return {part: max(one[part] for one in each) for part in each[0]}

    def assumed(self, now: int, heat: str, pressure: str) -> dict[str, mpf]:
        # without a sensor a part is at its own design temperature: the offset is of measured values alone
        celsius = self.observed("/a.t", now, 25, 125, heat)
        voltage = self.observed("/b.v", now, 15, 40, pressure)
        silent = not self.fresh("/a.t", now) and (heat == "nominal" or not self.last("/a.t", now))
        hot = mpf(40) if silent and heat != "worst" else celsius + OFFSET

        def handbook(temperature: mpf, volts: mpf) -> mpf:  # πT of column 2, πV of column 3
            heat = mp.exp(-mpf(0.35) / mpf(8.617e-5) * (1 / (temperature + 273) - mpf(1) / 298))
            return heat * ((volts / 50 / mpf(0.6)) ** 3 + 1)

        q10 = mpf(2) ** ((celsius - 25) / 10)
        kelvin = mpf(273.15)
        arrhenius = mp.exp(mpf(0.5) / mpf(8.617333e-5) * (1 / (25 + kelvin) - 1 / (celsius + kelvin)))
        return {
            "plain": mpf(1),
            "capacitor": handbook(hot, voltage) / handbook(mpf(40), mpf(15)),
            "worn": arrhenius,
            **dict.fromkeys(("seal", "tyre", "track", "belt", "switch"), q10),
        }

    def steps(self, end: int) -> tuple[mpf, int]:
        """What happens at an instant: kilometres of the path, and starts."""
        x, y, on = (self.values[signal] for signal in ("/o.x", "/o.y", "/s.on"))
        here, there = ((self.last("/o.x", at), self.last("/o.y", at)) for at in (end, end - 1))
        way = mpf(0)
        since = max(last[0] for last in there if last) if all(there) else end
        on_throughout = all(self.on(at) for at in self.ordered if since <= at < end)
        if (end in x or end in y) and all(here) and all(there) and on_throughout:
            way = mp.hypot(*(mpf(a[1]) - mpf(b[1]) for a, b in zip(here, there, strict=True) if a and b)) / 1000
        before = self.last("/s.on", end - 1)
        return way, int(end in on and before is not None and on[end] > 0.5 >= before[1])

    def integrate(self) -> None:
        instants = {self.start, self.until, self.start + self.max_age["/o.x"], self.start + 5 * SECOND}
        for signal, values in self.values.items():
            instants |= set(values) | {time + self.max_age[signal] for time in values}
        instants |= set(self.heard) | {time + self.gap for time in self.heard}
        self.ordered = ordered = sorted(time for time in instants if self.start <= time <= self.until)
        initial = {"worn": mpf(0.01), "seal": mpf(0.02)}
        shape = {"seal": (mpf(0.05), mpf(2.5)), "tyre": (mpf(0.02), mpf(0.7)), "track": (mpf(0.02), mpf(0.7))}
        self.figures: Figures = {part: (mpf(0), mpf(0), mpf(0)) for part in self.factors(self.start)}
        self.hours = [mpf(0), mpf(0)]
        for begin, end in pairwise(ordered):
            calendar = mpf(end - begin) / HOUR
            operating = calendar * self.on(begin)
            speed = self.last("/o.v", begin)
            driven = operating * (abs(mpf(speed[1])) * mpf("3.6") if speed and self.fresh("/o.v", begin) else 2)
            way, starts = self.steps(end)
            unpressed = not self.last("/s.on", begin) and begin >= self.start + 5 * SECOND
            unheard = not (self.last("/o.x", begin) and self.last("/o.y", begin))
            unheard &= begin >= self.start + self.max_age["/o.x"]
            advance = {
                "worn": calendar,
                "tyre": driven,
                "track": way + 2 * operating * unheard,
                "belt": 40 * operating,
                "switch": starts + operating * unpressed,
            }
            advance |= dict.fromkeys(("plain", "capacitor", "seal"), operating)
            self.hours = [self.hours[0] + operating, self.hours[1] + calendar]
            for part, factor in self.factors(begin).items():
                age, effective, hazard = self.figures[part]
                if part in shape:
                    scale, beta = shape[part]
                    low = initial.get(part, mpf(0)) + age
                    hazard += factor * (((low + advance[part]) / scale) ** beta - (low / scale) ** beta)
                self.figures[part] = age + advance[part], effective + factor * advance[part], hazard
            if operating:
                for signal in ("/a.t", "/b.v", "/o.v"):
                    self.stale[signal] += (end - begin) * (not self.fresh(signal, begin))


@st.composite
def streams(draw: st.DrawFn) -> list[Sample]:
    """Samples in order of receipt: ties, gaps, disorder within and beyond the window, what is no sample."""
    value = {
        "/a.t": st.floats(-60, 150) | st.sampled_from([20.0, 25.0, float("nan"), float("inf"), 1e9]),
        "/b.v": st.floats(-5, 45) | st.sampled_from([0.0, 15.0, float("-inf")]),
        **dict.fromkeys(("/o.v", "/o.x", "/o.y"), st.floats(-3, 3)),
        **dict.fromkeys(("/s.on", "/power.on"), st.sampled_from([0.0, 1.0])),
        CLOCK: st.just(0.0),
    }
    found, now = [], START
    for _ in range(draw(st.integers(2, 24))):
        now += draw(st.sampled_from([0, 0, 1, SECOND // 10]) | st.integers(0, 20 * SECOND))
        late = draw(st.sampled_from([0, 0, 0, SECOND // 2, SECOND, 9 * SECOND]))
        signal = draw(st.sampled_from(list(value)))
        found.append(Sample(now - late, signal, draw(value[signal])))
    # time itself begins and ends with something finite
    return [Sample(START, CLOCK, 0.0), *found, Sample(now, CLOCK, 0.0)]


@st.composite
def designs(draw: st.DrawFn) -> dict[str, Any]:
    return {
        "max_age": {signal: draw(st.integers(1, 30 * SECOND)) for signal in SCHEDULES},
        "stale": draw(st.sampled_from(["conservative", "nominal", "hold", "worst"])),
        "gap": draw(st.integers(1, 40 * SECOND)),
        "powered": draw(st.booleans()),
    }


@settings(max_examples=300)
@given(streams(), designs(), st.sampled_from([3, 10, 60]))
def test_ledger_is_that_of_the_slow_integrator(received: list[Sample], design: dict[str, Any], period: int) -> None:
    slow = BruteForce(received, period * SECOND, **design)
    ledger = settled(shop(**design), received, period)
    sums = zip(ledger.modes, ledger.age.value, ledger.effective.value, ledger.hazard.value, strict=True)
    for key, *found in sums:
        mode = key.partition(" (")[0]
        assert found == pytest.approx([float(one) for one in slow.figures[mode]], rel=1e-12, abs=1e-18), mode
    assert ledger.clocks.value == pytest.approx([float(one) for one in slow.hours], rel=1e-12, abs=1e-18)
    stale = {key.partition(" ")[0]: nanoseconds for key, nanoseconds in ledger.stale.items()}
    assert Counter(stale) == slow.stale  # to the nanosecond
    assert ledger.counts == slow.counts


# The ledger adds up: however a run is cut, stopped, looked at or put together.

SAMPLES = [
    Sample(START + round(i * 0.37 * SECOND), signal, 30 + 20 * math.sin(i * phase) if signal == "/a.t" else i % 3)
    for i in range(600)
    for phase, signal in enumerate(("/a.t", "/b.v", "/o.v", "/o.x", "/o.y", "/s.on", "/power.on"), 1)
    if i % (phase + 1) == 0
]
SHOP = shop(dict.fromkeys(SCHEDULES, 2 * SECOND), "nominal", 3600 * SECOND, powered=True)
LEDGER = monitor(SHOP, SAMPLES).ledger.to_json()


@given(st.lists(st.integers(0, len(SAMPLES)), max_size=4))
def test_restarts_change_no_bit(cuts: list[int]) -> None:
    ledger = Ledger.new(SHOP)
    for begin, end in pairwise([0, *sorted(cuts), len(SAMPLES)]):
        ledger = monitor(SHOP, SAMPLES[begin:end], ledger=kept(ledger)).ledger
    assert ledger.to_json() == LEDGER


@pytest.mark.parametrize("period", [0.5, 7.0, 3600.0])
def test_the_period_does_not_matter(period: float) -> None:
    one, other = settled(SHOP, SAMPLES), settled(SHOP, SAMPLES, period)
    for name in ("age", "effective", "hazard", "clocks"):
        assert getattr(other, name).value == pytest.approx(getattr(one, name).value, rel=1e-12, abs=0)
    assert (other.last, other.stale, other.counts) == (one.last, one.stale, one.counts)


@given(st.randoms(use_true_random=False))
def test_two_recordings_merge_into_one_run(random: random.Random) -> None:
    """Each in its own order, one up to half a second behind the other."""
    lag = {signal: random.randrange(SECOND // 2) for signal in SCHEDULES}
    merged = sorted(SAMPLES, key=lambda sample: sample.time + lag[sample.signal])
    one, other = settled(SHOP, SAMPLES), settled(SHOP, merged)
    for name in ("age", "effective", "hazard", "clocks"):
        assert getattr(other, name).value == pytest.approx(getattr(one, name).value, rel=1e-12, abs=0)
    assert other.counts == one.counts == {}


def test_looking_changes_nothing() -> None:
    observer = Monitor(SHOP)
    for i, sample in enumerate(SAMPLES):
        observer.observe(sample)
        if i % 100 == 0:
            before = observer.ledger.to_json()
            observer.exposure.settled(observer.ledger)
            observer.report(remaining_life=False)
            assert observer.ledger.to_json() == before
    assert observer.ledger.to_json() == LEDGER


def test_a_million_small_additions_lose_nothing() -> None:
    # a second at a time after a year, and what a plain sum loses entirely
    total, plain = Total(np.array([8760.0, 1.0]), np.zeros(2)), np.array([8760.0, 1.0])
    small = np.array([1 / 3600, 1e-17])
    for _ in range(10**6):
        total.add(small)
        plain += small
    expected = [Fraction(first) + 10**6 * Fraction(each) for first, each in zip((8760, 1), small.tolist(), strict=True)]
    assert total.value == pytest.approx([float(one) for one in expected], rel=2e-16, abs=0)
    assert plain[1] == 1.0  # so that this test can fail


def test_a_ledger_of_other_parts_is_refused() -> None:
    data = Ledger.new(SHOP).to_json()
    with pytest.raises(StoreError, match=r"'plain \(operating, age scaling\)' is in it alone"):
        Ledger.from_json(data, tuple(mode for mode in data["modes"] if not mode.startswith("plain ")), ())
    with pytest.raises(StoreError, match="version 1; expected 2"):
        Ledger.from_json({**data, "version": 1}, tuple(data["modes"]), ())


def test_a_ledger_follows_its_parts_when_the_design_puts_them_in_another_order() -> None:
    turned = tuple(reversed(LEDGER["modes"]))
    moved = Ledger.from_json(LEDGER, turned, ())
    assert moved.effective.value.tolist() == monitor(SHOP, SAMPLES).ledger.effective.value[::-1].tolist()
    assert moved.recent[0].age.tolist() == monitor(SHOP, SAMPLES).ledger.recent[0].age[::-1].tolist()


def test_what_was_heard_in_the_first_instant_counts_from_it() -> None:
    """Integrated to the instant of the first samples, and then on: it is on, and stays so, without another word."""
    design = robot({"part": {"rate": "0.01 /h"}}, powered={"topic": "/power", "field": "on"})
    exposure, ledger = ExposureIntegrator(design), Ledger.new(design)
    ledger.started = START
    exposure.integrate(ledger, [Sample(START, "/power.on", 1.0)], START)
    exposure.integrate(ledger, [], START + 2 * HOUR)
    assert ledger.clocks.value.tolist() == [2.0, 2.0]


def test_nothing_of_a_stretch_stays() -> None:
    """Not even until Python looks for what refers to one another: a year of stretches takes the memory of one."""
    design = shop(dict.fromkeys(SCHEDULES, 5 * SECOND), "nominal", 5 * SECOND, powered=True)
    gc.collect()
    gc.disable()
    try:
        monitor(design, SAMPLES[:500], period=10).report()
        assert [one for one in gc.get_objects() if isinstance(one, SampleStretch)] == []
    finally:
        gc.enable()
