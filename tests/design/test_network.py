"""Networks in a design file against the diagrams of their paths."""

import numpy as np
import pytest

from robophm.blocks import diagram as blocks
from robophm.blocks.reliability import Structure
from robophm.design.file import parse
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

NETWORK = """
schema_version: 1
name: R
components:
  feed: {rate: 1e-3 /h}
  spare: {rate: 2e-3 /h}
  left: {rate: 3e-3 /h}
  right: {rate: 4e-3 /h, quantity: 2, required: 1}
  cable: {rate: 5e-3 /h}
diagram:
  network:
    from: in
    to: out
    junctions: [a, b]
    links: [[in, feed, a, left, out], [in, spare, b, "right", out], {between: [a, b], through: cable}]
"""


def test_a_network_is_the_union_of_its_paths():
    network = parse(NETWORK).diagram
    right = blocks.Parallel("right[1]", "right[2]")
    paths = blocks.Parallel(
        blocks.Series("feed", "left"),
        blocks.Series("spare", right),
        blocks.Series("feed", "cable", right),
        blocks.Series("spare", "cable", "left"),
    )
    found, expected = Structure(network), Structure(paths)
    works = {"feed": 0.9, "spare": 0.8, "left": 0.7, "right[1]": 0.6, "right[2]": 0.65, "cable": 0.5}

    def reliability(structure: Structure) -> float:
        p = np.array([works[name] for name in structure.names])
        return float(structure.state(p, 1 - p).works)

    assert set(found.names) == set(works)
    assert reliability(found) == pytest.approx(reliability(expected), rel=1e-14)


def test_a_one_way_link_is_no_way_back():
    one_way = NETWORK.replace("between: [a, b]", "from: a, to: b")
    paths = blocks.Parallel(
        blocks.Series("feed", "left"),
        blocks.Series(
            blocks.Parallel("spare", blocks.Series("feed", "cable")), blocks.Parallel("right[1]", "right[2]")
        ),
    )
    p = np.array([0.9, 0.7, 0.8, 0.6, 0.65, 0.5])
    order = ["feed", "left", "spare", "right[1]", "right[2]", "cable"]
    found, expected = Structure(parse(one_way).diagram), Structure(paths)
    a = p[[order.index(name) for name in found.names]]
    b = p[[order.index(name) for name in expected.names]]
    assert float(found.state(a, 1 - a).works) == pytest.approx(float(expected.state(b, 1 - b).works), rel=1e-14)


def test_parts_named_in_links_alone_are_told_apart():
    """Equal parts all of which must work are one unit, unless something names one of them."""
    apart = NETWORK.replace(", required: 1", "").replace('"right"', '"right[2]"')
    assert set(Structure(parse(apart).diagram).names) == {"feed", "spare", "left", "right[2]", "cable"}


def test_a_group_a_common_cause_and_dependence_in_a_network():
    """A standby pair as a link, nodes that may fail together, and a node that hangs on a part; cut by cut by hand."""
    text = NETWORK.replace("through: cable", "through: {standby: {of: [cable, second]}}")
    text = text.replace(
        "  cable: {rate: 5e-3 /h}",
        """\
  cable: {rate: 5e-3 /h}
  second: {rate: 5e-3 /h}
  supply: {rate: 6e-3 /h}""",
    )
    text = text.replace("left: {rate: 3e-3 /h}", "left: {rate: 3e-3 /h, depends_on: supply}")
    text = text.replace("spare: {rate: 2e-3 /h}", "spare: {rate: 1e-3 /h}")
    robot = parse(text + "common_causes: {flood: {of: [feed, spare], beta: 0.1}}\n")
    hours = 100.0
    p = {name: np.exp(-rate * hours) for name, rate in
         {"feed": 0.9e-3, "spare": 0.9e-3, "flood": 0.1e-3, "left": 3e-3, "supply": 6e-3}.items()}  # fmt: skip
    feed, spare = p["feed"], p["spare"]
    left, right = p["left"] * p["supply"], 1 - (1 - np.exp(-4e-3 * hours)) ** 2
    link = np.exp(-0.5) * (1 + 0.5)  # a cold pair: exp(-λt)(1 + λt)
    joined = (1 - (1 - feed) * (1 - spare)) * (1 - (1 - left) * (1 - right))
    parted = 1 - (1 - feed * left) * (1 - spare * right)
    expected = p["flood"] * (link * joined + (1 - link) * parted)
    found = as_designed(Plant(robot)).survival_curve(robot.diagram, np.array([hours]))
    assert float(found.works[0]) == pytest.approx(expected, rel=1e-12)
