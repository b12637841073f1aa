"""Networks against published figures, closed forms and the search for a path in every state."""

import itertools
import json
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from tests.cases import examples

from robophm.blocks.diagram import KOutOfN, Link, Network, Parallel, Series, Unit, units
from robophm.blocks.merging import merge_series
from robophm.blocks.phases import Phases
from robophm.blocks.reliability import Structure
from robophm.blocks.single_points import single_points_of_failure
from robophm.core.errors import StructureError

BRIDGE = Network("s", "t", [Link("s", "a", "1"), Link("s", "b", "2"), Link("a", "b", "3"),
                            Link("a", "t", "4"), Link("b", "t", "5")], {})  # fmt: skip


def path(network: Network, state: dict[str, bool]) -> bool:
    """Whether a path of what works joins source and sink, by search."""
    works = {name: holds(block, state) for name, block in network.nodes}
    found, todo = set(), [network.source]
    while todo:
        node = todo.pop()
        if node in found or not works.get(node, True):
            continue
        found.add(node)
        for start, end, block, one_way in network.links:
            if block is None or holds(block, state):
                todo += [end] * (start == node) + [start] * (end == node and not one_way)
    return network.sink in found


def holds(block, state) -> bool:
    if isinstance(block, Unit):
        return state[block.name]
    if isinstance(block, Network):
        return path(block, state)
    inner = [holds(one, state) for one in block.blocks]
    k = block.k if isinstance(block, KOutOfN) else 1 if isinstance(block, Parallel) else len(inner)
    return sum(inner) >= k


def by_states(block, names, p) -> float:
    total = 0.0
    for state in itertools.product([False, True], repeat=len(names)):
        if holds(block, dict(zip(names, state, strict=True))):
            total += float(np.prod([p[i] if up else 1 - p[i] for i, up in enumerate(state)]))
    return total


def reliability(block, works) -> float:
    structure = Structure(block)
    p = np.array([works[name] for name in structure.names])
    return float(structure.state(p, 1 - p).works)


def test_the_published_bridge(shared):
    """RePyability's node graph after IGNOU, Unit 16, figure 16.1: 1-3 and 2-4 with 5 across."""
    cases = json.loads((shared / "cases/repyability_live_and_static.json").read_text())["cases"]
    (case,) = (one for one in cases if one["name"] == "repyability/network_bridge_Ignou")
    edges = case["system"]["structure"].removeprefix("node graph edges ").partition(" ")[0].split(",")
    network = Network("0", "6", [Link(*edge.split("-"), one_way=True) for edge in edges])
    works = {name: 1 - part["fail_prob"] for name, part in case["system"]["components"].items()}
    assert reliability(network, works) == pytest.approx(case["expected"]["reliability"], rel=1e-12)


def test_the_bridge_of_links_is_the_closed_form():
    """R = 2p² + 2p³ − 5p⁴ + 2p⁵ of five equal links (e.g. Rausand and Høyland 2004, example 4.9)."""
    for p in (0.1, 0.5, 0.9, 0.999):
        found = reliability(BRIDGE, dict.fromkeys("12345", p))
        assert found == pytest.approx(2 * p**2 + 2 * p**3 - 5 * p**4 + 2 * p**5, rel=1e-14)


def test_a_network_of_series_and_parallels_alone_is_solved_as_these():
    network = Network("in", "out", [("in", "a"), ("a", "b"), ("b", "out"), ("in", "c"), ("c", "out")])
    same = Parallel(Series("a", "b"), "c")
    works = {"a": 0.9, "b": 0.8, "c": 0.7}
    assert reliability(network, works) == pytest.approx(reliability(same, works), rel=1e-15)


def random_network(rng: random.Random) -> Network:
    """Of up to 6 nodes: links either way, parts on nodes and links, some of them repeated."""
    names = [f"n{i}" for i in range(rng.randint(3, 6))]
    parts = [f"u{i}" for i in range(rng.randint(2, 9))]

    def block():
        if rng.random() < 0.15:
            return rng.choice([Series, Parallel])(rng.choice(parts), rng.choice(parts))
        return rng.choice(parts)

    while True:
        pairs = [pair for pair in itertools.permutations(names, 2) if rng.random() < 0.5]
        links = [Link(a, b, block() if rng.random() < 0.7 else None, rng.random() < 0.5) for a, b in pairs]
        nodes = {name: block() for name in names if rng.random() < 0.5}
        try:
            return Network(names[0], names[1], links, nodes)
        except StructureError:
            continue


@settings(max_examples=examples(120), deadline=None, derandomize=True)
@given(st.integers(0, 2**32))
def test_random_networks_against_all_states(seed):
    rng = random.Random(seed)
    network = random_network(rng)
    names = sorted(set(units(network)))
    p = [rng.uniform(0.05, 0.99) for _ in names]
    expected = by_states(network, names, p)
    assert reliability(network, dict(zip(names, p, strict=True))) == pytest.approx(expected, rel=1e-12)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(st.integers(0, 2**32))
def test_networks_in_diagrams_and_diagrams_in_networks(seed):
    rng = random.Random(seed)
    first, second = random_network(rng), random_network(rng)
    block = KOutOfN(2, Series(first, "u0"), second, Parallel("u1", first))
    names = sorted(set(units(block)))
    p = [rng.uniform(0.05, 0.99) for _ in names]
    assert reliability(block, dict(zip(names, p, strict=True))) == pytest.approx(by_states(block, names, p), rel=1e-12)
    fatal = {name for name in names if not holds(block, {other: other != name for other in names})}
    assert single_points_of_failure(block) == fatal
    (merged,), stands_for = merge_series(block)
    works = dict(zip(names, p, strict=True))
    together = {name: float(np.prod([works[one] for one in group])) for name, group in stands_for.items()}
    assert reliability(merged, together) == pytest.approx(by_states(block, names, p), rel=1e-12)


def test_a_network_in_a_mission_is_the_same_as_the_structure_in_one_phase():
    structure = Structure(BRIDGE)
    phases = Phases([], [(1, BRIDGE)])
    known, more = np.array([0.1, 0.2, 0.3, 0.4, 0.5]), np.array([0.3, 0.1, 0.2, 0.5, 0.4])
    mission = phases.transition(known, more[None])
    assert phases.names == structure.names
    one = structure.state(np.exp(-known - more), -np.expm1(-known - more))
    assert_allclose(mission.survives, one.works, rtol=1e-13)


def test_a_long_ladder_is_solved_by_the_transfer_of_two_rails():
    """Two rails of 40 links each, joined by rungs that cannot fail: each stage is one of two, 1 − q² to the 40th."""
    links = []
    for i in range(40):
        links += [Link(f"a{i}", f"a{i + 1}", f"up{i}"), Link(f"b{i}", f"b{i + 1}", f"low{i}")]
        links += [(f"a{i + 1}", f"b{i + 1}")]
    network = Network("a0", "a40", [("a0", "b0"), *links], {})
    works = dict.fromkeys(units(network), 0.9)
    assert reliability(network, works) == pytest.approx((1 - 0.1**2) ** 40, rel=1e-12)


def test_a_grid_of_links_is_the_same_from_either_corner():
    def grid(turned: bool) -> Network:
        at = [f"{x}{y}" for x in range(5) for y in range(5)]
        links = [Link(f"{x}{y}", f"{x + 1}{y}", f"h{x}{y}") for x in range(4) for y in range(5)]
        links += [Link(f"{x}{y}", f"{x}{y + 1}", f"v{x}{y}") for x in range(5) for y in range(4)]
        return Network(at[-turned], at[turned - 1], random.Random(1).sample(links, len(links)) if turned else links, {})

    works = dict.fromkeys(units(grid(False)), 0.8)
    assert reliability(grid(False), works) == pytest.approx(reliability(grid(True), works), rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("in", "in", [("in", "a")]), "source and sink are both 'in'"),
        (("in", "out", [("in", "a"), ("b", "out")]), "no path leads from 'in' to 'out'"),
        (("in", "out", [Link("out", "a", one_way=True), Link("a", "in", one_way=True)]), "no path leads from"),
        (("in", "out", []), "no link joins 'in'"),
        (("inn", "out", [("in", "a"), ("a", "out")]), "no link joins 'inn' to anything; did you mean 'in'?"),
        (("in", "out", [("in", "a"), ("a", "a"), ("a", "out")]), "joins 'a' with itself"),
        (("in", "out", [("in", "a"), ("a", "out"), ("a", "spur")]), "no path from 'in' to 'out' passes 'spur'"),
        (("in", "out", [("in", "a"), ("a", "out"), Link("a", "b", "x")], {"a": "a"}), "passes the link 'a' – 'b'"),
        (("in", "out", [("in", "out"), ("in", "a"), ("a", "out")]), "has nothing on it that can fail"),
        (("in", "out", [("in", "a"), ("a", "out")], {"a": "a", "b": "b"}), "no link joins 'b'"),
        (("in", "out", [("in", str(i)) for i in range(2001)]), "expected at most 2,000"),
    ],
)
def test_what_is_no_network_is_refused(arguments, says):
    with pytest.raises(StructureError, match=r"^network: ") as refused:
        Network(*arguments)
    assert says in str(refused.value)


def test_a_dead_end_behind_a_node_is_found_although_it_is_reached():
    """b and c are reached, and reach the sink, but only back through a."""
    with pytest.raises(StructureError, match=r"passes '[bc]'"):
        Network("in", "out", [("in", "a"), ("a", "b"), ("b", "c"), ("c", "a"), ("a", "out")])


def test_a_mesh_too_large_for_an_exact_answer_is_refused():
    names = [f"n{i}" for i in range(60)]
    links = [Link(a, b, f"{a}-{b}") for a, b in itertools.combinations(names, 2)]
    with pytest.raises(StructureError, match="solve exactly"):
        Structure(Network("n0", "n59", links[:2000], {}))


def test_what_a_sure_way_passes_by_does_not_count():
    network = Network(
        "in", "out", [("in", "a"), ("a", "x"), ("in", "x"), ("x", "b"), ("b", "out")], {"a": "a", "b": "b"}
    )
    assert Structure(network).names == ("b",)
    assert reliability(network, {"a": 0.5, "b": 0.75}) == 0.75
