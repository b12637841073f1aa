"""A file of the 2020 tool becomes a design: its parts and wiring, and every oddity said."""

import json
import random
import time
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from robophm.blocks.diagram import Parallel, Series, Unit
from robophm.core.errors import DesignError
from robophm.design.file import load
from robophm.design.importers.legacy.figures import legacy_rate, reliability_at
from robophm.design.importers.legacy.reading import import_legacy

DATA = Path(__file__).parents[3] / "data"
# Use-case guide of the 2020 tool, tables 15-17: λ [1/h] and R at 1000 h.
GUIDE = {
    "": (5.288326869051733e-4, 0.589292457145637),
    "Power": (4.62653527447025e-4, 0.6296107375618971),
    "Sensing": (8.238437533333333e-6, 0.9917954053917838),
    "Communication": (1.06245744208149e-5, 0.989431667013337),
    "Mobility": (4.7201147504e-5, 0.9538955045917938),
    "Computation": (1.15e-7, 0.9998850066122466),
}
CRYSTAL = 2.7e-7


@pytest.fixture(scope="module")
def ota():
    return import_legacy(DATA / "legacy_ota.yaml")


@pytest.fixture(scope="module")
def odd():
    return import_legacy(DATA / "legacy_odd.yaml")


@pytest.fixture
def made(tmp_path):
    """Import a System of that text."""

    def made(text):
        path = tmp_path / "old.yaml"
        path.write_text(text if "System" in text else f"System: {{{text}}}", encoding="utf-8")
        return import_legacy(path)

    return made


def leaves(data, above=()):
    """Path and rate of every mapping that is a part without parts, as a person reads the file."""
    keys = {"Configurations", "Failure Rate", "Final Configuration", "Reliability", "Elements", "Formula"}
    for name, value in data.items():
        if name not in keys:
            if value.keys() - keys:
                yield from leaves(value, (*above, name))
            else:
                yield "/".join((*above, name.replace("/", "-"))), value["Failure Rate"]


def test_every_rate_is_there(ota, tmp_path):
    """Written, loaded again, part by part as the file has it; and summed by hand."""
    source = YAML(typ="safe").load((DATA / "legacy_ota.yaml").read_text())["System"]
    (tmp_path / "robot.yaml").write_text(ota.text, encoding="utf-8")
    robot = load(tmp_path / "robot.yaml")
    assert {part.path: part.modes[0].rate for part in robot.all_components()} == dict(leaves(source))
    communication = next(module for module in robot.modules if module.path == "Communication")
    board = 2.45974988149e-08 + 2.7e-07 + 1.493442522e-06 + 3.2e-07 + 5.9e-07 + 2.4288e-06 + 4.0777344e-06 + 1.7e-07
    assert legacy_rate(communication) == pytest.approx(board + 2.3e-07 + 7.5e-07, rel=1e-12, abs=0)


@pytest.mark.parametrize("path", GUIDE)
def test_the_published_figures_come_out(ota, path):
    figure = next(figure for figure in ota.figures if figure.path == path)
    rate, works = GUIDE[path]
    assert figure.stored == pytest.approx(rate, rel=1e-14, abs=0)
    assert figure.recomputed == pytest.approx(rate, rel=2e-15, abs=0)
    assert reliability_at(1000 * 3600, figure.recomputed) == pytest.approx(works, rel=1e-14, abs=0)


def test_the_crystal_that_is_there_twice_counts_once(ota):
    assert [(finding.kind, finding.line) for finding in ota.findings if finding.kind != "renamed"] == [
        ("double use", 42)
    ]
    said = str(next(finding for finding in ota.findings if finding.kind == "double use"))
    assert said.startswith("line 42: Communication/DSK-M: s1 names '25MHz Cryst. Osc.' more than once")
    assert said.endswith("9.8746e-06 /h of it instead of 9.6046e-06 /h")
    assert f"        # {said.partition('DSK-M: ')[2]}" in ota.text.splitlines()
    assert ota.text.count("25MHz") == 2  # the remark, and the part
    board = next(module for module in ota.robot.all_modules() if module.path == "Communication/DSK-M")
    assert legacy_rate(board) == pytest.approx(9.8745744208149e-06 - CRYSTAL, rel=1e-14, abs=0)
    assert legacy_rate(ota.robot) == pytest.approx(GUIDE[""][0] - CRYSTAL, rel=1e-14, abs=0)


def test_the_wiring_is_the_files(ota):
    sensing = next(module for module in ota.robot.modules if module.path == "Sensing")
    assert sensing.wiring == Series(Parallel("Sensing/Camera", "Sensing/SICK"), "Sensing/IPS")
    computation = next(module for module in ota.robot.modules if module.path == "Computation")
    assert computation.modules[0].wiring == Series("Computation/YSK-G/NVIDIA JETSON TX2")
    assert computation.components[0].path == "Computation/YSK-M"  # a sub-module without parts is one


def test_heat_doubles_every_ten_kelvin(ota, tmp_path):
    bound = "  Power:\n    signals: {temperature: {topic: /t, field: temperature, unit: degC, range: [-40, 125]}}\n"
    lines = ota.text.splitlines(keepends=True)
    at = next(i for i, line in enumerate(lines) if line.startswith("  Power:"))
    path = tmp_path / "robot.yaml"
    path.write_text("".join([*lines[:at], bound, *lines[at + 1 :]]), encoding="utf-8")
    stress = load(path).modules[0].components[0].modes[0].stresses[0]
    assert float(stress.factor({"temperature": 45.0}).value) == pytest.approx(4, rel=1e-14, abs=0)
    assert stress.reference == 1


def test_every_oddity_is_said(odd):
    """By hand, of a file that was made to have them."""
    assert {(finding.kind, finding.line, finding.place) for finding in odd.findings} == {
        ("candidates", 2, "System"),
        ("ignored", 2, "System"),
        ("double use", 23, "Drive"),  # a motor twice in a group
        ("other rate", 23, "Drive"),  # 3.8e-5, not (2 + 3 + 2)e-5 / (11/6)
        ("unknown name", 14, "Drive/Board"),
        ("other rate", 14, "Drive/Board"),  # 7e-6, not 2/3 e-6 + 5e-6
        ("no rate", 12, "Drive/Board"),
        ("double use", 4, "Drive/Board"),  # a fuse in two groups
        ("renamed", 7, "Drive/Board/Relay [spare]"),
        ("unused", 7, "Drive/Board/Relay [spare]"),
        ("no rate", 8, "Drive/Board/Led"),
        ("renamed", 19, "Drive/Motor/2"),
        ("unknown name", 28, "Arm"),
        ("candidates", 28, "Arm"),
        ("no rate", 31, "Arm/Glove"),
        ("no rate", 39, "Lamp"),
        ("not wired", 44, "Radio"),
        ("unused", 44, "Radio"),
    }
    assert len(odd.findings) == 18
    for finding in odd.findings:
        assert f"# {finding.text}\n" in odd.text


def test_what_is_odd_is_not_repeated(odd):
    board = next(module for module in odd.robot.all_modules() if module.path == "Drive/Board")
    assert board.wiring == Series("Drive/Board/Fuse", "Drive/Board/Chip")
    assert legacy_rate(board) == pytest.approx(5e-6, rel=1e-14, abs=0)
    drive = odd.robot.modules[0]
    assert drive.wiring == Series("Drive/Board", Parallel("Drive/Motor", "Drive/Motor-2"))
    assert odd.robot.wiring == Series("Drive", "Arm")
    assert odd.robot.warnings == tuple(
        f"{path}: used in no diagram" for path in ("Drive/Board/Relay (spare)", "Radio/Receiver", "Radio/Sender")
    )
    figures = {figure.path: (figure.stored, figure.recomputed) for figure in odd.figures}
    assert figures["Drive"] == (4.5e-5, pytest.approx(7e-5 / (11 / 6) + 1e-6 / 1.5 + 5e-6, rel=1e-14, abs=0))
    assert figures["Arm"] == (3e-5, 3e-5)
    assert figures["Lamp"] == figures["Radio"] == (0, 0)
    assert odd.text.count("by the formula a*2 (not evaluated)") == 1


PART = "A: {Failure Rate: 1.0e-6}, B: {Failure Rate: 2.0e-6}"


@pytest.mark.parametrize(
    ("groups", "wiring"),
    [
        ("s1: {Type: Serial, Components: [A, B]}}, Final Configuration: s1", Series("A", "B")),
        ("p1: {Type: Parallel, Components: [A, B]}}, Final Configuration: p1", Series(Parallel("A", "B"))),
        ("p1: {Type: Parallel, Components: [A, B]}}", Series(Parallel("A", "B"))),
        ("}, Final Configuration: B", Series("B")),
        ("p1: {Type: Parallel, Components: [A, A]}}, Final Configuration: p1", Series("A")),
        ("s1: {Type: Serial, Components: [A, X]}, s2: {Type: Serial, Components: [s1, A, B]}}", Series("A", "B")),
        (
            "p1: {Type: Parallel, Components: [A, B]}, s2: {Type: Serial, Components: [p1, A]}}",
            Series(Parallel("A", "B"), "A"),
        ),
    ],
)
def test_wirings(made, groups, wiring):
    found = made(f"{PART}, Configurations: {{{groups}").robot.wiring
    assert found == (wiring if isinstance(found, Series) else wiring.blocks[0])


def test_a_group_goes_before_a_member_of_its_name(made):
    found = made(
        f"{PART}, p1: {{Failure Rate: 5.0e-6}}, Configurations: {{p1: {{Type: Parallel, Components: [A, B]}}}}"
    )
    assert found.robot.wiring == Parallel("A", "B")
    assert {finding.kind for finding in found.findings} == {"ignored", "not wired", "unused"}


def test_a_level_whose_parts_have_no_rate_is_one_part(made):
    found = made(
        "M: {S: {C: {Failure Rate: 0.0}, D: {Failure Rate: None}, Failure Rate: 5.0e-6}, Final Configuration: S}"
    )
    assert [(part.path, part.modes[0].rate) for part in found.robot.all_components()] == [("M/S", 5e-6)]
    assert [finding.place for finding in found.findings if finding.kind == "no rate"] == ["M/S", "M/S/C", "M/S/D"]


def test_names_that_become_alike_stay_apart(made):
    names = ["a/b", "a-b", "a[b", "a-b 2", "a/b ", " "]
    found = made(", ".join(f"'{name}': {{Failure Rate: {i}.0e-6}}" for i, name in enumerate(names, 1)))
    assert {part.path: part.modes[0].rate for part in found.robot.components} == {
        "a-b 3": 1e-6, "a-b": 2e-6, "a(b": 3e-6, "a-b 2": 4e-6, "a-b 4": 5e-6, "unnamed": 6e-6,
    }  # fmt: skip


@pytest.mark.parametrize(
    "name",
    [
        "true",
        "null",
        "1e5",
        "- x",
        "a: b",
        "# a",
        "'",
        '\\"',
        "\\e[31mred",
        "{a}",
        "a\\nname: b",
        "é",
        "\\x85",
        "\\u2028",
        "\\ufffe",
        "\\U0001f916",
        "x" * 1000,
    ],
)
def test_no_name_breaks_the_design(made, name):
    found = made(f'"{name}": {{Failure Rate: 1.0e-6}}, B: {{"{name}": {{Failure Rate: 2.0e-6}}}}')
    assert [part.modes[0].rate for part in found.robot.all_components()] == [2e-6, 1e-6]
    assert "\x1b" not in found.text


def test_half_a_character_is_refused(made):
    with pytest.raises(DesignError, match=r"old\.yaml:1: System: .* is no text; expected whole characters"):
        made('"\\ud800": {Failure Rate: 1.0e-6}')


@pytest.mark.parametrize(
    "name", ["back\\slash", 'a "quote"', "it's", "true", "1e5", "- x", "a: b", "# a", "{a}", "é", "~"]
)
def test_a_name_that_a_design_may_have_stays(made, name):
    found = made(f"{json.dumps(name)}: {{Failure Rate: 1.0e-6}}, B: {{Failure Rate: 2.0e-6}}, Final Configuration: B")
    assert [part.path for part in found.robot.components] == [name, "B"]
    assert [finding.kind for finding in found.findings] == ["unused"]


def test_a_formula_is_read_and_not_run(made, tmp_path):
    mark = tmp_path / "ran"
    formula = f"open('{mark}', 'w').close() or 1\\nname: other"
    found = made(f'M: {{S: {{C: {{Failure Rate: 1.0e-6, Formula: "{formula}"}}}}}}')
    assert "not evaluated" in found.text
    assert found.robot.name == "old"
    assert not mark.exists()


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("[1, 2]", 0, "has no 'System'"),
        ("just words", 0, "has no 'System'"),
        ("", 0, "has no 'System'"),
        ("Sistem: {}", 0, "it has 'Sistem'"),
        ("System: 3", 1, "System: 3 is not the system"),
        ("System: {}", 0, "no part with a rate"),
        ("System:\n  A: {Failure Rate: 0}", 0, "no part with a rate"),
        ("System:\n  A:\n    Failure Rate: abc", 3, "A/Failure Rate: 'abc' is not a rate per hour"),
        ("System:\n  A: {Failure Rate: -1.0e-6}", 2, "-1e-06 is not a rate"),
        ("System:\n  A: {Failure Rate: .nan}", 2, "nan is not a rate"),
        ("System:\n  A: {Failure Rate: 1.0e+300}", 2, "is not a rate"),
        ("System:\n  A: {Failure Rate: true}", 2, "True is not a rate"),
        ("System:\n  A: {Failure Rate: [1]}", 2, "is not a rate"),
        ("System:\n  A: {Failure Rate: {Nominal: x}}", 2, "A/Failure Rate/Nominal: 'x' is not"),
        ("System:\n  A: 1.0e-6", 2, "1e-06 is not a module with its 'Failure Rate'"),
        ("System:\n  M:\n    Elements: {Failure Rate: 1.0e-6}", 3, "a part named 'Elements'"),
        (
            "System:\n  M:\n    S:\n      Failure Rate: {Elements: {}, Failure Rate: 1.0e-6}",
            4,
            "a part named 'Failure R",
        ),
        ("System:\n  A: {Failure Rate: 1}\n  A: {Failure Rate: 2}", 3, "duplicate name 'A'"),
        (f"System:\n  {{{PART}, Configurations: {{s1: {{Type: Round, Components: [A]}}}}}}", 2, "'Round' is no type"),
        (f"System:\n  {{{PART}, Configurations: {{s1: {{Type: Serial, Components: A}}}}}}", 2, "a list of names"),
        (f"System:\n  {{{PART}, Configurations: {{s1: {{Type: Serial}}}}}}", 2, "a list of names"),
        (f"System:\n  {{{PART}, Configurations: [s1]}}", 2, "is not the groups of a level"),
        (f"System:\n  {{{PART}, Final Configuration: [A]}}", 2, "the name of a group"),
        (
            f"System:\n  {{{PART}, Configurations: {{s1: {{Type: Serial, Components: [s2]}},\n"
            "  s2: {Type: Serial, Components: [A, s1]}}}",
            2,
            "cycle: s1 → s2 → s1",
        ),
        ("System:\n  A: &a {Failure Rate: 1}\n  B: *a", 3, "alias '*a' is not taken"),
        ("System:\n  A: !!python/object:os.system {}", 2, "tag"),
        ("System:\n  A: {Failure Rate", 2, "is not YAML"),
    ],
)
def test_what_is_no_such_file(tmp_path, text, line, says):
    path = tmp_path / "old.yaml"
    path.write_text(text)
    with pytest.raises(DesignError) as caught:
        import_legacy(path)
    said = str(caught.value)
    assert said.startswith(f"{path}:{line}: " if line else f"{path}: ")
    assert says in said
    assert len(said.splitlines()) == 1


def nested(count):
    """Groups in groups, serial and parallel in turn."""
    groups = ["p0: {Type: Parallel, Components: [A, B]}"]
    for i in range(1, count):
        kind, below = ("Serial", "Parallel")[i % 2], f"g{i - 1}" if i > 1 else "p0"
        groups.append(f"g{i}: {{Type: {kind}, Components: [{below}, B]}}")
    return f"{PART}, Configurations: {{{', '.join(groups)}}}, Final Configuration: g{count - 1}"


def shared_groups(count):
    """Groups that are each in two others: as many paths as Fibonacci's numbers."""
    groups = ["g0: {Type: Parallel, Components: [A, B]}", "g1: {Type: Serial, Components: [g0, A]}"]
    for i in range(2, count):
        kind = ("Parallel", "Serial")[i % 2]
        groups.append(f"g{i}: {{Type: {kind}, Components: [g{i - 1}, g{i - 2}]}}")
    return f"{PART}, Configurations: {{{', '.join(groups)}}}, Final Configuration: g{count - 1}"


def test_groups_nest_so_far(made):
    assert isinstance(made(nested(40)).robot.wiring, Parallel | Series)
    with pytest.raises(DesignError, match="nested more than 40 deep"):
        made(nested(41))
    with pytest.raises(DesignError, match="nested more than 40 deep"):
        made(nested(2000))


@pytest.mark.full
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("System: " + "[" * 1500, "nested too deeply"),
        ("System: " + "{a: " * 2000 + "}" * 2000, "nested too deeply"),
        ("a: &a [1, 1]\n" + "".join(f"b{i}: &b{i} [*a, *a]\n" for i in range(40)) + "System: {}", "alias '*a'"),
        (f"System: {{{shared_groups(38)}}}", "unfolds to more than 100,000 blocks"),
    ],
    ids=["lists", "mappings", "aliases", "groups"],
)
def test_what_would_take_for_ever(made, text, says):
    began = time.process_time()
    with pytest.raises(DesignError) as caught:
        made(text)
    assert says in str(caught.value)
    assert time.process_time() - began < 20


@pytest.mark.parametrize("size", [1_500_000, 100_000_000])
def test_too_large_a_file_is_not_parsed(tmp_path, size):
    path = tmp_path / "old.yaml"
    with path.open("wb") as stream:
        stream.write(b"System: {A: {Failure Rate: 1.0e-6}}\n#")
        for _ in range(size // 500_000):
            stream.write(b" " * 500_000)
    began = time.process_time()
    with pytest.raises(DesignError, match=r"more than"):
        import_legacy(path)
    assert time.process_time() - began < 10


def level_of(chance, depth):
    """A level at random, wired without double use and zeros, and its rate by that tool's rule."""
    data, rates = {}, {}
    for i in range(chance.randint(1, 4)):
        if depth < 2 and chance.random() < 0.6:
            data[f"m{i}"], rates[f"m{i}"] = level_of(chance, depth + 1)
        else:
            rates[f"m{i}"] = chance.uniform(1e-7, 1e-4)
            data[f"m{i}"] = {"Failure Rate": rates[f"m{i}"]}
    groups, free = {}, sorted(rates)
    while len(free) > 1:
        chance.shuffle(free)
        count = chance.randint(2, len(free))
        items, free = free[:count], free[count:]
        name, serial = f"g{len(groups)}", chance.random() < 0.5
        harmonic = 1 if serial else sum(1 / n for n in range(1, count + 1))
        rates[name] = sum(rates[item] for item in items) / harmonic
        groups[name] = {
            "Components": items,
            "Type": "Serial" if serial else "Parallel",
            "Failure Rate": rates[name],
        }
        free.append(name)
    rate = {"Nominal": rates[free[0]]} if depth < 2 else rates[free[0]]
    return {**data, "Configurations": groups, "Final Configuration": free[0], "Failure Rate": rate}, rates[free[0]]


@pytest.mark.parametrize("seed", range(25))
def test_a_sound_file_keeps_its_figure(made, seed):
    """Series, parallel and levels at random: nothing to find, and that tool's roll-up of our design is its own."""
    data, rate = level_of(random.Random(seed), 0)
    found = made(json.dumps({"System": data}))
    assert found.findings == ()
    assert found.figures[0].recomputed == pytest.approx(rate, rel=1e-12, abs=0)
    assert legacy_rate(found.robot) == pytest.approx(rate, rel=1e-12, abs=0)
    assert found.robot.warnings == ()


def test_a_unit_alone_is_drawn(made):
    assert isinstance(made("A: {Failure Rate: 1.0e-6}").robot.wiring, Series | Unit)
