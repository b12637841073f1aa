"""What a release is made of and by: the SBOM of the page, and the workflow that publishes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import sbom
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
TEXT = "## {name} - {version} (MIT)\n\nPermission is hereby granted\n\n### of its own\n"


def laid(folder: Path, names: str, told: str) -> Path:
    """A folder of sources whose page bundles what ``told`` says, and whose lock file has these packages at 1.2.3."""
    static = folder / "src" / "robophm" / "web" / "static"
    static.mkdir(parents=True)
    (folder / "ui").mkdir()
    (static / "licenses.md").write_text(told)
    one = {"version": "1.2.3", "integrity": "sha512-" + "AQID" * 21 + "/w=="}
    packages = {f"node_modules/{name}": one for name in names.split()}
    (folder / "ui" / "package-lock.json").write_text(json.dumps({"packages": packages}))
    return folder


def test_what_the_page_bundles_is_in_the_sbom_with_its_text(tmp_path: Path) -> None:
    told = "# Licenses\n\n" + "".join(TEXT.format(name=name, version="1.2.3") for name in ("@a/b", "c"))
    python = {"metadata": {"component": {"bom-ref": "root"}}, "components": [{"bom-ref": "numpy"}]}
    python |= {"dependencies": [{"ref": "root", "dependsOn": ["numpy"]}, {"ref": "numpy"}]}
    done = sbom.with_page(python, laid(tmp_path, "@a/b c tool", told))
    first, second = done["components"][1:]
    assert first["purl"] == "pkg:npm/%40a/b@1.2.3"
    assert first["hashes"] == [{"alg": "SHA-512", "content": "010203" * 21 + "ff"}]
    assert first["licenses"][0]["license"]["id"] == "MIT"
    assert first["licenses"][0]["license"]["text"]["content"] == "Permission is hereby granted\n\n### of its own"
    (needs,) = (one["dependsOn"] for one in done["dependencies"] if one["ref"] == "root")
    assert needs == sorted(["numpy", first["bom-ref"], second["bom-ref"]])


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (TEXT.format(name="c", version="9"), "c: the page bundles 9, the lock file has 1.2.3"),
        (TEXT.format(name="unknown", version="1"), "unknown: the page bundles 1, the lock file has None"),
        ("## c, as it likes\n", "expected '## name - version"),
        ("", "expected '## name - version"),
    ],
)
def test_a_page_that_tells_of_something_else_is_refused(tmp_path: Path, told: str, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        [*sbom.bundled(laid(tmp_path, "c", told))]


def test_all_that_may_run_with_us_is_in_the_sbom() -> None:
    command = [sys.executable, ROOT / "tools" / "sbom.py", "extras"]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip().split(",")
    assert {"web", "ros2", "pdf", "sim"} <= {*said}
    assert not {"dev", "bench", "peers"} & {*said}


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_pin_what_they_use_and_may_do_only_what_they_say(path: Path) -> None:
    asked = YAML(typ="safe").load(path.read_text("utf-8"))
    assert asked["permissions"] == {}, "each job says what it may do"
    for name, job in asked["jobs"].items():
        assert "permissions" in job, name
        for step in job["steps"]:
            used = step.get("uses")
            assert used is None or re.fullmatch(r"[\w.-]+/[\w./-]+@[0-9a-f]{40}", used), used
            assert "${{ github.event" not in step.get("run", ""), "what others write is no command"
    assert "secrets." not in path.read_text("utf-8")


def test_there_is_a_workflow_for_releases() -> None:
    assert [path.name for path in WORKFLOWS] == ["release.yml"]
