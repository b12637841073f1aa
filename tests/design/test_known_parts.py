"""Parts that are known already: what is stated of a design in one order, and what is kept of the last one."""

import hashlib
import json

import pytest

from robophm.core.yaml_values import values
from robophm.design.build import build
from robophm.design.known_parts import KnownParts
from robophm.design.located_error import LocatedError
from robophm.design.schema import RobotFile

TEXT = """\
schema_version: 1
name: "robot \\u00e4 \\"b\\""
thresholds: {completion: 0.9}
components:
  z: {rate: 1 FIT, offsets: {}}
  a: {quantity: 3, mtbf: 1000 h, description: größer}
modules:
  n:
    environment: ground_mobile
    components:
      b: {rate: 2 FIT}
      c: {rate: 3 FIT, life: {distribution: weibull, shape: 2}}
"""


def built(text, known=None):
    said, _ = values(text, "design")
    return build(RobotFile.model_validate(said), said, known)


def test_the_content_is_that_of_the_whole_design_in_one_order():
    said, _ = values(TEXT, "design")
    whole = RobotFile.model_validate(said).model_dump(mode="json")
    content = json.dumps(whole, sort_keys=True, ensure_ascii=False)
    assert built(TEXT).design_hash == hashlib.sha256(content.encode()).hexdigest()


def test_only_what_is_stated_otherwise_is_built_again():
    known = KnownParts()
    before = {part.path: part for part in built(TEXT, known).all_components()}
    after = {part.path: part for part in built(TEXT.replace("2 FIT", "4 FIT"), known).all_components()}
    assert {path for path, part in after.items() if part is not before[path]} == {"n/b"}
    moved = {part.path: part for part in built(TEXT.replace("ground_mobile", "ground_fixed"), known).all_components()}
    assert {path for path, part in moved.items() if part is not after[path]} == {"n/b", "n/c"}
    tooth = {part.path: part for part in built(TEXT.replace("rate: 2", "rate: 2.0"), known).all_components()}
    assert all(tooth[path] is not moved[path] for path in ("n/b", "n/c"))


def test_a_design_that_is_none_leaves_what_is_known():
    known = KnownParts()
    before = {part.path: part for part in built(TEXT, known).all_components()}
    with pytest.raises(LocatedError, match="-2 FIT"):
        built(TEXT.replace("2 FIT", "-2 FIT"), known)
    after = {part.path: part for part in built(TEXT, known).all_components()}
    assert all(after[path] is part for path, part in before.items())
