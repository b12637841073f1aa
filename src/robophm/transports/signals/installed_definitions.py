"""Definitions of messages that lie on this machine: of installations of ROS 2, and in folders of .msg files.

Installations are those of AMENT_PREFIX_PATH. Folders are those of ROBOPHM_MESSAGES, which ``robophm --messages`` sets:
an installation's prefix, a workspace's sources, or any tree in which ``<package>/msg/<Name>.msg`` lies.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robophm.core.errors import SourceError

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

FOLDERS = "ROBOPHM_MESSAGES"
"""The environment variable with the folders of .msg files, as AMENT_PREFIX_PATH has those of installations."""

MOST_PARTS = 200
"""Types in a type, beyond which a definition is taken to be damaged."""

LONGEST_FILE = 1 << 20
"""Bytes of a definition's file, beyond which it is not believed to be one."""

MOST_FOLDERS = 100_000
"""Folders of a tree that are looked into."""

NAME = re.compile(r"[A-Za-z]\w*/(msg|srv|action)/[A-Za-z]\w*\Z", re.ASCII)
"""The full name of a type."""

_SEPARATOR = "\n" + "=" * 80 + "\nMSG: "


def use_folders(folders: list[Path]) -> None:
    """Look for definitions in these folders from now on. Raises SourceError where one is none."""
    for folder in folders:
        if not folder.is_dir():
            raise SourceError(f"{folder}: no such folder; expected one with <package>/msg/<Name>.msg in it")
    os.environ[FOLDERS] = os.pathsep.join(str(folder.absolute()) for folder in folders)


def places() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the folders that were given, and the prefixes of installations, as they are now."""
    given, installed = (os.environ.get(name, "") for name in (FOLDERS, "AMENT_PREFIX_PATH"))
    return tuple(filter(None, given.split(os.pathsep))), tuple(filter(None, installed.split(os.pathsep)))


def definitions_in(prefixes: tuple[str, ...], name: str) -> Iterator[tuple[str, str]]:
    """Yield the definitions of a type that lie in these folders, each with all types in it, and its folder."""
    if NAME.match(name):
        for prefix in prefixes:
            if (text := gathered(name, partial(_file, Path(prefix)))) is not None:
                yield text, prefix


def generated(store: Typestore, name: str) -> str:
    """Return the text of a type and of all types in it that rosbags knows."""
    return str(store.generate_msgdef(name, ros_version=2)[0])


def gathered(name: str, own: Callable[[str], str | None]) -> str | None:
    """Return the texts of a type and of all types in it, those that ``own`` has not by rosbags; None where it has not
    this."""
    from rosbags.interfaces import Nodetype
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    texts: dict[str, str] = {}
    waiting = [name]
    others: Typestore | None = None
    while waiting:
        part = waiting.pop()
        if part in texts:
            continue
        text = own(part)
        if text is None:
            if not texts:
                return None
            others = others or get_typestore(Stores.LATEST)
            if part not in others.fielddefs:
                continue  # compiling it says so
            text = generated(others, part).partition("\n" + "=" * 80)[0]
        texts[part] = text
        if len(texts) > MOST_PARTS:
            return None
        try:
            fields = get_types_from_msg(text, part)[part][1]
        except Exception:  # whatever the parser raises: compiling it says what is wrong
            continue
        for _, (node, detail) in fields:
            inner: Any = detail[0] if node in (Nodetype.ARRAY, Nodetype.SEQUENCE) else (node, detail)
            if inner[0] == Nodetype.NAME:
                waiting.append(inner[1])
    return _SEPARATOR.join([texts[name], *(f"{part}\n{texts[part]}" for part in texts if part != name)])


def _file(prefix: Path, name: str) -> str | None:
    """The text of one type in an installation."""
    package, kind, last = name.split("/")
    folder = prefix / "share" / package / kind
    if not folder.is_dir():
        folder = _packages(str(prefix)).get(f"{package}/{kind}", folder)
    try:
        if kind == "action":
            return _of_action(folder, package, last)
        path = folder / f"{last}.msg"
        if path.stat().st_size <= LONGEST_FILE:
            return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        pass
    return None


@lru_cache(maxsize=64)
def _packages(root: str) -> dict[str, Path]:
    """The folders of definitions in a tree, by package and kind; of several of one package the first by its path."""
    found: dict[str, Path] = {}
    for folder, inner, _ in islice(os.walk(root), MOST_FOLDERS):
        inner.sort()
        for kind in {"msg", "srv", "action"} & {*inner}:
            found.setdefault(f"{Path(folder).name}/{kind}", Path(folder) / kind)
    return found


def feedback_message(name: str) -> str:
    """Return the text of the message in which an action's feedback is published."""
    return f"unique_identifier_msgs/UUID goal_id\n{name.removesuffix('Message')} feedback\n"


def _of_action(folder: Path, package: str, last: str) -> str | None:
    """The feedback of an action as a type: rosidl makes it of the third part of the action's file."""
    action, _, kind = last.partition("_")
    if kind == "FeedbackMessage":
        return feedback_message(f"{package}/action/{last}")
    path = folder / f"{action}.action"
    if kind != "Feedback" or path.stat().st_size > LONGEST_FILE:
        return None
    parts = re.split(r"^---\s*$", path.read_text(encoding="utf-8", errors="replace"), flags=re.M)
    # a type without its package is a message of the action's own
    return re.sub(r"^([A-Z]\w*)(?=[\[\s])", rf"{package}/\1", parts[2], flags=re.M) if len(parts) == 3 else None
