"""What others say of the same readings, for ``benchmarks.prognostics``: SurPyval's path models, progpy's particles."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Interval = tuple[float, float, float]
Asked = Callable[[str, Array, Array], Interval]

PARTICLES = 400
READ = 120
"""Readings that progpy's filter sees; of more, means of neighbours."""


def surpyval(limits: Mapping[str, float], units: Mapping[str, tuple[Array, Array]]) -> Asked:
    """SurPyval's Bayesian prediction by the path that its AICc chooses for the other units."""
    from surpyval.degradation import DegradationAnalysis

    chosen: list[str] = []

    def ask(unit: str, t: Array, y: Array) -> Interval:
        rest = {name: known for name, known in units.items() if name != unit}
        x, z = (np.concatenate([known[k] for known in rest.values()]) for k in (0, 1))
        i = np.repeat(list(rest), [len(known[0]) for known in rest.values()])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fitted = DegradationAnalysis.fit(x, z, i, limits[unit], path=chosen[0] if chosen else "best")
            if not chosen:
                chosen.append(str(fitted.path_model.name))
            found = fitted.predict_rul(t, y, alpha_ci=0.1, random_state=0, n_samples=2000)
        low, high = found.rul_interval
        return float(low), float(found.rul), float(high)

    return ask


def progpy(limits: Mapping[str, float], *, falls: bool) -> Asked | None:
    """progpy's particle filter of a rate that wanders, untuned, its particles run straight on; None: not installed."""
    try:
        from progpy import PrognosticsModel
        from progpy.state_estimators import ParticleFilter
        from progpy.uncertain_data import MultivariateNormalDist
    except ImportError:
        return None

    rng = np.random.default_rng(0)

    class Walk(PrognosticsModel):  # type: ignore[misc]
        inputs: ClassVar[list[str]] = []
        states: ClassVar[list[str]] = ["wear", "rate"]
        outputs: ClassVar[list[str]] = ["wear"]
        events: ClassVar[list[str]] = ["end"]
        is_vectorized = True  # then progpy's own noise is one draw for all particles, so it is drawn here
        own_noise = (0.0, 0.0)

        def initialize(self, u=None, z=None):  # type: ignore[no-untyped-def]
            return self.StateContainer({"wear": 0.0, "rate": 0.0})

        def next_state(self, x, u, dt):  # type: ignore[no-untyped-def]
            a, b = rng.standard_normal((2, np.size(x["wear"])))
            wear = x["wear"] + x["rate"] * dt + self.own_noise[0] * a
            return self.StateContainer({"wear": wear, "rate": x["rate"] + self.own_noise[1] * math.sqrt(dt) * b})

        def output(self, x):  # type: ignore[no-untyped-def]
            return self.OutputContainer({"wear": x["wear"]})

        def event_state(self, x):  # type: ignore[no-untyped-def]
            return {"end": 1 - x["wear"]}

    def ask(unit: str, t: Array, y: Array) -> Interval:
        last = t[-1]
        if len(t) > READ:
            groups = np.array_split(np.arange(len(t)), READ)
            t, y = (np.array([one[g].mean() for g in groups]) for one in (t, y))
        sign, limit = (-1.0 if falls else 1.0), limits[unit]
        wear = sign * (y - y[0]) / abs(limit - y[0])
        clock = (t - t[0]) / (t[-1] - t[0])
        noise = max(float(np.std(np.diff(wear))) / math.sqrt(2), 1e-4)
        step = float(np.median(np.diff(clock)))
        model = Walk(process_noise=0, measurement_noise=0)
        model.own_noise = (noise / 2, max(float(wear[-1]), 0.1))
        np.random.seed(0)  # progpy draws from it
        usual = max(float(wear[-1]), 0.1)
        start = MultivariateNormalDist(["wear", "rate"], [0.0, usual], np.diag([noise**2, usual**2]))
        filtered = ParticleFilter(model, start, num_particles=PARTICLES, dt=step, measurement_noise={"wear": noise})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for now, value in zip(clock[1:], wear[1:], strict=True):
                filtered.estimate(float(now), model.InputContainer({}), model.OutputContainer({"wear": value}))
        drawn = filtered.x.sample(2000)
        level, rate = (np.array(drawn.key(name), dtype=float) for name in ("wear", "rate"))
        left = np.where(rate > 0, np.maximum(1 - level, 0.0) / np.where(rate > 0, rate, 1.0), np.inf)
        ends = np.maximum(left * (t[-1] - t[0]) - (last - t[-1]), 0.0)
        low, median, high = np.quantile(ends, [0.05, 0.5, 0.95], method="inverted_cdf")
        return float(low), float(median), float(high)

    return ask
