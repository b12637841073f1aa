"""Exposure against a slow integrator written straight from the theory: every instant at which anything may change."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise, product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf
from tests.cases import examples

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.monitoring.monitor import WINDOW

from .exposures import OFFSET, RANGES, SCHEDULES, START, settled, shop

Figures = dict[str, tuple[mpf, mpf, mpf]]


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


@settings(max_examples=examples(150))
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
