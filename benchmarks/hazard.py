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

    q10 = acceleration_model("q10")
    rule = q10.settle({"temperature": "25 degC"}) | {"temperature": temperature}
    agree("q10", q10.evaluate(rule).value, 2 ** ((temperature - 25) / 10), 1e-12)

    for name, model, inputs in (("capacitor", capacitor, observed), ("q10", q10, rule)):
        times = race(lambda model=model, inputs=inputs: model.evaluate(inputs), lambda: np.exp(exponent))
        yield Line(f"{name}, a million temperatures", *times, "np.exp")
