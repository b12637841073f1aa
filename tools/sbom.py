"""What a release is made of, as CycloneDX: what the page bundles, with texts of licences, added to what is Python's.

``python tools/sbom.py extras`` prints the extras that may be installed where robophm runs, with commas between them.
``python tools/sbom.py page FOLDER < SBOM`` writes an SBOM with the page that was built in a folder of sources, and ends
with an error where it would not be valid.
"""

from __future__ import annotations

import base64
import json
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

NOT_AT_RUN_TIME = {"dev", "bench", "peers"}
"""Extras of those who work on the project."""

_BUNDLED = re.compile(
    r"^## (?P<name>\S+) - (?P<version>\S+) \((?P<license>[^)]+)\)\n(?P<text>.*?)(?=^## |\Z)", re.M | re.S
)


def run_time_extras(root: Path) -> list[str]:
    """Return the names of the extras that may be installed where robophm runs, sorted."""
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    return sorted(project["optional-dependencies"].keys() - NOT_AT_RUN_TIME)


def bundled(root: Path) -> Iterator[dict[str, Any]]:
    """Yield a component of CycloneDX for each npm package in the built page, with its licence and its text.

    What is in it is what the build says; what a package hashes to is in the lock file. Raises ValueError where one of
    them tells of nothing, or of something else than the other.
    """
    packages = json.loads((root / "ui" / "package-lock.json").read_text("utf-8"))["packages"]
    told = (root / "src" / "robophm" / "web" / "static" / "licenses.md").read_text("utf-8")
    found = [*_BUNDLED.finditer(told)]
    if len(found) != len(re.findall(r"^## ", told, re.M)) or not found:
        raise ValueError("licenses.md of the page: expected '## name - version (license)' and a text, for each package")
    for one in found:
        name, version = one["name"], one["version"]
        locked = packages.get(f"node_modules/{name}", {})
        if locked.get("version") != version:
            raise ValueError(f"{name}: the page bundles {version}, the lock file has {locked.get('version')}")
        algorithm, _, digest = locked["integrity"].partition("-")
        yield {
            "type": "library",
            "bom-ref": f"npm {name}@{version}",
            "name": name,
            "version": version,
            "purl": f"pkg:npm/{quote(name)}@{version}",
            "hashes": [{"alg": algorithm.upper().replace("SHA", "SHA-"), "content": base64.b64decode(digest).hex()}],
            "licenses": [{"license": {"id": one["license"], "text": {"content": one["text"].strip()}}}],
        }


def with_page(sbom: dict[str, Any], root: Path) -> dict[str, Any]:
    """Return an SBOM whose product depends on what its page bundles, too. Raises ValueError as ``bundled``."""
    more = [*bundled(root)]
    product = sbom["metadata"]["component"]["bom-ref"]
    own = next((one for one in sbom["dependencies"] if one["ref"] == product), {"ref": product})
    others = [one for one in sbom["dependencies"] if one["ref"] != product]
    needs = {**own, "dependsOn": sorted({*own.get("dependsOn", ()), *(one["bom-ref"] for one in more)})}
    leaves = [{"ref": one["bom-ref"]} for one in more]
    return {**sbom, "components": [*sbom["components"], *more], "dependencies": [needs, *others, *leaves]}


def main(asked: list[str]) -> None:
    """Do what is asked for on the command line."""
    if asked == ["extras"]:
        print(",".join(run_time_extras(Path.cwd())))
        return
    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator

    text = json.dumps(with_page(json.load(sys.stdin), Path(asked[1])), indent=2, sort_keys=True)
    if wrong := JsonStrictValidator(SchemaVersion.V1_6).validate_str(text):
        sys.exit(f"the SBOM is not CycloneDX: {wrong}")
    print(text)


if __name__ == "__main__":
    main(sys.argv[1:])
