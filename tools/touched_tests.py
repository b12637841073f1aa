"""Run the tests that a change touches, the nearest first; ``make check`` calls it when lint has passed.

What has changed is what differs from the merge base with main, committed or not. A test file is touched where it is or

0. has changed itself;
1. imports a changed module, in the folder that mirrors it, or is named after it there;
2. imports it elsewhere: by itself or by its helpers and conftests (which are modules like others), or by the name of a
   package whose ``__init__`` has it from there;
3. the contract suite of the mirroring folder or of one above it;
4. of the house, whatever has changed;
5. another in the mirroring folder, 6. another above it;
7. holds the name of a changed file that is no module (data, an example, a document), and that of its folder.

When the time is over no further test begins, and what was not run is said. Sources are read, not imported.
"""

from __future__ import annotations

import argparse
import ast
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path, PurePosixPath

import pytest

ROOT = Path(__file__).resolve().parents[1]
SECONDS = 35.0
"""After its first, in which a process may begin tests; lint, imports and the last test have the rest of a minute."""
LIMIT = "TOUCHED_TESTS_SECONDS"
"""The variable by which the processes that run the tests know."""
LONG = ("tests/house/test_readme.py", "tests/house/test_wheel.py")
"""Of the house those that take a minute, all commands and what is shipped: run only if they have changed themselves."""
MIRRORS = {
    "src/robophm": "tests",
    "benchmarks": "tests/benchmarks",
    "examples": "tests/examples",
    "ros": "tests/ros",
    "ui": "tests/web/page",
}


def changed(root: Path) -> set[str]:
    """Files that differ from the merge base with main: committed, uncommitted, new or removed; none without git."""

    def git(*words: str) -> list[str]:
        done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
        return done.stdout.rstrip("\n\0").split("\0") if done.returncode == 0 and done.stdout else []

    bases = [base for main in ("main", "origin/main") for base in git("merge-base", "HEAD", main)]
    return {
        *git("diff", "--name-only", "--no-renames", "-z", *bases[:1] or ["HEAD"]),
        *git("ls-files", "--others", "--exclude-standard", "-z"),
    }


class Sources:
    """The Python files of a checkout, and what they import; paths are relative to its root, with slashes."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.tests = sorted(path.relative_to(root).as_posix() for path in root.glob("tests/**/test_*.py"))
        self.text = cache(lambda path: (root / path).read_text(encoding="utf-8"))
        self.imported = cache(lambda path: list(self._imported(path)))
        self.stands_on = cache(self._stands_on)

    def file(self, module: str) -> str:
        """Where a module's file is; where it would be, if there is none."""
        folder = PurePosixPath("src" if module.startswith("robophm") else "", *module.split("."))
        package = f"{folder}/__init__.py"
        return package if (self.root / package).is_file() else f"{folder}.py"

    def _imported(self, path: str) -> Iterator[tuple[str, str]]:
        """Module and name of all that a file imports, anywhere in it; ``robophm.load`` is such an import too."""
        folder = PurePosixPath(path.removeprefix("src/")).parent.parts

        def absolute(module: str | None, level: int = 0) -> str:
            for place in (PurePosixPath(path).parent, PurePosixPath("tools")):  # of which tests import by bare names
                if path.startswith("tests/") and not level and (self.root / place / f"{module}.py").is_file():
                    return ".".join([*place.parts, str(module)])
            return ".".join([*(folder[: len(folder) - level + 1] if level else ()), *([module] if module else [])])

        for node in ast.walk(ast.parse(self.text(path))):
            if isinstance(node, ast.Import):
                yield from ((absolute(one.name), "") for one in node.names)
            elif isinstance(node, ast.ImportFrom):
                yield from ((absolute(node.module, node.level), one.name) for one in node.names)
            elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "robophm":
                yield "robophm", node.attr

    def files(self, module: str, name: str) -> set[str]:
        """What an import of the project brings: the file of the module or package, and the one that has the name."""
        if module.partition(".")[0] not in ("robophm", "tests", "benchmarks", "tools"):
            return set()
        inside = self.file(f"{module}.{name}")
        if name and (self.root / inside).is_file():
            return {inside}
        path = self.file(module)
        homes = [home for home in self.imported(path) if home[1] == name] if path.endswith("__init__.py") else []
        return {path}.union(*(self.files(*home) for home in homes if home[0] != module))

    def _stands_on(self, test: str) -> set[str]:
        """The files that a test imports, its conftests and helpers, and what these import."""
        folders = [str(folder) for folder in PurePosixPath(test).parents]
        conftests = [one for one in (f"{folder}/conftest.py" for folder in folders) if (self.root / one).is_file()]
        found, unread = set(conftests), [test, *(one for one in conftests if one != "tests/conftest.py")]
        while unread:
            new = {path for one in self.imported(unread.pop()) for path in self.files(*one)} - found
            found |= new
            unread += [path for path in new if path.startswith("tests/") and (self.root / path).is_file()]
        return found

    def distance(self, test: str, path: str) -> float:
        """How far a test is from a changed file: 0 is itself, infinite what it does not touch."""
        if test == path:
            return 0
        here, there = PurePosixPath(path), PurePosixPath(test)
        tops = [(top, mirror) for top, mirror in MIRRORS.items() if here.is_relative_to(top)]
        mirrors = [PurePosixPath(mirror, here.relative_to(top)).parent for top, mirror in tops]
        beside = any(there.is_relative_to(folder) for folder in mirrors if folder.name != "tests")
        above = any(folder.is_relative_to(there.parent) for folder in mirrors)
        if path in self.stands_on(test) or (beside and there.name == f"test_{here.name}"):
            return 1 if beside else 2
        if beside or above:
            return 3 if there.name == "test_contract.py" else 5 if beside else 6
        named = here.suffix != ".py" and all(word in self.text(test) for word in (here.name, here.parent.name))
        return 7 if named else float("inf")


def touched(root: Path, paths: Iterable[str]) -> list[str]:
    """The test files that changed files touch, the nearest first; those of the house among them."""
    sources, paths = Sources(root), list(paths)
    ranked = []
    for test in sources.tests:
        house = [4.0] if test.startswith("tests/house/") else []
        ranked.append((min([*house, *(sources.distance(test, path) for path in paths)], default=float("inf")), test))
    return [test for distance, test in sorted(ranked) if distance < float("inf")]


class Unrun:
    """A plugin of the process that gathers results: the tests that were found and have none."""

    def __init__(self) -> None:
        self.tests: set[str] = set()

    def pytest_xdist_node_collection_finished(self, ids: list[str]) -> None:
        """A process has found these."""
        self.tests.update(ids)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """One has a result."""
        self.tests.discard(report.nodeid)


class Limit:
    """A plugin of the processes that run tests: none begins when the time is over."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.begun = seconds, 0.0

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self) -> bool | None:
        """What is true counts as run."""
        self.begun = self.begun or time.monotonic()
        return True if time.monotonic() - self.begun > self.seconds else None


def pytest_configure(config: pytest.Config) -> None:
    """Those processes have this file as a plugin."""
    config.pluginmanager.register(Limit(float(os.environ[LIMIT])))


def main() -> int:
    """Exit code of pytest, which does not count what had no time."""
    parser = argparse.ArgumentParser(description="run the tests that what has changed since main touches")
    parser.add_argument("--seconds", type=float, default=SECONDS, help=f"in which tests may begin; default {SECONDS:g}")
    seconds = parser.parse_args().seconds
    os.environ[LIMIT] = str(seconds)
    paths = changed(ROOT)
    tests = touched(ROOT, paths)
    print(f"{len(paths)} files differ from main; with the house they touch {len(tests)} test files", flush=True)
    left = [test for test in tests if test in LONG and test not in paths]
    chosen = [test for test in tests if test not in left]
    unrun = Unrun()
    code = int(pytest.main(["-q", "-n", "2", "-p", Path(__file__).stem, *chosen], plugins=[unrun])) if chosen else 0
    files = Counter(test.partition("::")[0] for test in unrun.tests)
    if files:
        print(f"NOT RUN, as {seconds:g} s of tests were over (`make check SECONDS=300` has more, `make test` all):")
        print(*(f"  {files[test]} tests of {test}" for test in chosen if test in files), sep="\n")
    if left:
        print("NOT RUN, as they take a minute each (`make test` does):", *left)
    return code


if __name__ == "__main__":
    sys.exit(main())
