"""What the tests of exposure share: robots that live through samples."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import pytest

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.monitoring.monitor import Monitor

START = 1_700_000_000 * SECOND


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


TEMPERATURE = {"topic": "/t", "field": "c", "unit": "degC", "max_age": "2 h"}
HOURS = [(25.0, 0.5), (45.0, 1.25), (15.0, 2.0)]  # °C, h: three stretches, each at a constant stress
Q10 = {"model": "q10"}
ALWAYS_ON = {"signals": {"temperature": TEMPERATURE}, "max_gap": "3 h"}


def three_hours(signal: str = "/t.c", steps: Sequence[tuple[float, float]] = HOURS) -> list[Sample]:
    found, now = [], START
    for value, hours in steps:
        found.append(Sample(now, signal, value))
        now += round(hours * HOUR)
    return [*found, Sample(now, CLOCK, 0.0)]


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


SAMPLES = [
    Sample(START + round(i * 0.37 * SECOND), signal, 30 + 20 * math.sin(i * phase) if signal == "/a.t" else i % 3)
    for i in range(600)
    for phase, signal in enumerate(("/a.t", "/b.v", "/o.v", "/o.x", "/o.y", "/s.on", "/power.on"), 1)
    if i % (phase + 1) == 0
]
SHOP = shop(dict.fromkeys(SCHEDULES, 2 * SECOND), "nominal", 3600 * SECOND, powered=True)
LEDGER = monitor(SHOP, SAMPLES).ledger.to_json()
