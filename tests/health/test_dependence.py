"""Parts that take others with them, and parts that fail together: against every state of all that can happen."""

from __future__ import annotations

import json
import math
import random
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Leg, Task
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

HOURS = 40.0


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


class Truth:
    """A design as its words say it: what works, given which parts broke and which causes struck."""

    def __init__(self, design: dict[str, Any], shares: dict[str, list[float]]) -> None:
        self.design = design
        self.rates: dict[object, float] = {}
        """Of every part alone, and of every cause by group and the set that it strikes [1/h]."""
        for path, part in self.parts():
            for i in range(part.get("quantity", 1)):
                self.rates[path, i] = float(part["rate"].split()[0])
        for group, members in ((name, g["of"]) for name, g in design.get("common_causes", {}).items()):
            every = [one for path in members for one in self.rates if isinstance(one, tuple) and one[0] == path]
            rate = self.rates[every[0]]
            for k, share in enumerate(shares[group], 1):
                for together in combinations(every, k):
                    if k == 1:
                        self.rates[together[0]] = share * rate
                    else:
                        self.rates[group, frozenset(together)] = share * rate

    def parts(self) -> list[tuple[str, dict[str, Any]]]:
        found = list(self.design["components"].items())
        for name, module in self.design["modules"].items():
            found += [(f"{name}/{part}", said) for part, said in module["components"].items()]
        return found

    def works(self, level: str, block: Any, gone: set[object]) -> bool:
        if isinstance(block, list):
            return all(self.works(level, one, gone) for one in block)
        if isinstance(block, dict):
            ((kind, inside),) = block.items()
            k = {"series": len(inside), "parallel": 1}.get(kind) or inside["k"]
            blocks = inside["of"] if kind == "k_of_n" else inside
            return sum(self.works(level, one, gone) for one in blocks) >= k
        path = block[1:] if block.startswith("/") else f"{level}/{block}" if level else block
        name, _, part = path.partition("/")
        if name in self.design["modules"]:
            module = self.design["modules"][name]
            if "depends_on" in module and not self.works("", module["depends_on"], gone):
                return False
            if not part:
                drawn = module.get("diagram", {"series": list(module["components"])})
                return self.works(name, drawn, gone)
            said = module["components"][part]
        else:
            said = self.design["components"][name]
        if "depends_on" in said and not self.works(name if part else "", said["depends_on"], gone):
            return False
        struck = {one for cause in gone if isinstance(cause[1], frozenset) for one in cause[1]}  # type: ignore[index]
        quantity = said.get("quantity", 1)
        alive = sum((path, i) not in gone and (path, i) not in struck for i in range(quantity))
        return alive >= said.get("required", quantity)

    def reliability(self, block: Any, hours: float) -> tuple[float, float]:
        """(works, failed): the sums over all states."""
        sums: tuple[list[float], list[float]] = ([], [])
        for state in product([False, True], repeat=len(self.rates)):
            gone = {one for one, broke in zip(self.rates, state, strict=True) if broke}
            weight = math.prod(
                -math.expm1(-rate * hours) if broke else math.exp(-rate * hours)
                for rate, broke in zip(self.rates.values(), state, strict=True)
            )
            sums[not self.works("", block, gone)].append(weight)
        return math.fsum(sums[0]), math.fsum(sums[1])

    def mission(self, first: Any, second: Any, hours: tuple[float, float]) -> float:
        """P(the first works after its hours, and the second after those of both), new at the start."""
        found = []
        for when in product(range(3), repeat=len(self.rates)):
            weight = 1.0
            for rate, i in zip(self.rates.values(), when, strict=True):
                ends = [0.0, hours[0], hours[0] + hours[1], math.inf]
                weight *= math.exp(-rate * ends[i]) - math.exp(-rate * ends[i + 1])
            until = [{one for one, i in zip(self.rates, when, strict=True) if i <= k} for k in (0, 1)]
            if self.works("", first, until[0]) and self.works("", second, until[1]):
                found.append(weight)
        return math.fsum(found)


BETA = {"beta": 0.2}, [0.8, 0.2]
PAIR = {"mgl": [0.3]}, [0.7, 0.3]
BETA_OF_3 = {"beta": 0.1}, [0.9, 0.0, 0.1]
MGL = {"mgl": [0.3, 0.4]}, [0.7, 0.3 * 0.6 / 2, 0.12]
ALPHA = {"alpha": [0.8, 0.15, 0.05], "testing": "non-staggered"}, [0.8 / 1.25, 0.15 / 1.25, 0.15 / 1.25]


def some_design(rng: random.Random) -> tuple[dict[str, Any], dict[str, list[float]]]:
    """A board, a module that may need it, and a part that may need anything; some fail together."""

    def rate() -> str:
        return f"{rng.choice([0.002, 0.004, 0.009])} /h"

    def needs(*names: str) -> dict[str, Any]:
        if rng.random() < 0.4:
            return {}
        chosen = rng.sample(names, rng.randint(1, len(names)))
        kind = rng.choice(["one", "list", "parallel"])
        return {"depends_on": chosen[0] if kind == "one" else chosen if kind == "list" else {"parallel": chosen}}

    alike = rate()
    inner = {"A": {"rate": alike} | needs("/Board"), "B": {"rate": alike} | needs("A", "/Board")}
    inner["B"] |= rng.choice([{}, {"quantity": 2}, {"quantity": 2, "required": 1}])
    module = {"components": inner} | needs("Board", "/Board")
    if rng.random() < 0.5:
        module["diagram"] = {"parallel": ["A", "B"]}
    last = {"rate": rng.choice([alike, rate()])} | needs("Board", "M", "M/A", "/M/B")
    design = {
        "components": {"Board": {"rate": rate()}, "Last": last},
        "modules": {"M": module},
        "diagram": rng.choice([{"series": ["M", "Last"]}, {"parallel": ["M", "Last"]}, {"parallel": ["M/A", "Last"]}]),
        "functions": {"see": {"k_of_n": {"k": 2, "of": ["M/A", "/M/B", "Last"]}}, "go": {"parallel": ["M/B", "Board"]}},
    }
    members = ["M/A", "M/B"] + (["Last"] if last["rate"] == alike else [])
    members = rng.sample(members, rng.randint(1 if "quantity" in inner["B"] else 2, len(members)))
    size = sum(inner["B"].get("quantity", 1) if one == "M/B" else 1 for one in members)
    if 2 <= size <= 3:
        said, shares = rng.choice([BETA, PAIR] if size == 2 else [BETA_OF_3, MGL, ALPHA])
        return design | {"common_causes": {"Heat": {"of": members, **said}}}, {"Heat": shares}
    return design, {}


@pytest.mark.parametrize("seed", range(30))
def test_any_design_is_the_sum_over_all_states(seed):
    design, shares = some_design(random.Random(seed))
    truth, built = Truth(design, shares), robot(**design)
    new = as_designed(Plant(built))
    module = next(built.all_modules())
    blocks = [(built.diagram, design["diagram"]), (module.diagram, "M")]
    blocks += [(built.functions[name], design["functions"][name]) for name in ("see", "go")]
    for ours, said in blocks:
        state = new.survival_curve(ours, np.array([HOURS]))
        assert (state.works[0], state.failed[0]) == pytest.approx(truth.reliability(said, HOURS), rel=1e-11)


@pytest.mark.parametrize("seed", [3, 7, 11, 20, 28])
def test_any_mission_is_the_sum_over_all_orders(seed):
    design, shares = some_design(random.Random(seed))
    truth = Truth(design, shares)
    task = Task((Leg(30.0, functions=("see",)), Leg(50.0, functions=("go",))))
    exact = truth.mission(design["functions"]["see"], design["functions"]["go"], (30.0, 50.0))
    assert completion(as_designed(Plant(robot(**design))), task).probability == pytest.approx(exact, rel=1e-10)
