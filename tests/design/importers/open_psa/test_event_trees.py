"""Event trees, alignments and substitutions: printed figures, closed forms, and the sum over all states."""

import itertools
import random
from xml.sax.saxutils import escape

import pytest

from robophm.core.errors import DesignError
from robophm.design.importers.open_psa import event_trees, load, load_all

from ....cases import each_case, examples


@pytest.fixture
def answers(tmp_path):
    def read(text, time=None, top=None):
        path = tmp_path / "model.xml"
        path.write_text(f"<opsa-mef>{text}</opsa-mef>")
        return {one.name: one.probability() for one in load_all(path, time, top)}

    return read


def basic(**chances):
    inside = "".join(
        f'<define-basic-event name="{n}"><float value="{p}"/></define-basic-event>' for n, p in chances.items()
    )
    return f"<model-data>{inside}</model-data>"


def functional(*names):
    return "".join(f'<define-functional-event name="{name}"/>' for name in names)


def sequences(*names):
    return "".join(f'<define-sequence name="{name}"/>' for name in names)


def tree(inside, name="T"):
    begins = '<define-initiating-event name="I" event-tree="T"/>'
    return f'{begins}<define-event-tree name="{name}">{inside}</define-event-tree>'


def fork(event, **paths):
    states = "".join(f'<path state="{state}">{inside}</path>' for state, inside in paths.items())
    return f'<fork functional-event="{event}">{states}</fork>'


def collect(formula):
    return f"<collect-formula>{formula}</collect-formula>"


def chance(value):
    return f'<collect-expression><float value="{value}"/></collect-expression>'


def gate(name):
    return f'<gate name="{name}"/>'


def to(sequence):
    return f'<sequence name="{sequence}"/>'


def initial(inside):
    return f"<initial-state>{inside}</initial-state>"


GAS_LEAK = [0.81044, 0.04479, 0.04265, 2.36e-3, 0.04265, 2.36e-3, 4.5e-3, 0.05025]
"""Sequences of works and fails of isolation valve A, B and the blowdown valve: Andrews and Dunnett, "Event-tree
analysis using binary decision diagrams", IEEE Trans. Reliability 49 (2000), each event of 0.05; as SCRAM's tests print
them."""


def test_the_gas_leak_of_andrews_and_dunnett(answers):
    def valve(own, pair):
        events = "".join(f'<basic-event name="{name}"/>' for name in (own, "relay"))
        both = "".join(f'<basic-event name="{name}"/>' for name in pair)
        return f'<define-gate name="{own}-fails"><or>{events}<and>{both}</and></or></define-gate>'

    numbers = iter(range(1, 9))
    valves = ("valve-A", "valve-B", "blowdown")

    def after(number):
        if number == len(valves):
            return to(f"S{next(numbers)}")
        fails = gate(f"{valves[number]}-fails")
        works = collect(f"<not>{fails}</not>") + after(number + 1)
        return fork(valves[number], works=works, fails=collect(fails) + after(number + 1))

    solenoids = ("sol-A", "sol-B"), ("sol-A", "sol-B"), ("sol-C", "sol-D")
    gates = "".join(map(valve, valves, solenoids))
    said = tree(functional(*valves) + sequences(*(f"S{i}" for i in range(1, 9))) + initial(after(0)))
    events = (*valves, "relay", "sol-A", "sol-B", "sol-C", "sol-D")
    text = f'{said}<define-fault-tree name="F">{gates}</define-fault-tree>{basic(**dict.fromkeys(events, 0.05))}'
    found = answers(text)
    assert [found[f"I: S{i}"] for i in range(1, 9)] == pytest.approx(GAS_LEAK, abs=1e-5)
    assert sum(found[f"I: S{i}"] for i in range(1, 9)) == pytest.approx(1, rel=1e-12)
    assert found["valve-A-fails"] == pytest.approx(1 - 0.95**2 * (1 - 0.05**2), rel=1e-12)
    assert answers(text, top="S3") == {"I: S3": found["I: S3"]}


def test_expressions_alone(answers):
    """Two of three detections fail one after the other: SCRAM's tests print 0.772 for what succeeds."""
    inside = fork(
        "L1", yes=chance(0.2) + to("fails"),
        no=chance(0.8) + fork("L2", no=chance(0.3) + to("succeeds"), yes=chance(0.7) + fork(
            "L3", yes=chance(0.05) + to("fails"), no=chance(0.95) + to("succeeds"))),
    )  # fmt: skip
    found = answers(tree(functional("L1", "L2", "L3") + sequences("succeeds", "fails") + initial(inside)))
    assert found == pytest.approx({"I: succeeds": 0.772, "I: fails": 0.228}, rel=1e-12)


def random_formula(draw, events, houses, depth=0):
    """A formula, and what it is where these events and houses are true."""
    kind = draw.choice(["event", "house", "and", "or", "not", "xor"] if depth < 3 else ["event", "house"])
    if kind == "event":
        name = draw.choice(events)
        return f'<basic-event name="{name}"/>', lambda true, houses: true[name]
    if kind == "house":
        name = draw.choice(houses)
        return f'<house-event name="{name}"/>', lambda true, houses: houses[name]
    inputs = [
        random_formula(draw, events, houses, depth + 1) for _ in range(1 if kind == "not" else draw.randint(2, 3))
    ]
    text = "".join(one for one, _ in inputs)
    rules = {"and": all, "or": any, "not": lambda xs: not xs[0], "xor": lambda xs: sum(xs) % 2 == 1}
    return f"<{kind}>{text}</{kind}>", lambda true, houses: rules[kind]([rule(true, houses) for _, rule in inputs])


@each_case("seed", range(examples(60)))
def test_random_trees_are_the_sum_over_all_states(answers, seed):
    """Forks that collect formulas, set houses and test states, in random order, over shared events."""
    draw = random.Random(seed)
    events, houses, ends = list("abcde"), list("gh"), ["S1", "S2", "S3"]
    order = ["F1", "F2", "F3"]
    ways = []  # of each: the sequence, and (formula, houses then)

    def instructions(way, set_, states):
        text = ""
        for _ in range(draw.randint(0, 3)):
            kind = draw.choice(["collect", "set", "if"])
            if kind == "set":
                name, state = draw.choice(houses), draw.random() < 0.5
                set_ = {**set_, name: state}
                text += f'<set-house-event name="{name}"><constant value="{str(state).lower()}"/></set-house-event>'
                continue
            formula, rule = random_formula(draw, events, houses)
            condition = ""
            if kind == "if":
                name, state = draw.choice(order), draw.choice("xy")
                condition = f'<test-functional-event name="{name}" state="{state}"/>'
            if kind == "collect" or states.get(name) == state:
                way = [*way, (rule, set_)]
            text += f"<if>{condition}{collect(formula)}</if>" if condition else collect(formula)
        return text, way, set_

    def branch(number, way, set_, states):
        text, way, set_ = instructions(way, set_, states)
        if number == len(order) or draw.random() < 0.2:
            end = draw.choice(ends)
            ways.append((end, way))
            return text + to(end)
        name = order[number]
        paths = {state: branch(number + 1, way, set_, {**states, name: state}) for state in "xy"}
        return text + fork(name, **paths)

    inside = functional(*order) + sequences(*ends) + initial(branch(0, [], {}, {}))
    chances = {name: draw.choice([0.1, 0.3, 0.5, 0.8]) for name in events}
    initially = {name: draw.random() < 0.5 for name in houses}
    data = "".join(
        f'<define-house-event name="{name}"><constant value="{str(state).lower()}"/></define-house-event>'
        for name, state in initially.items()
    )
    expected = dict.fromkeys((f"I: {end}" for end, _ in ways), 0.0)
    for states in itertools.product([False, True], repeat=len(events)):
        true = dict(zip(events, states, strict=True))
        weight = 1.0
        for name, state in true.items():
            weight *= chances[name] if state else 1 - chances[name]
        for end in {end for end, way in ways if all(rule(true, {**initially, **set_}) for rule, set_ in way)}:
            expected[f"I: {end}"] += weight
    found = answers(tree(inside) + basic(**chances) + f"<model-data>{data}</model-data>")
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_rules_branches_blocks_and_links(answers):
    """A linked tree goes on with what was collected and set, and without the states; a rule is what it says."""
    first = (
        functional("F") + sequences("S") + '<define-sequence name="on"><event-tree name="U"/></define-sequence>'
        '<define-branch name="B"><rule name="R"/><sequence name="on"/></define-branch>'
        + initial(fork("F", x='<branch name="B"/>', y=collect('<not><basic-event name="a"/></not>') + to("S")))
    )  # fmt: skip
    second = (
        functional("F") + sequences("V", "W") + initial(
            '<if><test-functional-event name="F" state="x"/>' + collect('<constant value="false"/>') + "</if>"
            + fork("F", x=collect('<house-event name="h"/>') + collect('<basic-event name="b"/>') + to("V"),
                   y=collect('<not><basic-event name="b"/></not>') + to("W")))
    )  # fmt: skip
    rule = (
        '<define-rule name="R"><block><collect-formula><basic-event name="a"/></collect-formula>'
        '<set-house-event name="h"><constant value="true"/></set-house-event></block></define-rule>'
    )
    text = (
        tree(first) + f'<define-event-tree name="U">{second}</define-event-tree>' + rule + basic(a=0.1, b=0.3)
        + '<model-data><define-house-event name="h"/></model-data>'
    )  # fmt: skip
    assert answers(text) == pytest.approx({"I: S": 0.9, "I: V": 0.03, "I: W": 0.07}, rel=1e-12)


TREE = '<define-fault-tree name="F"><define-gate name="top">{}</define-gate></define-fault-tree>'


def test_each_phase_of_an_alignment(answers):
    """In its share of the mission time and with its house events."""
    timed = '<exponential><float value="1e-3"/><system-mission-time/></exponential>'
    text = (
        TREE.format('<and><basic-event name="a"/><not><house-event name="h"/></not></and>')
        + f'<model-data><define-basic-event name="a">{timed}</define-basic-event><define-house-event name="h"/>'
        "</model-data>"
        '<define-alignment name="A"><define-phase name="run" time-fraction="0.75"/><define-phase name="rest" '
        'time-fraction="0.25"><set-house-event name="h"><constant value="true"/></set-house-event></define-phase>'
        "</define-alignment>"
    )
    found = answers(text, 1000)
    assert found == pytest.approx(
        {"top (run, 0.75 of the time)": 0.5276334472589853, "top (rest, 0.25 of the time)": 0}
    )


def two_trains(substitutions):
    """SCRAM's Two Train model: valves of 0.5 and pumps of 0.7, one of each in two trains of which one is enough."""
    train = '<or><basic-event name="valve{0}"/><basic-event name="pump{0}"/></or>'
    data = basic(valve1=0.5, valve2=0.5, valve3=0.55, pump1=0.7, pump2=0.7, hot=0.7, cold=0.9)
    return TREE.format(f"<and>{train.format(1)}{train.format(2)}</and>") + data + substitutions


def both(*names):
    return "<and>" + "".join(f'<basic-event name="{name}"/>' for name in names) + "</and>"


def substitution(name, hypothesis, target, source=(), kind=""):
    inside = "".join(f'<basic-event name="{one}"/>' for one in source)
    return (
        f'<define-substitution name="{name}"{kind and f" type={chr(34)}{kind}{chr(34)}"}><hypothesis>{hypothesis}'
        f"</hypothesis>{inside and f'<source>{inside}</source>'}<target>{target}</target></define-substitution>"
    )


def test_declared_substitutions(answers):
    """SCRAM's tests print 0.329175."""
    found = answers(two_trains(
        substitution("exclusive", both("valve1", "valve2"), '<constant value="false"/>', kind="delete-terms")
        + substitution("recover", both("pump1", "pump2"), '<basic-event name="hot"/>', kind="recovery-rule")
        + substitution("start", '<basic-event name="hot"/>', '<basic-event name="cold"/>')
    ))  # fmt: skip
    assert found == pytest.approx({"top": 0.329175}, rel=1e-12)


def test_exchanged_events(answers, tmp_path):
    """The sets that SCRAM's tests print, and their union summed over all states."""
    text = two_trains(
        substitution("exchange", both("valve1", "valve2"), '<basic-event name="valve3"/>', ["valve2"], "exchange-event")
        + substitution("recover", both("pump1", "pump2"), '<basic-event name="hot"/>', ["pump1", "pump2"])
    )
    found = answers(text)["top"]
    model = load(tmp_path / "model.xml")
    assert model.exchanged
    sets = {frozenset(one.names) for one in model.top_event().cut_sets(20).sets}
    expected = [{"valve1", "pump2"}, {"valve2", "pump1"}, {"valve1", "valve3"}, {"hot"}]
    assert sets == set(map(frozenset, expected))
    chances = {"valve1": 0.5, "valve2": 0.5, "valve3": 0.55, "pump1": 0.7, "pump2": 0.7, "hot": 0.7}
    total = 0.0
    for states in itertools.product([False, True], repeat=len(chances)):
        true = {name for name, state in zip(chances, states, strict=True) if state}
        weight = 1.0
        for name, p in chances.items():
            weight *= p if name in true else 1 - p
        total += weight * any(one <= true for one in expected)
    assert found == pytest.approx(total, rel=1e-12)


S = sequences("S") + initial(to("S"))
TRUE = '<constant value="true"/>'
PHASE = '<define-alignment name="A"><define-phase name="P" time-fraction="{}"/></define-alignment>'
WRONG = {
    "is not defined": [
        '<define-initiating-event name="I" event-tree="U"/>' + f'<define-event-tree name="T">{S}</define-event-tree>',
        tree(sequences("S") + initial(to("Z"))),
        tree(sequences("S") + initial('<branch name="B"/>')),
        tree(sequences("S") + initial(fork("F", x=to("S")))),
        tree(sequences("S") + initial('<rule name="R"/>' + to("S"))),
        tree(sequences("S") + initial(f'<set-house-event name="h">{TRUE}</set-house-event>' + to("S"))),
        tree('<define-sequence name="S"><event-tree name="U"/></define-sequence>' + initial(to("S"))),
        tree(sequences("S") + initial(collect('<basic-event name="z"/>') + to("S"))),
    ],
    "defined twice": [
        tree(S) + tree(S, "T"),
        tree(S) + '<define-initiating-event name="I"/>',
        tree(sequences("S", "S") + initial(to("S"))),
        tree(functional("F", "F") + S),
        2 * '<define-rule name="R"/>' + tree(S),
    ],
    "loop": [
        tree(sequences("S") + '<define-branch name="B"><branch name="B"/></define-branch>' + initial(to("S"))),
        tree('<define-sequence name="S"><event-tree name="T"/></define-sequence>' + initial(to("S"))),
        tree(S) + '<define-rule name="R"><rule name="R"/></define-rule>',
    ],
    "order of their definitions": [
        tree(functional("F", "G") + sequences("S") + initial(fork("G", x=fork("F", x=to("S"))))),
        tree(functional("F") + sequences("S") + initial(fork("F", x=fork("F", x=to("S"))))),
    ],
    "expected that in a sequence": [tree(sequences("S") + initial('<event-tree name="T"/>' + to("S")))],
    "collects formulas and expressions": [
        tree(functional("F") + sequences("S") + initial(
            fork("F", x=collect('<constant value="true"/>') + to("S"), y=chance(0.5) + to("S"))))
    ],
    "leads nowhere": [tree(sequences("S") + initial(chance(0.5)))],
    "expected paths": [
        tree(functional("F") + sequences("S")
             + initial('<fork functional-event="F"><path>' + to("S") + "</path></fork>"))
    ],
    "expected 0 … 1": [tree(sequences("S") + initial(chance(1.5) + to("S")))],
    "ends without an initial-state": [tree(sequences("S"))],
    "do not add up to 1": [PHASE.format(0.5)],
    "at most 1": [PHASE.format(1.5)],
    "has no effect": [two_trains(substitution("x", both("pump1"), '<constant value="true"/>'))],
    "comes first would matter": [
        two_trains(substitution("x", both("pump1"), '<basic-event name="hot"/>', ["pump2"])
                   + substitution("y", both("hot"), '<basic-event name="cold"/>', ["valve1"]))
    ],
    "'B' is not defined": [
        f'<define-event-tree name="T">{sequences("S")}{initial(collect(gate("B")) + to("S"))}</define-event-tree>'
    ],
    "is not taken": ['<define-extern-library name="x" path="y"/>'],
}  # fmt: skip


@each_case(("message", "text"), [(message, text) for message, texts in WRONG.items() for text in texts])
def test_what_is_wrong_is_said_in_a_line(answers, message, text):
    with pytest.raises(DesignError, match=message) as caught:
        answers(text)
    assert "\n" not in str(caught.value)
    assert escape("model.xml") in str(caught.value)


def test_more_ways_than_can_be_gone_are_refused(answers, monkeypatch):
    """Ten forks of two states each."""
    monkeypatch.setattr(event_trees, "MOST_WAYS", 1000)
    names = [f"F{i}" for i in range(10)]
    inside = to("S")
    branches = ""
    for i, name in enumerate(reversed(names)):
        branches += f'<define-branch name="B{i}">{fork(name, x=inside, y=inside)}</define-branch>'
        inside = f'<branch name="B{i}"/>'
    with pytest.raises(DesignError, match="more than 1,000 ways"):
        answers(tree(functional(*names) + sequences("S") + branches + initial(inside)))


@each_case("text", [
    tree(sequences("S") + "".join(f'<define-branch name="B{i}"><branch name="B{i + 1}"/></define-branch>'
                                  for i in range(500)) + initial('<branch name="B0"/>')),
    tree(S) + "".join(f'<define-rule name="R{i}"><rule name="R{i + 1}"/></define-rule>' for i in range(500)),
])  # fmt: skip
def test_what_is_nested_too_deeply_is_refused(answers, text):
    with pytest.raises(DesignError, match="is within more than 100 forks"):
        answers(text)
