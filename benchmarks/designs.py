"""One robot of any size, told twice: as a design file of ours, and as a block diagram of RePyability.

Every ten parts are a module: one alone, two in parallel, 2 of 3, two alone, two in parallel. Weibull and
exponential lives take turns; all parts are known to work until reported failed, as the peer has it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from robophm.design.file import parse
from robophm.design.robot import Robot

GROUPS = ((1, 1), (1, 2), (2, 3), (1, 1), (1, 1), (1, 2))
"""k of n, in series."""

MISSION = 10.0
"""Hours."""

Life = tuple[float, float | None]
"""Scale [h] and, where the part ages, the Weibull shape."""


FUNCTIONS = {"drive": range(6), "see": (0, 1, 2, 6, 7), "lift": (0, 1, 8, 9)}
"""Modules that each function of a robot of a hundred parts needs: three are shared."""


@dataclass(frozen=True)
class Twins:
    """The same robot, ours and theirs; ages and lives in the order of ``names``."""

    robot: Robot
    rbd: Any
    names: tuple[str, ...]
    models: dict[str, Any]
    """The peer's lives by part."""
    junctions: tuple[str, ...]
    """Where the peer's lines meet; they never fail."""

    def state(self, age: np.ndarray) -> dict[str, float]:
        """Ages of the parts as the peer's live calls take them."""
        return dict(zip(self.names, age.tolist(), strict=True))

    def system(self, works: Any) -> np.ndarray:
        """The peer's reliability of the system from that of its parts, shape (parts, ...)."""
        given = dict(zip(self.names, works, strict=True)) | dict.fromkeys(self.junctions, np.ones_like(works[0]))
        result: np.ndarray = self.rbd.system_probability(given)
        return result


def draw(parts: int, types: int | None = None, ageing: bool = False) -> dict[str, Life]:
    """Lives of so many parts, of so many types in turn; ``ageing``: all are Weibull."""
    rng = np.random.default_rng(parts)
    scales = 10 ** rng.uniform(3.5, 5.5, types or parts)
    shapes = rng.uniform(1.0, 4.0, types or parts)
    which = [i % (types or parts) for i in range(parts)]
    return {
        f"M{i // 10}/P{i % 10}": (float(scales[of]), float(shapes[of]) if ageing or i % 2 else None)
        for i, of in enumerate(which)
    }


def ages(parts: int, tick: int) -> np.ndarray:
    """Of all parts at a tick [h]: each has its own past, and all go on."""
    return np.random.default_rng(tick).uniform(100.0, 3000.0, parts)


def robot_of(parts: int, ageing: bool = False) -> Robot:
    """Ours alone."""
    return parse("\n".join(_yaml(draw(parts, ageing=ageing))))


def twins(parts: int, types: int | None = None, ageing: bool = False) -> Twins:
    lives = draw(parts, types, ageing)
    return Twins(parse("\n".join(_yaml(lives))), *_diagram(lives))


def uncertain(parts: int) -> Robot:
    """Ours, of all whose rates nothing is known but their order of magnitude."""
    return parse("\n".join((*_yaml(draw(parts)), "uncertainty: {error_factor: 3}")))


def _groups(names: list[str]) -> Iterator[tuple[int, list[str]]]:
    start = 0
    for k, n in GROUPS:
        yield k, names[start : start + n]
        start += n


def _yaml(lives: dict[str, Life]) -> Iterator[str]:
    yield from ("schema_version: 1", "name: Bench", f"task: {{duration: {MISSION} h}}")
    if len(lives) == 100:
        yield "functions:"
        yield from (f"  {name}: {{series: [{', '.join(f'M{i}' for i in m)}]}}" for name, m in FUNCTIONS.items())
    yield "modules:"
    for module in dict.fromkeys(name.split("/")[0] for name in lives):
        inside = {name.split("/")[1]: life for name, life in lives.items() if name.startswith(module + "/")}
        yield f"  {module}:"
        yield "    diagram:"
        yield "      series:"
        for k, group in _groups(list(inside)):
            if len(group) == 1:
                yield f"        - {group[0]}"
            elif k == 1:
                yield f"        - parallel: [{', '.join(group)}]"
            else:
                yield f"        - k_of_n: {{k: {k}, of: [{', '.join(group)}]}}"
        yield "    components:"
        for name, (scale, shape) in inside.items():
            life = f"life: {{distribution: weibull, scale: {scale!r} h, shape: {shape!r}}}"
            yield f"      {name}: {{monitored: true, {life if shape else f'rate: {1 / scale!r} /h'}}}"


def function(name: str) -> Any:
    """The peer's diagram of a function of a robot of a hundred parts."""
    lives = draw(100)
    modules = tuple(f"M{i}/" for i in FUNCTIONS[name])
    return _diagram({part: life for part, life in lives.items() if part.startswith(modules)})[0]


def _diagram(lives: dict[str, Life]) -> tuple[Any, tuple[str, ...], dict[str, Any], tuple[str, ...]]:
    import surpyval
    from repyability import NonRepairableRBD, PerfectReliability

    models = {
        name: surpyval.Weibull.from_params([scale, shape]) if shape else surpyval.Exponential.from_params([1 / scale])
        for name, (scale, shape) in lives.items()
    }
    edges: list[tuple[str, str]] = []
    needs: dict[str, int] = {}
    junctions: dict[str, Any] = {}
    last = "in"
    names = list(lives)
    for start in range(0, len(names), 10):
        for k, group in _groups(names[start : start + 10]):
            edges += [(last, name) for name in group]
            last = group[0]
            if len(group) > 1:
                last = f"after {group[-1]}"
                edges += [(name, last) for name in group]
                junctions[last] = PerfectReliability
                needs |= {last: k} if k > 1 else {}
    edges.append((last, "out"))
    return NonRepairableRBD(edges, models | junctions, needs), tuple(lives), models, tuple(junctions)
