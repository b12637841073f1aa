"""What the tests of task lists share: a robot, and how a list is read."""

from __future__ import annotations

from robophm.design.file import parse
from robophm.design.task import Plan
from robophm.design.task_file import parse_plan, plan_from_csv

DESIGN = """schema_version: 1
name: R
acceleration: {model: q10}
modules:
  Power: {components: {Battery: {rate: 1 FIT}, Fuse: {rate: 1 FIT}}}
components:
  Wheel: {rate: 1 FIT, quantity: 3, required: 2}
  Arm: {rate: 1 FIT, acceleration: {model: cubic_load}}
functions: {drive: Wheel, lift: Arm}
"""
ROBOT = parse(DESIGN)
BARE = parse("schema_version: 1\nname: R\ncomponents: {A: {rate: 1 FIT}}\n")
HEAD = "schema_version: 1\n"
FINE = HEAD + "tasks:\n  - {duration: 1 h}\n"


def yaml(text: str) -> Plan:
    return parse_plan(text, ROBOT, "tasks.yaml")


def table(text: str) -> Plan:
    return plan_from_csv(text, ROBOT, "tasks.csv")
