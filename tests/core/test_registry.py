import sys
from importlib.metadata import EntryPoint

import pytest

from robophm.core import registry
from robophm.core.errors import PlugError
from robophm.core.registry import load_plug, plugs


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A plug folder with an interface, helpers, a nested folder, and files outside it."""
    root = tmp_path / "plugged"
    for file in ("book/coil.py", "book/_table.py", "general/pump.py", "_private/x.py"):
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_text("WHO = __name__\n")
        (root / file).with_name("__init__.py").write_text("")
    (root / "__init__.py").write_text('NOT_PLUGS = ("model",)\n')
    for file in ("model.py", "_helper.py", "plain.py"):
        (root / file).write_text("WHO = __name__\n")
    (root / "broken.py").write_text("import nothing_of_that_name\n")
    (tmp_path / "outside_the_folder.py").write_text("raise SystemExit\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    registry._files.cache_clear()
    yield "plugged"
    for name in [name for name in sys.modules if name.split(".")[0] == "plugged"]:
        del sys.modules[name]
    registry._files.cache_clear()


def test_files_are_plugs_and_folders_give_dotted_names(folder):
    assert plugs(folder) == ["book.coil", "broken", "general.pump", "plain"]
    assert load_plug(folder, "book.coil", "model").WHO == "plugged.book.coil"
    assert "plugged.plain" not in sys.modules  # imported on first use only


@pytest.mark.parametrize(
    "name",
    [
        *("", ".", "..", "model", "_helper", "__init__", "book", "book._table", "_private.x"),
        *("os", "..os", "sys", "outside_the_folder", "../outside_the_folder", "/etc/passwd"),
        *("plain\n", "Plain", "plain.WHO", "book/coil"),
    ],
)
def test_nothing_else_is_imported(folder, name):
    before = set(sys.modules)
    with pytest.raises(PlugError, match="no hazard model"):
        load_plug(folder, name, "hazard model")
    assert {module for module in set(sys.modules) - before if "plug" in module or "out" in module} <= {folder}


def test_errors_name_the_nearest_and_the_missing(folder):
    with pytest.raises(PlugError, match=r"^no model 'book\.coill'; did you mean 'book\.coil'\?$"):
        load_plug(folder, "book.coill", "model")
    with pytest.raises(PlugError, match="model 'broken' cannot be imported: No module named 'nothing_of"):
        load_plug(folder, "broken", "model")


def test_entry_points_of_other_packages(folder, monkeypatch):
    known = [
        EntryPoint("theirs", "json.decoder", folder),
        EntryPoint("plain", "json.encoder", folder),
        EntryPoint("a_class", "json.decoder:JSONDecoder", folder),
        EntryPoint("gone", "nothing_of_that_name", folder),
    ]
    monkeypatch.setattr(
        registry,
        "entry_points",
        lambda *, group, name=None: [e for e in known if e.group == group and name in (None, e.name)],
    )
    assert plugs(folder) == ["a_class", "book.coil", "broken", "general.pump", "gone", "plain", "theirs"]
    assert load_plug(folder, "theirs", "model").__name__ == "json.decoder"
    assert load_plug(folder, "plain", "model").WHO == "plugged.plain"  # the folder's own file goes first
    with pytest.raises(PlugError, match="is not a module"):
        load_plug(folder, "a_class", "model")
    with pytest.raises(PlugError, match="cannot be imported"):
        load_plug(folder, "gone", "model")
