"""What every importer must do: a file of its kind becomes a design, of another kind or none a fault of one line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.importers.bom import import_bom
from robophm.design.importers.legacy.reading import import_legacy
from robophm.design.importers.open_psa import load
from robophm.design.importers.open_psa.as_design import as_design
from robophm.design.importers.urdf import import_urdf

DATA = Path(__file__).parents[2] / "data"
TREE = """<opsa-mef><define-fault-tree name="t">
<define-gate name="lost"><or><basic-event name="motor"/><basic-event name="drive"/></or></define-gate>
<define-basic-event name="motor"><float value="0.1"/></define-basic-event>
<define-basic-event name="drive"><float value="0.2"/></define-basic-event>
</define-fault-tree></opsa-mef>"""

IMPORTERS: dict[str, Callable[[Path], str]] = {
    "bom": lambda path: import_bom(path, path.with_name("new.yaml")).text,
    "legacy": lambda path: import_legacy(path).text,
    "open_psa": lambda path: as_design(load(path), path.name, 1000.0),
    "urdf": import_urdf,
}
OWN = {
    "bom": (DATA / "bom" / "kicad.csv").read_bytes(),
    "legacy": (DATA / "legacy_ota.yaml").read_bytes(),
    "open_psa": TREE.encode(),
    "urdf": (DATA / "robots" / "six_axis_arm.urdf").read_bytes(),
}
NONE = {"empty": b"", "no text": bytes(range(256)), "prose": b"The motor failed on Monday.\n"}


@pytest.mark.parametrize("kind", IMPORTERS)
def test_a_file_of_its_kind_becomes_a_design(kind, tmp_path):
    path = tmp_path / "given"
    path.write_bytes(OWN[kind])
    assert parse(IMPORTERS[kind](path)).all_components()
    assert list(tmp_path.iterdir()) == [path], "nothing is written"


@pytest.mark.parametrize(("kind", "given"), [(a, b) for a in IMPORTERS for b in (*OWN, *NONE) if a != b])
def test_what_is_no_such_file_is_refused_in_one_line(kind, given, tmp_path):
    path = tmp_path / "given"
    path.write_bytes((OWN | NONE)[given])
    with pytest.raises(DesignError) as refused:
        IMPORTERS[kind](path)
    assert str(refused.value).startswith(f"{path}:")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("kind", IMPORTERS)
def test_a_file_that_is_not_there_is_refused_in_one_line(kind, tmp_path):
    path = tmp_path / "absent"
    with pytest.raises(DesignError) as refused:
        IMPORTERS[kind](path)
    assert str(refused.value).startswith(f"{path}:")
    assert "\n" not in str(refused.value)
