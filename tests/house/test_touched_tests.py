"""``make check`` chooses the tests that a change touches, the nearest first, and says what it had no time for."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import touched_tests
from touched_tests import Sources, changed, touched

ROOT = Path(__file__).resolve().parents[2]
FILES = {
    "src/robophm/__init__.py": "from robophm.life import Weibull\n",
    "src/robophm/life/__init__.py": "from robophm.life.weibull import Weibull\n",
    "src/robophm/life/weibull.py": "class Weibull: ...\n",
    "src/robophm/life/gamma.py": "class Gamma: ...\n",
    "src/robophm/health/age.py": "from robophm.life.gamma import Gamma\n",
    "examples/arm/robot.yaml": "robot: arm\n",
    "docs/page.md": "# Page\n",
    "tests/conftest.py": "",
    "tests/test_names.py": "def test_one(): ...\n",
    "tests/house/test_words.py": "def test_one(): ...\n",
    "tests/house/test_readme.py": "def test_one(): assert False\n",
    "tests/life/test_contract.py": "def test_one(): ...\n",
    "tests/life/test_exact.py": "from robophm.life.weibull import Weibull\ndef test_one(): ...\n",
    "tests/life/test_gamma.py": "def test_one(): ...\n",
    "tests/life/test_peer.py": "def test_one(): ...\n",
    "tests/health/conftest.py": "",
    "tests/health/ages.py": "from robophm.life.gamma import Gamma\n",
    "tests/health/test_age.py": "from .ages import Gamma\ndef test_one(): ...\n",
    "tests/health/test_beside.py": "from ages import Gamma\ndef test_one(): ...\n",
    "tests/health/test_names.py": "import robophm\nrobophm.Weibull\ndef test_one(): ...\n",
    "tests/health/test_public.py": "from robophm import Weibull\ndef test_one(): ...\n",
    "tests/cli/test_show.py": "ARM = 'examples/arm/robot.yaml'\ndef test_one(): ...\n",
    "tests/cli/test_other.py": "LEG, PAGE = 'examples/leg/robot.yaml', 'docs/page.md'\ndef test_one(): ...\n",
    "tests/cli/test_tool.py": "from chosen import choice\ndef test_one(): ...\n",
    "tools/chosen.py": "choice = 1\n",
}
README, WORDS, NAMES = "tests/house/test_readme.py", "tests/house/test_words.py", "tests/test_names.py"
HOUSE = [README, WORDS]


def life(*names: str) -> list[str]:
    return [f"tests/life/test_{name}.py" for name in names]


def health(*names: str) -> list[str]:
    return [f"tests/health/test_{name}.py" for name in names]


def git(folder: Path, *words: str) -> None:
    named = ["-c", "user.name=nobody", "-c", "user.email=nobody@localhost", "-c", "init.defaultBranch=main"]
    subprocess.run(["git", *named, *words], cwd=folder, capture_output=True, check=True)


def commit(folder: Path) -> None:
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--allow-empty", "--message", "one")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A small one, with the tool."""
    for name, content in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content, encoding="utf-8")
    shutil.copy(touched_tests.__file__, tmp_path / "tools")
    return tmp_path


@pytest.fixture
def checkout(project: Path) -> Path:
    """The project as one commit, on main."""
    (project / ".gitignore").write_text("*.log\n__pycache__/\n", encoding="utf-8")
    git(project, "init", "--quiet")
    commit(project)
    return project


def test_what_differs_from_main_has_changed(checkout: Path) -> None:
    assert changed(checkout) == set()
    git(checkout, "switch", "--quiet", "--create", "work")
    (checkout / "docs/page.md").write_text("# Committed\n")
    commit(checkout)
    git(checkout, "switch", "--quiet", "main")
    (checkout / "examples/arm/robot.yaml").write_text("main went on\n")
    commit(checkout)
    git(checkout, "switch", "--quiet", "work")
    (checkout / "src/robophm/life/gamma.py").write_text("# not committed\n")
    (checkout / "tests/life/test_new one.py").write_text("")
    (checkout / "noise.log").write_text("ignored\n")
    (checkout / "tests/health/ages.py").unlink()
    git(checkout, "mv", "tests/life/test_peer.py", "tests/life/test_moved.py")
    assert changed(checkout) == {
        "docs/page.md", "src/robophm/life/gamma.py", "tests/life/test_new one.py", "tests/health/ages.py",
        "tests/life/test_peer.py", "tests/life/test_moved.py",
    }  # fmt: skip


def test_a_clone_without_a_main_of_its_own_compares_with_where_it_came_from(checkout: Path, tmp_path: Path) -> None:
    git(checkout, "switch", "--quiet", "--create", "work")
    (checkout / "docs/page.md").write_text("# Committed\n")
    commit(checkout)
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "--quiet", str(checkout), str(clone))
    assert changed(clone) == {"docs/page.md"}


def test_without_git_nothing_is_known_to_have_changed(tmp_path: Path) -> None:
    assert changed(tmp_path) == set()


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("tests/life/test_peer.py", ["tests/life/test_peer.py", *HOUSE]),
        (
            "src/robophm/life/weibull.py",  # an importer beside it, by a public name, the contract suite, others, above
            [*life("exact"), *health("names", "public"), *life("contract"), *HOUSE, *life("gamma", "peer"), NAMES],
        ),
        (
            "src/robophm/life/gamma.py",  # named after it; by a helper, from a package or from beside the test
            [*life("gamma"), *health("age", "beside"), *life("contract"), *HOUSE, *life("exact", "peer"), NAMES],
        ),
        ("tests/health/ages.py", [*health("age", "beside"), *HOUSE]),
        ("tests/health/conftest.py", [*health("age", "beside", "names", "public"), *HOUSE]),
        ("tests/conftest.py", [name for name in sorted(FILES) if "/test_" in name]),
        ("examples/arm/robot.yaml", [*HOUSE, NAMES, "tests/cli/test_show.py"]),
        ("docs/page.md", [*HOUSE, "tests/cli/test_other.py"]),
        ("tools/chosen.py", ["tests/cli/test_tool.py", *HOUSE]),
        ("Makefile", HOUSE),
    ],
)
def test_the_tests_that_a_file_touches(project: Path, path: str, expected: list[str]) -> None:
    assert touched(project, [path]) == expected


def test_a_module_that_is_gone_touches_who_still_imports_it(project: Path) -> None:
    (project / "src/robophm/life/gamma.py").unlink()
    assert {*life("gamma"), *health("age")} <= set(touched(project, ["src/robophm/life/gamma.py"]))


def test_nothing_changed_leaves_the_house(project: Path) -> None:
    assert touched(project, []) == HOUSE


RECORDER = """
import builtins, sys
real, seen = builtins.__import__, set()

def recorded(name, globals=None, locals=None, fromlist=(), level=0):
    module = real(name, globals, locals, fromlist, level)
    if "/tests/" in ((globals or {}).get("__file__") or ""):
        seen.add(getattr(sys.modules[name] if not level and name in sys.modules else module, "__file__", None))
        for one in fromlist or ():
            value = getattr(module, one, None)
            home = sys.modules.get(getattr(value, "__module__", None) or getattr(value, "__name__", ""))
            if isinstance(value, type) or callable(value):
                seen.add(getattr(home, "__file__", None))
    return module

def pytest_collection_finish():
    builtins.__import__ = real
    print("\\0", *sorted(filter(None, seen)), sep="\\n")

builtins.__import__ = recorded
"""


@pytest.mark.parametrize("test", ["tests/groups/test_laws.py", "tests/monitoring/test_replay.py"])
def test_what_python_imports_for_a_test_is_what_is_read(test: str, tmp_path: Path) -> None:
    """Of this project, by the interpreter's own import of a test with its helpers: modules and homes of names."""
    (tmp_path / "recorder.py").write_text(RECORDER)
    words = ["-m", "pytest", "--collect-only", "-q", "-s", "-p", "no:cacheprovider", "-p", "recorder"]
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "PYTHONPATH": path, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    command = [sys.executable, *words, test]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    imported = {Path(line) for line in done.stdout.partition("\0\n")[2].splitlines() if line.endswith(".py")}
    ours = {
        path.relative_to(ROOT).as_posix()
        for path in imported
        if path.is_relative_to(ROOT) and ".venv" not in path.parts
    }
    assert any(path.startswith("src/") for path in ours)
    assert ours <= Sources(ROOT).stands_on(test) | {test}


def run(checkout: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "tools/touched_tests.py", *words]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST")}
    environment |= {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_PLUGINS": "xdist.plugin"}  # half of their time
    return subprocess.run(command, cwd=checkout, env=environment, capture_output=True, text=True, check=False)


def test_the_nearest_run_and_what_had_no_time_is_said(checkout: Path) -> None:
    """Two processes begin a test of 0.4 s each; half a second after its first none begins another."""
    slow = "import time, pytest\n@pytest.mark.parametrize('i', range(20))\ndef test_one(i): time.sleep(0.4)\n"
    (checkout / "tests/life/test_peer.py").write_text(slow)
    done = run(checkout, "--seconds", "0.5")
    assert done.returncode == 0, done.stdout
    assert done.stdout.startswith("1 files differ from main; with the house they touch 3 test files")
    told = done.stdout.partition("NOT RUN, as 0.5 s of tests were over")[2]
    assert f"  1 tests of {WORDS}" in told
    assert told.endswith(f"as they take a minute each (`make test` does): {README}\n")
    (unrun,) = re.findall(r"^  (\d+) tests of tests/life/test_peer.py", told, re.M)
    (passed,) = re.findall(r"(\d+) passed", done.stdout)
    assert int(unrun) + int(passed) == 20
    assert int(passed) > 0


def test_a_test_that_fails_fails_the_check(checkout: Path) -> None:
    (checkout / "tests/life/test_peer.py").write_text("def test_one(): assert 1 == 2\n")
    done = run(checkout)
    assert done.returncode == 1
    assert "1 failed, 1 passed" in done.stdout
    assert "s of tests were over" not in done.stdout
