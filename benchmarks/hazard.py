"""Stress models over a million temperatures beside one bare pass of np.exp; parts one by one beside RAMSTK."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks import Line, agree, benchmark, race, ramstk
from robophm.design.importers.bom.models import Rating, rates
from robophm.hazard.acceleration import acceleration_model
from robophm.hazard.handbooks import handbook_model

N = 1_000_000


@benchmark
def temperatures() -> Iterator[Line]:
    temperature = np.random.default_rng(5).uniform(-40.0, 120.0, N)
    exponent = temperature / 100

    capacitor = handbook_model("mil_hdbk_217f.capacitor")
    design = capacitor.settle(
        {"style": "CDR", "capacitance": "1 uF", "temperature": "25 degC", "dc_voltage": "10 V",
         "rated_voltage": "50 V", "quality": "M", "environment": "GM"}
    )  # fmt: skip
    # §10.1 by hand: λb 0.0020, Ea 0.35 eV, C^0.09, (S/0.6)³ + 1, πQ 1, πE 20, per 10⁶ h
    printed = np.exp(-0.35 / 8.617e-5 * (1 / (temperature + 273) - 1 / 298)) * 0.002 * ((0.2 / 0.6) ** 3 + 1) * 20e-6
    observed = design | {"temperature": temperature}
    agree("capacitor", capacitor.evaluate(observed).value, printed, 1e-12)

    processor = handbook_model("mil_hdbk_217f.microcircuit.processor")
    chip = processor.settle(
        {"family": "CMOS", "bits": "32 bit", "package": "SMT-plastic", "pins": 100, "power": "0.5 W",
         "case_temperature": "25 degC", "years_in_production": "3 year", "environment": "GM"}
    )  # fmt: skip
    # §5.1 by hand: C1 0.56, Ea 0.35 eV, junction 20 K/W · 0.5 W warmer, C2 3.6e-4 · Np^1.08, πE 4, πQ 10, πL 1
    junction = 0.1 * np.exp(-0.35 / 8.617e-5 * (1 / (temperature + 10 + 273) - 1 / 298))
    by_hand = (0.56 * junction + 3.6e-4 * 100**1.08 * 4) * 10e-6
    running = chip | {"case_temperature": temperature}
    agree("microcircuit", processor.evaluate(running).value, by_hand, 1e-12)

    motor = handbook_model("mil_hdbk_217f.motor")
    servo = motor.settle({"kind": "servo", "temperature": "40 degC", "design_life": "10000 h"})
    warm = servo | {"temperature": np.clip(temperature, 0.0, None)}
    # §12.1 by hand: A 2.4, B 1.7, and λ1, λ2 by the first of ten limits that LC/α is not above
    kelvin = warm["temperature"] + 273
    lives = (1 / (10 ** (2.534 - 2357 / kelvin) + 1 / (10 ** (20 - 4500 / kelvin) + 300)), 10 ** (2357 / kelvin - 1.83))
    failures = np.array([0.13, 0.15, 0.23, 0.31, 0.41, 0.51, 0.61, 0.68, 0.76, 1.0])
    wear = (
        failures[np.minimum(np.ceil(10_000 / life * 10 - 1e-9) - 1, 9).clip(0).astype(int)] / life for life in lives
    )
    worn = sum(rate / divisor for rate, divisor in zip(wear, (2.4, 1.7), strict=True))
    agree("motor", motor.evaluate(warm).value, worn, 1e-12)

    q10 = acceleration_model("q10")
    rule = q10.settle({"temperature": "25 degC"}) | {"temperature": temperature}
    agree("q10", q10.evaluate(rule).value, 2 ** ((temperature - 25) / 10), 1e-12)

    for name, model, inputs, goal in (
        ("capacitor", capacitor, observed, 8),
        ("microcircuit", processor, running, 12),
        ("motor", motor, warm, None),
        ("q10", q10, rule, None),
    ):
        times = race(lambda model=model, inputs=inputs: model.evaluate(inputs), lambda: np.exp(exponent))
        yield Line(f"{name}, a million temperatures", *times, "np.exp", goal)


@benchmark
def discrete_parts() -> Iterator[Line]:
    """Parts of one robot, in one environment; answers are compared in eleven."""
    peer = ramstk.formulas()
    if peer:
        for model, settled, attributes in ramstk.parts(each=200):
            agree(model.name, ramstk.ours(model, settled), peer(**attributes), 1e-12)
    parts = ramstk.parts(each=1_000, environments=("GM",))
    ratings = [Rating(model.name, {}, (), settled) for model, settled, _ in parts]

    def alone() -> list[float]:
        return [ramstk.ours(model, settled) for model, settled, _ in parts]

    def theirs() -> list[float]:
        return [peer(**attributes) for _, _, attributes in parts] if peer else []

    runners = (lambda: rates(ratings), alone, theirs) if peer else (lambda: rates(ratings), alone)
    together, one_by_one, *others = race(*runners, rounds=3)
    for how, seconds in (("as a list", together), ("one by one", one_by_one)):
        name, speed = f"{len(parts):,} parts of 7 kinds, rated {how}", f"{len(parts) / seconds / 1000:.3g} k parts/s"
        yield Line(name, seconds, *others, peer_name="RAMSTK, one by one" if peer else "", per_second=speed)
