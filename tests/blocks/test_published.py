"""Figures printed by others: tests/data/structures.json, and the Aralia fault trees where they lie beside."""

import json
from pathlib import Path

import numpy as np
import pytest

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.reliability import Structure

ROOT = Path(__file__).parents[2]
CASES = json.loads((ROOT / "tests/data/structures.json").read_text(encoding="utf-8"))["cases"]
SOLVED = ["baobab1", "baobab3", "chinese", "das9202", "das9205", "das9209"]
SOLVED += ["edf9201", "isp9603", "isp9604", "isp9606"]


def read(drawn: str | dict) -> Block:
    if isinstance(drawn, str):
        return Unit(drawn)
    ((kind, inner),) = drawn.items()
    if kind == "k_out_of_n":
        return KOutOfN(inner[0], *map(read, inner[1:]))
    return {"series": Series, "parallel": Parallel}[kind](*map(read, inner))


def units_of(case: dict, names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Works, failed and density of the units, as the case states them."""
    if "weibull" in case:
        scale, shape = np.array([case["weibull"][name] for name in names], dtype=float).T
        hazard = shape / scale * (case["time"] / scale) ** (shape - 1)
        exposure = (case["time"] / scale) ** shape
        return np.exp(-exposure), -np.expm1(-exposure), hazard * np.exp(-exposure)
    given, other = ("works", "failed") if "works" in case else ("failed", "works")
    p = {given: np.array([case[given][name] for name in names])}
    p[other] = 1 - p[given]
    return p["works"], p["failed"], np.zeros(len(names))


def measures(case: dict) -> dict:
    """Every measure that a case may print, by evaluation with one unit forced to work or to fail."""
    structure = Structure(read(case["diagram"]))
    n, names = len(structure.names), structure.names
    works, failed, density = units_of(case, names)
    now = structure.state(works, failed, density)
    force, keep = np.eye(n), 1 - np.eye(n)  # column i: unit i is forced, the others are kept
    up = structure.state(works[:, None] * keep + force, failed[:, None] * keep)
    down = structure.state(works[:, None] * keep, failed[:, None] * keep + force)
    half = 0.5 * keep
    birnbaum = up.works - down.works
    by_part = {
        "birnbaum": birnbaum,
        "criticality_failure": birnbaum * failed / now.failed,
        "criticality_success": birnbaum * works / now.works,
        "risk_achievement": down.failed / now.failed,
        "risk_reduction": now.failed / np.where(up.failed > 0, up.failed, np.nan),
        "structural": structure.state(half + force, half).works - structure.state(half, half + force).works,
        "density_by_part": structure.state(works[:, None], failed[:, None], density[:, None] * force).density,
    }
    return {
        "works": now.works,
        "failed": now.failed,
        "density": now.density,
        "hazard": now.density / now.works,
        "highest_birnbaum": names[int(np.argmax(birnbaum))],
        "single_points_of_failure": [name for name, R in zip(names, down.works, strict=True) if R == 0],
    } | {measure: dict(zip(names, values, strict=True)) for measure, values in by_part.items()}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published_figure(case: dict) -> None:
    found = measures(case)
    for measure, expected in case["expected"].items():
        if isinstance(expected, dict):
            for name, value in expected.items():
                assert found[measure][name] == pytest.approx(value, abs=case["tolerance"], rel=0), (
                    measure,
                    name,
                )
        elif isinstance(expected, float):
            assert found[measure] == pytest.approx(expected, abs=case["tolerance"], rel=0), measure
        else:
            assert found[measure] == expected


@pytest.mark.full
@pytest.mark.parametrize(
    "name",
    [
        "baobab1",
        "baobab3",
        "chinese",
        "das9202",
        "das9205",
        "das9209",
        "edf9201",
        "isp9603",
        "isp9604",
        "isp9606",
    ],
)
def test_aralia_fault_tree(name: str, shared: Path) -> None:
    cases = json.loads((shared / "cases/aralia_top_event.json").read_text(encoding="utf-8"))["cases"]
    case = next(case for case in cases if case["name"] == f"aralia/{name}")
    gates, events, made = case["system"]["gates"], case["system"]["events"], {}

    def block(node: str) -> Block:
        """What works while the event does not occur: an "or" of failures is a series."""
        if node in made:
            return made[node]
        if node not in gates:
            made[node] = Unit(node)
        else:
            inputs = [block(arg) for arg in gates[node]["args"]]
            k = {"and": 1, "k_of_n_fail": len(inputs) + 1 - gates[node].get("k", 1)}
            made[node] = KOutOfN(k.get(gates[node]["op"], len(inputs)), *inputs)
        return made[node]

    structure = Structure(block(case["system"]["top"][0]))
    q = np.array([events[unit]["prob"] for unit in structure.names])
    expected = case["expected"]["top_event_probability"]
    assert structure.state(1 - q, q).failed == pytest.approx(expected, rel=5e-6)  # six digits are printed


def drawn(structure: object) -> Block:
    """A structure as the shared cases write it."""
    if isinstance(structure, str):
        return Unit(structure)
    assert isinstance(structure, dict)
    ((kind, inner),) = structure.items()
    if kind == "k_of_n_work":
        return KOutOfN(inner[0], *(drawn(block) for block in inner[1]))
    return {"series": Series, "parallel": Parallel}[kind](*(drawn(block) for block in inner))


def test_shared_cases_of_series_parallel_and_k_of_n(shared: Path) -> None:
    """Every case of the two files that states a structure of these and one probability for each part."""
    solved = []
    for file in ("published_pages", "repyability_live_and_static"):
        for case in json.loads((shared / f"cases/{file}.json").read_text(encoding="utf-8"))["cases"]:
            system, parts = case["system"], case["system"].get("components", {})
            known = {name: part.get("rel", 1 - part.get("fail_prob", np.nan)) for name, part in parts.items()}
            if not isinstance(system.get("structure"), dict) or any(np.isnan(list(known.values()))):
                continue
            structure = Structure(drawn(system["structure"]))
            p = np.array([known[name] for name in structure.names])
            state = structure.state(p, 1 - p)
            limit = next(iter(case["tolerance"].values()))["abs"]
            for measure, found in (("reliability", state.works), ("unreliability", state.failed)):
                if measure in case["expected"]:
                    assert found == pytest.approx(case["expected"][measure], abs=limit), case["name"]
                    solved.append(case["name"])
    assert sorted(solved) == [
        "published/schematex_redundant_server",
        "repyability/criticality",
        "repyability/shared_supply",
    ]
