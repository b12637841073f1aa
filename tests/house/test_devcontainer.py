"""The container for editors that open one: in the standard form, and set up by what make and the tools have."""

import json
import re
from pathlib import Path

from .test_make import recipe

ROOT = Path(__file__).resolve().parents[2]
CONTAINER = ROOT / ".devcontainer"
DOCUMENTED = {  # in the reference of the Development Containers Specification: for all, and with a Dockerfile
    "name", "forwardPorts", "portsAttributes", "otherPortsAttributes", "containerEnv", "remoteEnv", "remoteUser",
    "containerUser", "updateRemoteUserUID", "userEnvProbe", "overrideCommand", "shutdownAction", "init", "privileged",
    "capAdd", "securityOpt", "mounts", "features", "overrideFeatureInstallOrder", "customizations", "build", "appPort",
    "workspaceMount", "workspaceFolder", "runArgs", "initializeCommand", "onCreateCommand", "updateContentCommand",
    "postCreateCommand", "postStartCommand", "postAttachCommand", "waitFor", "hostRequirements", "secrets",
}  # fmt: skip


def test_the_container_is_described_in_the_standard_form() -> None:
    said = json.loads((CONTAINER / "devcontainer.json").read_text("utf-8"))
    assert said.keys() <= DOCUMENTED
    assert said["build"].keys() <= {"dockerfile", "context", "args", "options", "target", "cacheFrom"}
    dockerfile = (CONTAINER / said["build"]["dockerfile"]).read_text("utf-8").replace("\\\n", " ")
    steps = [line.split(None, 1) for line in dockerfile.splitlines() if line and not line.startswith("#")]
    assert steps[0][0] == "FROM"
    assert {verb for verb, _ in steps[1:]} <= {"COPY", "RUN"}, "what tools/test-fresh performs"
    assert re.fullmatch(r"[a-z]+:\d+", steps[0][1]), "an image without the name of a host"
    context = (CONTAINER / said["build"]["context"]).resolve()
    assert context == ROOT
    copied: set[str] = set()
    for verb, rest in steps[1:]:
        if verb == "COPY":
            *files, folder = rest.split()
            assert [file for file in files if not (context / file).is_file()] == []
            copied |= {folder + Path(file).name for file in files}
    run = " ".join(rest for verb, rest in steps if verb == "RUN")
    assert set(re.findall(r"sh (/\S+)", run)) == copied
    assert re.search(rf"useradd .*\b{said['remoteUser']}\b", run)


def test_the_container_is_set_up_by_what_make_has() -> None:
    said = json.loads((CONTAINER / "devcontainer.json").read_text("utf-8"))
    make, *targets = said["postCreateCommand"].split()
    assert make == "make"
    for target in targets:
        assert recipe(target)
