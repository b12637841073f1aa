"""What is said under diagrams."""

from robophm.design.file import parse
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.plant import Plant
from robophm.health.reporting import health_report
from robophm.report.dependence import MOST_SAID, dependence
from robophm.report.health_page import health_page

ROVER = parse("""
schema_version: 1
name: Rover
components:
  Supply: {rate: 1 FIT, depends_on: Battery}
  Battery: {rate: 1 FIT}
modules:
  Drive:
    depends_on: [Supply, {parallel: [Battery, Supply]}]
    components: {Left: {rate: 1 FIT}, Right: {rate: 1 FIT}, Wheel: {rate: 1 FIT, quantity: 3}}
    common_causes: {grease: {of: [Left, Right], beta: 0.125}, tread: {of: [Wheel], mgl: [0.1, 0.3]}}
""")


def test_a_level_says_what_it_depends_on_and_what_may_fail_together() -> None:
    assert dependence(ROVER, "") == [
        "Drive depends on all of (Supply, at least 1 of 2 (Battery, Supply))",
        "Supply depends on Battery",
    ]
    assert dependence(ROVER, "Drive") == [
        "grease: Left, Right may fail together: of the failures of each, 12.5 % in the set of 2",
        "tread: Wheel[1], Wheel[2], Wheel[3] may fail together: "
        "of the failures of each, 3.5 % in each set of 2, 3 % in the set of 3",
    ]


def test_the_page_says_it_too() -> None:
    page = health_page(ROVER, health_report(Plant(ROVER), ExposureIntegrator(ROVER), Ledger.new(ROVER)))
    for level in ("", "Drive"):
        for note in dependence(ROVER, level):
            assert note in page


def test_what_is_too_much_to_say_is_counted() -> None:
    parts = "".join(f"  P{i}: {{rate: 1 FIT, depends_on: Battery}}\n" for i in range(40))
    robot = parse(f"schema_version: 1\nname: R\ncomponents:\n  Battery: {{rate: 1 FIT}}\n{parts}")
    notes = dependence(robot, "")
    assert (len(notes), notes[-1]) == (MOST_SAID + 1, f"… and {40 - MOST_SAID} more")
