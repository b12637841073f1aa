"""robot.yaml ⇄ Robot: what is read, what is refused before it is read, and saving that loses nothing."""

import os
import subprocess
import sys
import time

import pytest

from robophm.core.errors import DesignError
from robophm.core.yaml_values import MAX_BYTES
from robophm.design.file import DesignFile, load, parse

DESIGN = """\
# my robot
schema_version: 1
name: R      # short
usage:
  operating: 0.5   # half of the day

components:
  # the weakest part first
  B: {rate: 12 FIT, quantity: 2}
  A:
    rate: '0.30 FPMH'   # quoted
    description: >-
      folded
      text
diagram:
  series:
    - parallel: ["B[1]", "B[2]"]
    - A
"""


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "my robot ü.yaml"
    path.write_text(DESIGN, encoding="utf-8")
    return path


def test_a_round_trip_changes_nothing(path, examples):
    assert DesignFile(path).text() == DESIGN
    for example in examples.rglob("robot.yaml"):
        assert DesignFile(example).text() == example.read_text(encoding="utf-8"), example


def test_an_edit_changes_its_line_alone(path):
    design = DesignFile(path)
    design.document["components"]["B"]["rate"] = "24 FIT"
    robot = design.save()
    assert path.read_text() == DESIGN.replace("12 FIT", "24 FIT")
    assert path.with_name(path.name + ".bak").read_text() == DESIGN
    assert robot.design_hash == load(path).design_hash
    assert {mode.path: mode.rate for mode in robot.modes} == {"B": 24e-9, "A": 0.3e-6}
    assert len(list(path.parent.iterdir())) == 2


def test_a_contradiction_is_not_saved(path):
    design = DesignFile(path)
    design.document["components"]["B"]["rate"] = "-1 FIT"
    with pytest.raises(DesignError, match=r"^.*my robot ü\.yaml:9: components/B/rate: hazard rate -1 FIT; expected"):
        design.save()
    assert path.read_text() == DESIGN
    assert list(path.parent.iterdir()) == [path]


def test_a_link_and_its_mode_are_kept(path, tmp_path):
    path.chmod(0o640)
    link = tmp_path / "link.yaml"
    link.symlink_to(path)
    DesignFile(link).save()
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o640


FULL = """
import resource, sys
from robophm.core.errors import DesignError
from robophm.design.file import DesignFile
design = DesignFile(sys.argv[1])
design.document["description"] = "x" * 5000
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), int(sys.argv[2])))
try:
    design.save()
except DesignError as error:
    print(error)
"""


@pytest.mark.parametrize("room", [0, 100, 1000])  # for nothing, for part of the old file, for part of the new
def test_a_full_disk_leaves_the_file_as_it_was(path, room):
    run = subprocess.run([sys.executable, "-c", FULL, str(path), str(room)], capture_output=True, text=True, check=True)
    assert run.stdout == f"{path}: cannot be saved: File too large; the file is as it was\n"
    assert path.read_text() == DESIGN
    left = {other.name for other in path.parent.iterdir()}
    assert left <= {path.name, path.name + ".bak"}
    assert not any(name.startswith(".") for name in left)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root mounts")
def test_a_full_file_system_leaves_the_file_as_it_was(tmp_path):
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting is not allowed here")
    try:
        path = folder / "robot.yaml"
        path.write_text(DESIGN)
        design = DesignFile(path)
        design.document["description"] = "x" * 60_000
        with pytest.raises(DesignError, match="cannot be saved: No space left on device; the file is as it was"):
            design.save()
        assert path.read_text() == DESIGN
        assert {other.name for other in folder.iterdir()} == {"robot.yaml", "robot.yaml.bak"}
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_file_that_went_away_meanwhile(path):
    design = DesignFile(path)
    path.unlink()
    with pytest.raises(DesignError, match="cannot be saved: No such file"):
        design.save()


@pytest.mark.parametrize("prefix", [b"", b"\xef\xbb\xbf"], ids=["plain", "BOM"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
def test_what_other_editors_write(tmp_path, prefix, end):
    path = tmp_path / "robot.yaml"
    path.write_bytes(prefix + DESIGN.replace("\n", end).encode())
    assert load(path).design_hash == parse(DESIGN).design_hash


@pytest.mark.parametrize("name", ["<b>", "a & b", '"quoted"', "it's", "🤖", "電池", "a\\b", "#1", "[1", "a: b", " a "])
def test_odd_names(tmp_path, name):
    from ruamel.yaml import YAML

    path = tmp_path / "robot.yaml"
    with path.open("w", encoding="utf-8") as stream:
        YAML().dump({"schema_version": 1, "name": "R", "components": {name: {"rate": "1 FIT"}}}, stream)
    if "[" in name:
        with pytest.raises(DesignError, match="is not a name"):
            load(path)
    else:
        assert [component.name for component in load(path).components] == [name]


def test_a_large_file_is_refused_before_it_is_parsed(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_bytes(b"#" * (MAX_BYTES + 1))
    begun = time.process_time()
    with pytest.raises(DesignError, match=r"robot\.yaml: is more than 20 MB"):
        load(path)
    assert time.process_time() - begun < 2


def test_a_device_without_end():
    with pytest.raises(DesignError, match=r"^/dev/zero: is more than 20 MB"):
        load("/dev/zero")


def test_what_is_no_text_file(tmp_path):
    with pytest.raises(DesignError, match=r"cannot be read: Is a directory$"):
        load(tmp_path)
    binary = tmp_path / "robot.yaml"
    binary.write_bytes(bytes(range(256)))
    with pytest.raises(DesignError, match=r"robot\.yaml: is not UTF-8 text \(byte 128\)$"):
        load(binary)
    binary.write_bytes("schema_version: 1".encode("utf-16"))
    with pytest.raises(DesignError, match="is not UTF-8 text"):
        load(binary)
    with pytest.raises(DesignError, match=r"robott\.yaml: no such file; did you mean 'robot\.yaml'\?$"):
        load(tmp_path / "robott.yaml")
    (tmp_path / "robot.yaml").rename(tmp_path / ".robots.yaml")
    with pytest.raises(DesignError, match=r"no such file$"):  # a hidden file is none that is meant
        load(tmp_path / "robot.yaml")
    with pytest.raises(DesignError, match=r"did you mean '\.robots\.yaml'\?$"):
        load(tmp_path / ".robot.yaml")
    with pytest.raises(DesignError, match=r"no such file$"):
        load(tmp_path / "no" / "folder" / "robot.yaml")
    with pytest.raises(DesignError, match=r"File name too long|no such file"):
        load(tmp_path / ("x" * 5000))


def test_what_may_not_be_read(path, monkeypatch):
    path.chmod(0)
    if os.geteuid() == 0:  # whom modes do not stop
        monkeypatch.setattr(
            "pathlib.Path.open", lambda *_: (_ for _ in ()).throw(PermissionError(13, "Permission denied"))
        )
    with pytest.raises(DesignError, match=r"my robot ü\.yaml: cannot be read: Permission denied$"):
        load(path)


def test_aliases_are_plain_values():
    robot = parse("schema_version: 1\nname: R\ncomponents:\n  A: &a {rate: 1 FIT}\n  B: *a\n")
    assert [mode.rate for mode in robot.modes] == [1e-9, 1e-9]


def test_the_hash_is_of_the_content_alone():
    plain = "schema_version: 1\nname: R\ncomponents: {A: {rate: 1 FIT}}\n"
    assert (
        parse(plain).design_hash
        == parse("# comment\n" + plain.replace("{A: {rate: 1 FIT}}", '\n  "A":\n    rate: 1 FIT')).design_hash
    )
    assert parse(plain).design_hash != parse(plain.replace("1 FIT", "2 FIT")).design_hash


@pytest.mark.parametrize("line", ['name: "\\ud800"', '"\\udfff": 1'])
def test_half_characters_are_no_text(line):
    with pytest.raises(DesignError, match=r"^design:2: .*is no text; expected whole characters$"):
        parse(f"schema_version: 1\n{line}\n")
