"""Reading and saving of design files: errors name the line, saving is atomic and keeps comments."""

from __future__ import annotations

import io
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from robophm.core.argument_checks import path as given_path
from robophm.core.errors import DesignError, nearest, nearest_file
from robophm.core.files import STANDARD_INPUT, read_at_most, shipped, write_atomically
from robophm.core.yaml_values import MAX_BYTES, Lines, located, values
from robophm.design.robot import Robot

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic_core import ErrorDetails

BACKUPS = 10
"""Earlier states of a design file that are kept beside it."""

SCHEMA_VERSION = 1
"""The version of design files and task lists; a file that states another number is refused."""

_Model = TypeVar("_Model", bound="BaseModel")


def load(path: str | os.PathLike[str]) -> Robot:
    """Read a robot's design. Raises DesignError, one line with file, line, place, what was expected."""
    where = given_path(path, "design", DesignError)
    return parse(read(where), str(where), where.parent)


def example_design() -> Path:
    """The design that comes with us, of the robot that ``transports.synthetic`` plays.

    Raises RobophmError where it is not installed.
    """
    return shipped("examples/ota/robot.yaml")


def parse(text: str, name: str = "design", folder: Path = Path()) -> Robot:
    """A robot from the text of a design file; ``name`` is what errors call it, ``folder`` where it is.

    Raises DesignError.
    """
    data, lines = mapping(text, name, "design")
    from robophm.design.build import build
    from robophm.design.located_error import LocatedError
    from robophm.design.schema import RobotFile  # a robot that is not read from a file needs no pydantic

    said = validated(RobotFile, data, name, lines)
    try:
        return replace(build(said, data), folder=folder)
    except LocatedError as fault:
        raise DesignError(located(name, lines, fault.place, str(fault))) from None


def mapping(text: str, name: str, what: str) -> tuple[dict[str, Any], Lines]:
    """Return a YAML text's plain values and the line of each; it must state its schema version. Raises DesignError."""
    data, lines = values(text, name)
    if not isinstance(data, dict):
        raise DesignError(
            f"{name}: holds no {what}; expected a mapping that starts with 'schema_version: {SCHEMA_VERSION}'"
        )
    found = data.get("schema_version")
    if type(found) is not int or found != SCHEMA_VERSION:
        line = lines.get(("schema_version",), 1)
        if found is None:
            raise DesignError(f"{name}:{line}: schema_version: not stated; expected {SCHEMA_VERSION}")
        raise DesignError(f"{name}:{line}: schema_version: {found!r:.60}; expected {SCHEMA_VERSION}")
    return data, lines


def validated(model: type[_Model], data: dict[str, Any], name: str, lines: Lines) -> _Model:
    """Return a file's values checked key by key. Raises DesignError with the line of the first fault."""
    from pydantic import ValidationError

    try:
        return model.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
        details.sort(key=lambda detail: detail["type"] != "extra_forbidden")  # a misspelt key explains a missing one
        place, message = place_and_message(details[0], lines, model)
        more = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
        raise DesignError(located(name, lines, place, message) + more) from None


class DesignFile:
    """A design file under edit: ``document`` is its YAML as nested mappings and lists, comments attached."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open a file for editing. Raises DesignError where it is not a valid design."""
        self.path = Path(path)
        text = read(self.path)
        parse(text, str(path))
        self.document: Any = round_trip().load(text)

    def text(self) -> str:
        """The file as it would be saved."""
        stream = io.StringIO()
        round_trip().dump(self.document, stream)
        return stream.getvalue()

    def save(self) -> Robot:
        """Write the file atomically, what was there kept beside it as ``<name>.bak``, and what was before that.

        Raises DesignError, the file as it was, where the document is no valid design or cannot be written.
        """
        return rewrite(self.path, self.text())


def rewrite(path: Path, text: str) -> Robot:
    """Put another text into a design file atomically, what was there kept beside it as ``<name>.bak``.

    Raises DesignError, the file as it was, where the text is no valid design or cannot be written.
    """
    robot = parse(text, str(path), path.parent)
    replace_text(path, text)
    return robot


def write(path: Path, text: str) -> Robot:
    """Write a design, whether a file is there or not; of one that was there, what it held is kept as by ``rewrite``.

    Raises DesignError, nothing written, where the text is no valid design or cannot be written.
    """
    robot = parse(text, str(path), path.parent)
    write_text(path, text)
    return robot


def write_text(path: Path, text: str) -> None:
    """Write a text, found valid already, as ``write`` does. Raises DesignError where it cannot be written."""
    if path.exists():
        replace_text(path, text)
        return
    try:
        write_atomically(path, text)
    except OSError as error:
        raise DesignError(f"{path}: cannot be written: {error.strerror}") from None


def replace_text(path: Path, text: str) -> None:
    """Replace a text by one found valid already, as ``rewrite`` does. Raises DesignError where it cannot be written."""
    try:
        _keep(path, path.read_bytes())
        write_atomically(path, text)
    except OSError as error:
        raise DesignError(f"{path}: cannot be saved: {error.strerror}; the file is as it was") from None


def _keep(path: Path, content: bytes) -> None:
    """Put what a file holds beside it as .bak, what was there as .bak.2 and so on: the latest BACKUPS are kept.

    Raises OSError, no backup then being lost.
    """
    names = [path.with_name(f"{path.name}.bak" + (f".{i}" if i > 1 else "")) for i in range(1, BACKUPS + 1)]
    if names[0].exists() and names[0].read_bytes() == content:
        return
    made = names[0].with_name(names[0].name + ".new")
    write_atomically(made, content)  # first: a full disk takes nothing away
    free = next((i for i, name in enumerate(names) if not name.exists()), len(names) - 1)
    for i in range(free, 0, -1):
        names[i - 1].replace(names[i])
    made.replace(names[0])


def round_trip() -> Any:
    """Return the YAML reader and writer that keeps a document's comments."""
    from ruamel.yaml import YAML

    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = MAX_BYTES  # a line is as long as its author made it
    yaml.brace_single_entry_mapping_in_flow_sequence = True
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def read(path: Path) -> str:
    """Return the text of a file of at most MAX_BYTES. Raises DesignError."""
    try:
        if path != STANDARD_INPUT and not path.exists():
            beside = [other.name for other in path.parent.iterdir()] if path.parent.is_dir() else []
            suffixes = (".csv",) if path.suffix.lower() == ".csv" else (".yaml", ".yml")
            hint = nearest_file(path.name, [name for name in beside if name.lower().endswith(suffixes)])
            raise DesignError(f"{path}: no such file{hint}")
        content = read_at_most(path, MAX_BYTES)
        if content is None:
            raise DesignError(
                f"{path}: is more than {MAX_BYTES / 1e6:.0f} MB; expected at most that of a design or table"
            )
        return content.decode("utf-8-sig")
    except OSError as error:
        raise DesignError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise DesignError(f"{path}: is not UTF-8 text (byte {error.start})") from None


def place_and_message(detail: ErrorDetails, lines: Lines, model: type[BaseModel]) -> tuple[tuple[str, ...], str]:
    """Return place and message of a pydantic error: its location without the names of union branches."""
    place: tuple[str, ...] = ()
    for i, step in enumerate(detail["loc"]):
        last = i == len(detail["loc"]) - 1
        if (*place, str(step)) in lines or (last and detail["type"] in ("missing", "extra_forbidden")):
            place = (*place, str(step))
    if detail["type"] == "extra_forbidden":
        key, known = place[-1], _keys(place[:-1], lines, model)
        if key in known:  # of a block, which is of one kind
            return place, f"'{key}' stands beside another kind of block; expected one of {', '.join(known)}"
        return place, f"unknown key '{key}'{nearest(key, known)}"
    if detail["type"] == "missing":
        return place[:-1], f"needs '{place[-1]}'"
    if detail["type"] == "string_pattern_mismatch":
        strokes = "/" in detail["ctx"]["pattern"]
        never = "/ [ ] and line breaks" if strokes else "control characters"
        return place, f"{detail['input']!r:.60} is not a name; expected text without {never}"
    if detail["type"] in ("model_type", "dict_type", "model_attributes_type"):
        return place, f"expected keys with values, not {detail['input']!r:.60}"
    if detail["type"] == "too_short":
        bounds = detail["ctx"]
        if bounds["actual_length"]:
            return place, f"has {bounds['actual_length']}; expected at least {bounds['min_length']}"
        return place, "is empty; expected at least one"
    message = detail["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
    given = detail["input"]
    says_it = isinstance(given, dict | list) or detail["type"] == "value_error"
    return place, message if says_it else f"{message}, not {given!r:.60}"


def _keys(place: tuple[str, ...], lines: Lines, root: type[BaseModel]) -> list[str]:
    """The keys that a mapping at this place of a file may have."""
    from robophm.design import schema, schema_blocks, schema_task
    from robophm.design.schema_thresholds import threshold_model

    inside: dict[str, type[BaseModel]] = {
        "modules": schema.Module,
        "components": schema.Component,
        "failure_modes": schema.FailureMode,
        "signals": schema.SignalBinding,
        "clocks": schema.ClockBinding,
        "failed_when": schema.ToldFailure,
        "common_causes": schema.CommonCause,
        "tasks": schema_task.Leg,
        "legs": schema_task.Leg,
        "links": schema_blocks.NetworkLink,
    }
    itself: dict[str, type[BaseModel]] = {
        "life": schema.Life,
        "hazard": schema.Hazard,
        "usage": schema.Usage,
        "task": schema_task.Leg,
        "uncertainty": schema.Uncertainty,
        "learned": schema.Learned,
        "wear": schema.Wear,
        "ambient": schema.WearGauge,
        "load": schema.WearGauge,
        "knowledge": schema_task.Knowledge,
        "powered": schema.PowerBinding,
        "k_of_n": schema_blocks.KOutOfNGroup,
        "standby": schema_blocks.StandbyGroup,
        "load_sharing": schema_blocks.LoadSharingGroup,
        "network": schema_blocks.NetworkGroup,
    }
    if not place:
        return list(root.model_fields)
    if "thresholds" in place[::2]:  # as a key, not as a name
        at = 2 * place[::2].index("thresholds")
        return [*threshold_model(place[at + 1 :], place[at - 2] if at else "").model_fields]
    if (*place, "legs") in lines:
        return list(schema_task.Task.model_fields)
    model = inside[place[-2]] if len(place) > 1 and place[-2] in inside else itself.get(place[-1])
    if model is None:
        return list(schema_blocks.BLOCKS)
    return [field.alias or name for name, field in model.model_fields.items()]
