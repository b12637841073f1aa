"""What is shipped: a universal wheel with its schema, its example and its types, and nothing else."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    return next(folder.glob("*.whl"))


def test_it_installs_anywhere(wheel):
    assert wheel.name.endswith("-py3-none-any.whl")


def test_it_holds_what_is_needed_at_run_time(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    examples = (f"examples/ota/{name}.yaml" for name in ("robot", "guide", "handbook"))
    messages = (f"ros/phm_msgs/{name}.msg" for name in ("msg/Health", "ros1/msg/Potc"))
    for needed in ("py.typed", "design/robot.schema.json", *examples, *messages):
        assert f"robophm/{needed}" in names
    assert not {name for name in names if name.startswith(("tests", "benchmarks"))}


def test_the_demonstration_runs_from_the_wheel_alone(wheel, tmp_path):
    """In a folder of its own, the sources out of reach."""
    code = f"import sys; sys.path.insert(0, {str(wheel)!r}); import robophm; print(robophm.__file__)"
    where = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert str(wheel) in where.stdout
    unpacked = tmp_path / "site"
    zipfile.ZipFile(wheel).extractall(unpacked)
    code = (
        f"import sys; sys.path.insert(0, {str(unpacked)!r}); from robophm.cli.demo import example_design;"
        "print(example_design())"
    )
    found = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert str(unpacked) in found.stdout
