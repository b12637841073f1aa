"""The shared models of fault trees, written as files and read as a user does.

Against the sum over all states, or what SCRAM's tests print.
"""

import json
from collections.abc import Iterator
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

from robophm.blocks.cut_sets import MinimalSets
from robophm.design.importers.open_psa import load

PRINTED = {
    "chinese": (0.0045691, 1e-5, [0, 12, 0, 24, 188, 168]),
    "chinese_importance": (0.0045691, 1e-5, [0, 12, 0, 24, 188, 168]),
    "baobab1": (1.2823e-6, 5.0005e-11, [0, 1, 1, 70, 400, 2212, 14748, 8460, 10624, 6600, 3072]),
}
"""Too large for the sum over all states: the probability, how near they ask for, and the minimal cut sets of 1, 2, …
events, as SCRAM's tests print them (bench_chinese_tree_tests.cc, bench_baobab1_tests.cc)."""

IMPORTANCE = {
    "e1": (0.0745557, 0.326332), "e4": (0.0553923, 0.242453), "e8": (0.000181647, 0.000795073),
    "e9": (5.89643e-05, 0.000258088), "e12": (9.51481e-05, 0.000416465), "e14": (5.1467e-06, 2.25272e-05),
    "e17": (5.64596e-06, 2.47125e-05), "e19": (4.60982e-06, 2.01773e-05), "e21": (2.3919e-06, 1.04694e-05),
    "e22": (1.03582e-05, 4.5338e-05),
}  # fmt: skip
"""Of the Chinese tree's events, one of each kind of equal ones: marginal and critical, to six digits, likewise."""

MODELS = [
    "chinese", "baobab1", "theatre", "two_train", "lift", "ne574", "abc_or", "ab_bc_shared", "atleast_2of3",
    "ab_or_not_ac_noncoherent", "three_motor", "two_train_importance", "noncoherent_importance", "chinese_importance",
]  # fmt: skip


def cases(shared, file: str) -> dict[str, Any]:
    found = json.loads((shared / f"cases/{file}.json").read_text(encoding="utf-8"))["cases"]
    return {case["name"].partition("/")[2]: case for case in found}


def written(name: str) -> str:
    """A name as the format has it: a dot would say in which component it is."""
    return quoteattr(name.replace(".", "_"))


def formula(said: Any, system: dict[str, Any]) -> str:
    if isinstance(said, str):
        kind = "gate" if said in system["gates"] else "basic-event" if said in system["events"] else "house-event"
        return f"<{kind} name={written(said)}/>"
    inside = "".join(formula(one, system) for one in said["args"])
    if said["op"] == "null":
        return inside
    if said["op"] == "k_of_n_fail":
        return f'<atleast min="{said["k"]}">{inside}</atleast>'
    return f"<{said['op']}>{inside}</{said['op']}>"


def document(system: dict[str, Any]) -> Iterator[str]:
    yield '<opsa-mef><define-fault-tree name="t">'
    for name, said in system["gates"].items():
        yield f"<define-gate name={written(name)}>{formula(said, system)}</define-gate>"
    yield "</define-fault-tree><model-data>"
    for name, said in system["events"].items():
        yield f'<define-basic-event name={written(name)}><float value="{said["prob"]!r}"/></define-basic-event>'
    for name, state in system.get("house_events", {}).items():
        value = str(state).lower()
        yield f'<define-house-event name={written(name)}><constant value="{value}"/></define-house-event>'
    yield "</model-data></opsa-mef>"


def summed(system: dict[str, Any]) -> float:
    """The probability of the top event as the sum over all states of the events."""
    names = list(system["events"])
    states = np.arange(2 ** len(names))
    true = {name: (states >> i & 1).astype(bool) for i, name in enumerate(names)}
    sure = {name: np.full(len(states), state) for name, state in system.get("house_events", {}).items()}

    def occurs(said: Any) -> np.ndarray:
        if isinstance(said, str):
            known = true | sure
            return known[said] if said in known else occurs(system["gates"][said])
        count = sum(occurs(one).astype(int) for one in said["args"])
        n = len(said["args"])
        if said["op"] == "xor":
            return count % 2 == 1
        if said["op"] == "not":
            return count == 0
        return count >= {"and": n, "or": 1, "null": 1, "k_of_n_fail": said.get("k")}[said["op"]]

    chance = np.ones(len(states))
    for name, said in system["events"].items():
        chance *= np.where(true[name], said["prob"], 1 - said["prob"])
    return float(chance[occurs(system["top"][0])].sum())


@pytest.mark.parametrize("name", MODELS)
def test_a_model_has_its_probability(shared, tmp_path, name):
    case = cases(shared, "fault_tree_models")[name]
    path = tmp_path / "model.xml"
    path.write_text("\n".join(document(case["system"])))
    model = load(path, top=case["system"]["top"][0])
    if name in PRINTED:
        expected, near, by_order = PRINTED[name]
        assert model.probability() == pytest.approx(expected, abs=near, rel=0)
        assert MinimalSets(model.tree).count_by_order(len(by_order)) == by_order
        assert MinimalSets(model.tree).count() == sum(by_order)
    else:
        assert len(case["system"]["events"]) <= 16
        assert model.probability() == pytest.approx(summed(case["system"]), rel=1e-12)


def test_what_each_event_of_the_chinese_tree_adds(shared, tmp_path):
    """The probability if it has occurred, less that if it has not."""
    path = tmp_path / "model.xml"
    path.write_text("\n".join(document(cases(shared, "fault_tree_models")["chinese_importance"]["system"])))
    model = load(path)
    for name, (marginal, critical) in IMPORTANCE.items():
        p = np.repeat(model.occurred[:, None], 2, axis=1)
        p[model.tree.names.index(name)] = 1.0, 0.0
        more = np.subtract(*model.tree.probability(p))
        assert more == pytest.approx(marginal, rel=3e-6), name
        assert more * 0.02 / model.probability() == pytest.approx(critical, rel=3e-6), name


def test_every_model_is_here(shared):
    assert sorted(cases(shared, "fault_tree_models")) == sorted(MODELS)
