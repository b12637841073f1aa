"""What the page says that commands print, they print."""

import io
import re
import shlex
import sys
from pathlib import Path

import pytest

from robophm.cli import main
from robophm.transports.synthetic import SyntheticOta

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "guides" / "data.md").read_text(encoding="utf-8")
SHOWN = [
    block
    for console in re.findall(r"```console\n(.*?)```", PAGE, re.S)
    for block in re.split(r"^\$ robophm ", console, flags=re.M)[1:]
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("page")
    SyntheticOta(seed=1).record(made / "day.mcap")
    (made / "robot.yaml").write_bytes((ROOT / "examples" / "ota" / "robot.yaml").read_bytes())
    return made


@pytest.mark.full
def test_commands_print_what_the_page_shows(folder, monkeypatch):
    """The lines in their order; … is any lines."""
    assert len(SHOWN) == 7
    monkeypatch.chdir(folder)
    for block in SHOWN:
        command, *expected = block.rstrip("\n").split("\n")
        out, errors = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2))
        with monkeypatch.context() as patch:
            patch.setattr(sys, "argv", ["robophm", *shlex.split(command)])
            patch.setattr(sys, "stdout", out)
            patch.setattr(sys, "stderr", errors)
            with pytest.raises(SystemExit) as leaving:
                main()
            text = out.buffer.getvalue().decode()
        assert not leaving.value.code, command
        printed = [line.rstrip() for line in text.split("\n")]
        wanted = "\n".join(".*" if line == "…" else re.escape(line) for line in expected)
        assert re.fullmatch(wanted + r"\n*", "\n".join(printed), re.S), "\n".join([command, *printed])
