"""What depends on what, and what fails together, as the design says it; and what is wrong with it."""

import re

import pytest

from robophm.blocks.diagram import KOutOfN, Parallel, Series, Unit
from robophm.core.errors import DesignError
from robophm.design.file import parse

HEAD = "schema_version: 1\nname: R\n"
TWO = HEAD + "components:\n  A: {rate: 1 FIT}\n  B: {rate: 1 FIT}\n"
THREE = HEAD + "components:\n  A: {rate: 1 FIT, quantity: 3}\n  B: {rate: 1 FIT}\n"


def group(text, head=TWO):
    return f"{head}common_causes:\n  heat: {{{text}}}\n"


def needs(text):
    return f"{HEAD}components:\n  A: {{rate: 1 FIT, depends_on: {text}}}\n  Board: {{rate: 1 FIT}}\n"


def chain(count):
    parts = [f"  A{i}: {{rate: 1 FIT, depends_on: A{i + 1}}}\n" for i in range(count)]
    return f"{HEAD}components:\n{''.join(parts)}  A{count}: {{rate: 1 FIT}}\n"


LADDER = HEAD + "components:\n  Z: {rate: 1 FIT}\n"  # each step needs two, and they both of the next: 2^22 in all
LADDER += "".join(f"  A{i}: {{rate: 1 FIT, depends_on: [A{i + 2 - i % 2}, A{i + 3 - i % 2}]}}\n" for i in range(44))
LADDER += "  A44: {rate: 1 FIT}\n  A45: {rate: 1 FIT}\n"

FAULTS = {
    "unknown member": (group("of: [A, X], beta: 0.1"), 7, "common_causes/heat/of/1: unknown part 'X'"),
    "member twice": (group("of: [B, A, B], beta: 0.1"), 7, "common_causes/heat/of/2: B is there twice; expected each"),
    "one member": (group("of: [A], beta: 0.1"), 7, "common_causes/heat: 1 part; expected at least two"),
    "no member": (group("of: [], beta: 0.1"), 7, "common_causes/heat/of: is empty; expected at least one"),
    "beta of one": (group("of: [A, B], beta: 1"), 7, "common_causes/heat/beta: expected less than 1, not 1"),
    "negative beta": (group("of: [A, B], beta: -1"), 7, "common_causes/heat/beta: expected greater than or equal to 0"),
    "beta is no number": (group("of: [A, B], beta: .nan"), 7, "common_causes/heat/beta: expected a finite number"),
    "no model": (group("of: [A, B]"), 7, "common_causes/heat: expected exactly one of beta, mgl, alpha"),
    "two models": (group("of: [A, B], beta: 0.1, mgl: [0.1]"), 7, "common_causes/heat: expected exactly one of beta"),
    "testing of beta": (group("of: [A, B], beta: 0.1, testing: staggered"), 7, "common_causes/heat: testing is of"),
    "misspelt key": (group("of: [A, B], bta: 0.1"), 7, "common_causes/heat/bta: unknown key 'bta'; did you mean 'beta"),
    "too many letters": (group("of: [A, B], mgl: [0.1, 0.2]"), 7, "common_causes/heat: mgl has 2 letters for 2 parts"),
    "alpha of three for two": (group("of: [A, B], alpha: [0.9, 0.06, 0.04]"), 7, "common_causes/heat: alpha has 3"),
    "alpha too much": (
        group("of: [A, B], alpha: [0.9, 0.2]"),
        7,
        "common_causes/heat: alpha adds up to 1.1; expected 1",
    ),
    "another rate": (
        group("of: [A, B], beta: 0.1", TWO.replace("B: {rate: 1", "B: {rate: 2")),
        7,
        "common_causes/heat/of/1: B is not like A: its rate differs; expected parts all alike",
    ),
    "another life": (
        group("of: [A, B], beta: 0.1", TWO.replace("T}\n  B", "T, life: {distribution: rayleigh}}\n  B")),
        7,
        "common_causes/heat/of/1: B is not like A: its life differs",
    ),
    "another clock": (
        group("of: [A, B], beta: 0.1", TWO.replace("T}\n  B", "T, clock: calendar}\n  B")),
        7,
        "common_causes/heat/of/1: B is not like A: its clock differs",
    ),
    "name of a part": (
        TWO + "common_causes:\n  A: {of: [A, B], beta: 0.1}\n",
        7,
        "common_causes/A: duplicate name 'A': a part has it too",
    ),
    "two groups": (
        group("of: [A, B], beta: 0.1") + "  software: {of: [A, B], beta: 0.1}\n",
        8,
        "common_causes/software/of/0: A is in another group of common causes too",
    ),
    "some of a quantity": (
        group("of: ['A[1]', 'A[2]'], beta: 0.1", THREE),
        7,
        "common_causes/heat/of/0: 2 of the 3 equal parts of A; expected all of them",
    ),
    "none of a quantity": (group("of: ['A[4]', B], beta: 0.1", THREE), 7, "common_causes/heat/of/0: 'A[4]': A has qua"),
    "nine of which any fail": (
        group(f"of: [A], mgl: {[0.5] * 8}", THREE.replace("3", "9")),
        7,
        "common_causes/heat: 9 parts; expected at most 8",
    ),
    "a module fails together": (
        group("of: [A, M], beta: 0.1", TWO + "modules:\n  M: {components: {X: {rate: 1 FIT}}}\n"),
        9,
        "common_causes/heat/of/1: 'M' is a module; expected a part",
    ),
    "on itself": (needs("A"), 4, "components/A/depends_on: cycle: A → A depends on itself"),
    "in a circle": (
        needs("Board").replace("Board: {rate: 1 FIT}", "Board: {rate: 1 FIT, depends_on: A}"),
        5,
        "components/Board/depends_on: cycle: A → Board → A depends on itself",
    ),
    "on what it is in": (
        HEAD + "modules:\n  M: {components: {A: {rate: 1 FIT, depends_on: /M}}}\n",
        4,
        "modules/M/components/A/depends_on: cycle: M → M/A → M contains itself",
    ),
    "on what needs the module around": (
        HEAD + "modules:\n  M: {depends_on: M/A, components: {A: {rate: 1 FIT}}}\n",
        4,
        "modules/M/depends_on: cycle: M → M depends on itself",
    ),
    "unknown trigger": (needs("Bord"), 4, "components/A/depends_on: unknown part 'Bord'; did you mean 'Board'?"),
    "one of a list unknown": (needs("[Board, Bord]"), 4, "components/A/depends_on/1: unknown part 'Bord'"),
    "empty list": (needs("[]"), 4, "components/A/depends_on: is empty; expected at least one"),
    "a number": (needs("3"), 4, "components/A/depends_on: not a block; expected a part's name"),
    "misspelt block": (needs("{serie: [Board]}"), 4, "components/A/depends_on: not a block; expected a part's name"),
    "two of one": (needs("{k_of_n: {k: 2, of: [Board]}}"), 4, "components/A/depends_on: k_out_of_n: k = 2 of n = 1"),
    "of the robot": (TWO + "depends_on: A\n", 6, "depends_on: unknown key 'depends_on'"),
    "endless chain": (chain(3000), 1, "what contains or depends on one another is nested too deeply"),
    "unfolds": (LADDER, 1, "its diagrams unfold to more than 1,000,000 parts"),
}


@pytest.mark.parametrize(("text", "line", "says"), FAULTS.values(), ids=FAULTS.keys())
def test_faults_are_one_line_with_their_place(text, line, says):
    with pytest.raises(DesignError, match=re.escape(f"robot.yaml:{line}: {says}")) as error:
        parse(text, "robot.yaml")
    assert len(str(error.value).splitlines()) == 1


def test_a_part_is_in_series_with_what_it_depends_on_wherever_it_is_drawn():
    robot = parse(
        HEAD
        + """
components:
  Battery: {rate: 1 FIT}
modules:
  Power: {components: {Board: {rate: 1 FIT, depends_on: /Battery}}}
  Sensing:
    depends_on: Power/Board
    components:
      Camera: {rate: 1 FIT}
      Lidar: {rate: 1 FIT, depends_on: Camera}
    diagram: {parallel: [Camera, Lidar]}
diagram: Sensing
functions: {map: Sensing/Lidar}
"""
    )
    power = Series("Power/Board", Unit("Battery"))
    camera, lidar = Unit("Sensing/Camera"), Series("Sensing/Lidar", "Sensing/Camera")
    assert robot.diagram == Series(Parallel(camera, lidar), power)
    assert robot.functions["map"] == Series("Sensing/Lidar", power, camera)
    assert [module.diagram for module in robot.modules] == [Series(power), robot.diagram]
    assert robot.warnings == ()  # what others depend on is used
    assert {path: str(block.name) for path, block in robot.depends_on.items() if isinstance(block, Unit)} == {
        "Power/Board": "Battery",
        "Sensing": "Power/Board",
        "Sensing/Lidar": "Sensing/Camera",
    }


def test_a_part_within_a_module_may_need_what_needs_the_module():
    """No circle: the part does not stand on the module as a whole."""
    robot = parse(
        HEAD
        + """
components: {Fan: {rate: 1 FIT, depends_on: M/Board}}
modules: {M: {components: {Board: {rate: 1 FIT}, Camera: {rate: 1 FIT, depends_on: /Fan}}}}
diagram: M
"""
    )
    assert robot.diagram == Series("M/Board", Series("M/Camera", Series("Fan", "M/Board")))


def test_what_all_parts_of_a_quantity_share_stands_outside_them():
    robot = parse(HEAD + "components: {A: {rate: 1 FIT, quantity: 3, required: 2}}\ncommon_causes:\n"
                  "  heat: {of: [A], mgl: [0.1, 0.3]}\n")  # fmt: skip
    pairs = {(i, j): f"heat (A {i}, A {j})" for i, j in [(1, 2), (1, 3), (2, 3)]}
    members = (Series(f"A[{i}]", *(name for pair, name in pairs.items() if i in pair)) for i in (1, 2, 3))
    assert robot.diagram == Series(Series(KOutOfN(2, *members), "heat"))
    assert {mode.path: round(mode.share, 12) for mode in robot.modes} == {
        "A": 0.9,
        **{f"{name}/A": 0.035 for name in pairs.values()},
        "heat/A": 0.03,
    }
    assert [cause.members for cause in robot.causes][-1] == ("A[1]", "A[2]", "A[3]")


def test_members_may_be_of_other_modules_and_have_modes_and_pasts_of_their_own():
    modes = "failure_modes: {wear: {rate: 1 FIT}, burn: {rate: 2 FIT, initial_exposure: %s}}"
    robot = parse(HEAD + f"""
modules:
  Left: {{components: {{Motor: {{{modes % "0 h"}}}}}}}
  Right:
    components: {{Motor: {{{modes % "100 h"}}}}}
    common_causes: {{grease: {{of: [Motor, /Left/Motor], beta: 0.25}}}}
""")  # fmt: skip
    (cause,) = robot.causes
    assert (cause.path, cause.units, cause.members) == (
        "Right/grease",
        ("Right/grease",),
        ("Right/Motor", "Left/Motor"),
    )
    assert {mode.path: (mode.share, mode.origin, mode.rate * 1e9, mode.initial_exposure) for mode in cause.modes} == {
        "Right/grease/Motor/wear": (0.125, "Right/Motor/wear", pytest.approx(1), 0),
        "Right/grease/Motor/burn": (0.125, "Right/Motor/burn", pytest.approx(2), 100),
        "Right/grease/Left/Motor/wear": (0.125, "Left/Motor/wear", pytest.approx(1), 0),
        "Right/grease/Left/Motor/burn": (0.125, "Left/Motor/burn", pytest.approx(2), 0),
    }
