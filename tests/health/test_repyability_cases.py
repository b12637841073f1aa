"""Every figure of the two files of what RePyability prints, by robots that are asked as people ask them."""

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from robophm.blocks.common_cause import alpha_factor, beta_factor, multiple_greek_letter
from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.diagram import Block, KOutOfN, Link, Network, Parallel, Series, Unit
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, UNIT, Gate
from robophm.blocks.reliability import Structure
from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook

FILES = ("repyability_dependent", "repyability_live_and_static")
System = dict[str, Any]


def part(said: System, age: float = 0.0) -> dict[str, Any]:
    """A part that has worked for so many hours."""
    used = {"initial_exposure": f"{age} h"} if age else {}
    if said["dist"] == "exponential":
        return {"rate": f"{said['rate']} /h", **used}
    shape = {"scale": f"{said['alpha_scale']} h", "shape": said["beta_shape"]}
    return {"life": {"distribution": "weibull", **shape}, **used}


def outlook(parts: dict[str, Any], **more: Any) -> Outlook:
    design = {"schema_version": 1, "name": "R", "components": parts, **more}
    return as_designed(Plant(parse(json.dumps(design))))


def alone(system: System, age: float = 0.0, **more: Any) -> Outlook:
    return outlook({name: part(said, age) for name, said in system["components"].items()}, **more)


def at(now: Outlook, hours: float, unit: str = "") -> Any:
    return now.survival_curve(Unit(unit) if unit else now.plant.robot.diagram, np.array([hours]))


def survives(now: Outlook, further: float) -> float:
    """Given that it works now."""
    return float(now.curve(now.plant.robot.diagram)(np.array([further]))[1][0])


def block(said: Any) -> Block:
    if isinstance(said, str):
        return Unit(said)
    ((kind, inner),) = said.items()
    if kind == "k_of_n_work":
        return KOutOfN(inner[0], *map(block, inner[1]))
    return {"series": Series, "parallel": Parallel}[kind](*map(block, inner))


def forced(diagram: Block, failed: dict[str, float]) -> dict[str, tuple[float, float]]:
    """Of each part, the probability that the system fails if it works, and if it has failed."""
    structure = Structure(diagram)

    def fails(**sure: float) -> float:
        q = np.array([(failed | sure)[name] for name in structure.names])
        return float(structure.state(1 - q, q).failed)

    return {name: (fails(**{name: 0.0}), fails(**{name: 1.0})) for name in failed}


def b10_life(system: System) -> dict[str, Any]:
    now = alone(system, thresholds={"survival": 0.9})
    life = now.remaining_life(now.plant.robot.diagram).threshold
    return {"B10_life": life, "time_to_reliability_0.9": life}


def conditional_survival(system: System) -> dict[str, Any]:
    return {
        "conditional_reliability(further=10|age=50)": survives(alone(system, 50.0), 10.0),
        "reliability_at": {"60": at(alone(system), 60.0).works[0]},
    }


def criticality(system: System) -> dict[str, Any]:
    diagram = block(system["structure"])
    q = {name: said["fail_prob"] for name, said in system["components"].items()}
    tree = FaultTree.of(diagram)
    whole = float(tree.probability([q[name] for name in tree.names]))
    both = forced(diagram, q)
    birnbaum = {name: lost - kept for name, (kept, lost) in both.items()}
    half = forced(diagram, dict.fromkeys(q, 0.5))
    cuts = [one.names for one in MinimalSets(tree).smallest([q[name] for name in tree.names])]

    def any_with(name: str) -> float:
        """The probability that a minimal cut set with this part has failed."""
        inside = [cut for cut in cuts if name in cut]
        names = sorted({one for cut in inside for one in cut})
        gates = [Gate(UNIT, ())] * len(names) + [Gate(ALL, [names.index(one) for one in cut]) for cut in inside]
        gates.append(Gate(ANY, range(len(names), len(gates))))
        return float(FaultTree(names, gates).probability([q[one] for one in names]))

    return {
        "unreliability": whole,
        "birnbaum": birnbaum,
        "criticality_failure": {name: birnbaum[name] * q[name] / whole for name in q},
        "criticality_success": {name: birnbaum[name] * (1 - q[name]) / (1 - whole) for name in q},
        "fussell_vesely_exact": {name: any_with(name) / whole for name in q},
        "RAW": {name: lost / whole for name, (_, lost) in both.items()},
        "RRW": {name: whole / kept for name, (kept, _) in both.items()},
        "structural": {name: lost - kept for name, (kept, lost) in half.items()},
    }


def hazard_exponential(system: System) -> dict[str, Any]:
    state = at(alone(system), 50.0)
    rate = alone(system, 50.0)
    return {
        "hazard_at_50": rate.hazard_rate(rate.plant.robot.diagram),
        "density_at_50": state.density[0],
        "cumulative_hazard_at_50": -math.log(state.works[0]),
    }


def importance_given_state(system: System) -> dict[str, Any]:
    names = system["components"]
    failed = {name: 1 - survives(outlook({name: part(names[name], system["ages"][name])}), 20.0) for name in names}
    both = forced(block(system["structure"]), failed)
    return {"birnbaum_at_further_20": {name: lost - kept for name, (kept, lost) in both.items()}}


def mean_residual_life(system: System) -> dict[str, Any]:
    new, used = alone(system), alone(system, 40.0)
    return {
        "MTTF": new.remaining_life(new.plant.robot.diagram).mean,
        "mean_residual_life(age=40)": used.remaining_life(used.plant.robot.diagram).mean,
    }


def network_bridge(system: System) -> dict[str, Any]:
    edges = system["structure"].removeprefix("node graph edges ").partition(" ")[0].split(",")
    structure = Structure(Network("0", "6", [Link(*edge.split("-"), one_way=True) for edge in edges]))
    q = np.array([system["components"][name]["fail_prob"] for name in structure.names])
    return {"reliability": float(structure.state(1 - q, q).works)}


def reliability_rate(system: System) -> dict[str, Any]:
    now, diagram = alone(system), block(system["structure"])
    states = {name: at(now, 50.0, name) for name in system["components"]}
    both = forced(diagram, {name: float(state.failed[0]) for name, state in states.items()})
    return {
        "dR_dt_parts_at_50": {name: -(lost - kept) * states[name].density[0] for name, (kept, lost) in both.items()}
    }


def shared_supply(system: System) -> dict[str, Any]:
    tree = FaultTree.of(block(system["structure"]))
    return {"unreliability": float(tree.probability([system["components"][name]["fail_prob"] for name in tree.names]))}


def shared_out(shares: list[float], system: System) -> dict[str, Any]:
    names = ("q_independent", "q_each_pair", "q_triple")
    return {name: system["Q"] * share for name, share in zip(names, shares, strict=True)}


def beta_pair(system: System) -> dict[str, Any]:
    own, both = (0.1 * share for share in beta_factor(system["ccf"]["beta"], 2))
    assert {said["fail_prob"] for said in system["components"].values()} == {0.1}
    pair = Structure(Parallel(Series("a", "both"), Series("b", "both")))
    q = np.array([both if name == "both" else own for name in pair.names])
    without = Structure(block(system["structure"]))
    return {
        "reliability": float(pair.state(1 - q, q).works),
        "reliability_independent": float(without.state([0.9, 0.9], [0.1, 0.1]).works),
    }


def phased_single(system: System) -> dict[str, Any]:
    now = alone(system)
    legs = [Leg(float(phase["duration"])) for phase in system["phases"]]
    assert {phase["structure"] for phase in system["phases"]} == set(system["components"])
    by = [0.0, *(completion(now, Task(tuple(legs[: i + 1]))).failure for i in range(len(legs)))]
    return {"phase_failure": {phase["name"]: by[i + 1] - by[i] for i, phase in enumerate(system["phases"])}}


def standby(system: System) -> Outlook:
    names = [f"unit {i}" for i in range(len(system["units"]))]
    parts = {name: part(said) for name, said in zip(names, system["units"], strict=True)}
    return outlook(
        parts, diagram={"standby": {"of": names, "active": system.get("k", 1), "dormancy": system["dormancy"]}}
    )


def standby_cold(system: System) -> dict[str, Any]:
    new = standby(system)
    return {
        "MTTF": new.remaining_life(new.plant.robot.diagram).mean,
        "reliability_at": {time: at(new, float(time)).works[0] for time in ("50", "100")},
    }


def standby_conditional(system: System) -> dict[str, Any]:
    """Of those that work at 100 h, those that still do at 150 h."""
    new = standby(system)
    return {"conditional_reliability(further=50|age=100)": at(new, 150.0).works[0] / at(new, 100.0).works[0]}


SOLVED: dict[str, Callable[[System], dict[str, Any]]] = {
    "ccf_alpha3": lambda system: shared_out(alpha_factor(system["alpha"], 3), system),
    "ccf_alpha3_nonstaggered": lambda system: shared_out(alpha_factor(system["alpha"], 3, staggered=False), system),
    "ccf_beta_pair": beta_pair,
    "ccf_mgl3": lambda system: shared_out(multiple_greek_letter([system["beta"], system["gamma"]], 3), system),
    "phased_single": phased_single,
    "standby_cold_exp": standby_cold,
    "standby_conditional": standby_conditional,
    "b10_life": b10_life,
    "conditional_survival": conditional_survival,
    "criticality": criticality,
    "hazard_exponential": hazard_exponential,
    "importance_given_state": importance_given_state,
    "mean_residual_life": mean_residual_life,
    "network_bridge_Ignou": network_bridge,
    "reliability_rate": reliability_rate,
    "shared_supply": shared_supply,
}


def flat(said: dict[str, Any]) -> dict[tuple[str, ...], float]:
    """Measures that are of each part, one by one."""
    return {
        (measure, *(() if one is None else (one,))): value
        for measure, inner in said.items()
        for one, value in (inner.items() if isinstance(inner, dict) else [(None, inner)])
    }


def test_every_case_is_solved_and_every_figure_met(shared):
    cases = [
        case
        for file in FILES
        for case in json.loads((shared / f"cases/{file}.json").read_text(encoding="utf-8"))["cases"]
    ]
    assert sorted(case["name"].partition("/")[2] for case in cases) == sorted(SOLVED)
    for case in cases:
        found = flat(SOLVED[case["name"].partition("/")[2]](case["system"]))
        for figure, expected in flat(case["expected"]).items():
            limit = case["tolerance"].get(figure[0]) or case["tolerance"]["*"]
            allowed = limit["abs"] if "abs" in limit else limit["rel"] * abs(expected)
            assert abs(found[figure] - expected) <= allowed, (case["name"], figure, found[figure], expected)
