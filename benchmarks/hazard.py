"""Stress models over a million temperatures, against one bare pass of np.exp over as many numbers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks import Line, agree, benchmark, race
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

    q10 = acceleration_model("q10")
    rule = q10.settle({"temperature": "25 degC"}) | {"temperature": temperature}
    agree("q10", q10.evaluate(rule).value, 2 ** ((temperature - 25) / 10), 1e-12)

    for name, model, inputs, goal in (
        ("capacitor", capacitor, observed, 8),
        ("microcircuit", processor, running, 12),
        ("q10", q10, rule, None),
    ):
        times = race(lambda model=model, inputs=inputs: model.evaluate(inputs), lambda: np.exp(exponent))
        yield Line(f"{name}, a million temperatures", *times, "np.exp", goal)
