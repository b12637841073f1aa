"""What is shipped: a universal wheel with its schema, its example and its types, and nothing else."""

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A folder with the sdist, and the wheel that was made of it where there is no Node."""
    page = subprocess.run([sys.executable, ROOT / "hatch_build.py"], capture_output=True, text=True, check=False)
    if page.returncode:
        pytest.skip(page.stderr)
    folder = tmp_path_factory.mktemp("built")
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    environment = {**os.environ, "PATH": str(Path(sys.executable).parent)}
    subprocess.run(command, check=True, capture_output=True, env=environment)
    return folder


@pytest.fixture(scope="module")
def wheel(built):
    return next(built.glob("*.whl"))


def test_the_page_is_shipped_whole_and_sources_come_with_it(built, wheel):
    shipped = set(zipfile.ZipFile(wheel).namelist())
    with tarfile.open(next(built.glob("*.tar.gz"))) as sdist:
        sources = {name.partition("/")[2] for name in sdist.getnames()}
    index = zipfile.ZipFile(wheel).read("robophm/web/static/index.html").decode()
    named = re.findall(r'(?:src|href)="\./([^"]+)"', index)
    assert any(name.endswith(".js") for name in named)
    for name in named:
        assert f"robophm/web/static/{name}" in shipped
        assert f"src/robophm/web/static/{name}" in sources
    assert "robophm/web/grafana.json" in shipped
    for needed in ("ui/package-lock.json", "ui/src/main.tsx", "docs/reference/openapi.json", "hatch_build.py"):
        assert needed in sources
    assert not [name for name in sources if "node_modules" in name]


def test_the_lock_file_names_no_address():
    assert b'"resolved"' not in (ROOT / "ui" / "package-lock.json").read_bytes()


def test_a_package_index_is_given_no_link_into_the_sources(wheel):
    with zipfile.ZipFile(wheel) as packed:
        (metadata,) = [name for name in packed.namelist() if name.endswith("METADATA")]
        text = packed.read(metadata).decode()
    assert "recordings and data: `docs/guides/data.md`" in text
    assert "make demo" in text
    assert not re.search(r"\]\((?!\w+:|#)|!\[", text)


def test_it_installs_anywhere(wheel):
    assert wheel.name.endswith("-py3-none-any.whl")


def test_it_holds_what_is_needed_at_run_time(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    examples = (f"examples/ota/{name}.yaml" for name in ("robot", "guide", "handbook"))
    messages = (f"ros/phm_msgs/{name}" for name in ("msg/Health.msg", "ros1/msg/Potc.msg", "srv/ReportFailure.srv"))
    library = (f"parts/library/{file.name}" for file in (ROOT / "src/robophm/parts/library").iterdir())
    for needed in ("py.typed", "design/robot.schema.json", *examples, *messages, *library):
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
        f"import sys; sys.path.insert(0, {str(unpacked)!r}); from robophm.design.file import example_design;"
        "print(example_design())"
    )
    found = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert str(unpacked) in found.stdout
