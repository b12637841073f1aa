"""The registry of plugs: a name in a design or a command → one file of a plug folder, or an entry point.

A plug folder is a package in which every file is one plug and the file's name is the plug's name; folders
inside it give dotted names (``mil_hdbk_217f.capacitor``). Files that begin with ``_`` are not plugs, nor is
what the package names in ``NOT_PLUGS``: the interface that all its plugs share. Somebody else's package adds
a plug by an entry point whose group is the plug folder's full name and whose object is a module.

A name may come from a user's file, so it is only ever looked up, never imported as it stands.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import TYPE_CHECKING, TypeVar

from robophm.core.errors import PlugError, nearest

if TYPE_CHECKING:
    from importlib.metadata import EntryPoints

T = TypeVar("T")


def plugs(package: str) -> list[str]:
    """Names of all plugs of a plug folder, sorted: its own files and the entry points of that group.

    ``package`` is the folder's full name, ``"robophm.life"``; no plug is imported.
    """
    return sorted(_files(package) | {entry.name for entry in entry_points(group=package)})


def has_plug(package: str, name: str) -> bool:
    """Return whether a plug folder has a plug of this name, among its own files or the entry points of its group."""
    return name in _files(package) or bool(entry_points(group=package, name=name))


def load_plug(package: str, name: str, kind: str) -> ModuleType:
    """The module of one plug, imported on first use; a folder's own file goes before an entry point.

    ``kind`` is what errors call it ("life distribution").
    Raises PlugError where there is no plug of that name or it cannot be imported.
    """
    if not isinstance(name, str):
        raise PlugError(f"no {kind} {name!r:.60}{nearest('', plugs(package))}")
    try:
        if name in _files(package):
            return import_module(f"{package}.{name}")
        for entry in entry_points(group=package, name=name):
            module = entry.load()
            if not isinstance(module, ModuleType):
                raise PlugError(f"{kind} '{name}': entry point {entry.value} is not a module")
            return module
    except ImportError as error:
        raise PlugError(f"{kind} '{name}' cannot be imported: {error}") from error
    raise PlugError(f"no {kind} '{name}'{nearest(name, plugs(package))}")


def load_class(package: str, name: str, kind: str, base: type[T]) -> type[T]:
    """The one public class of a plug that is derived from ``base``. Raises PlugError without one."""
    module = load_plug(package, name, kind)
    classes = [
        value
        for key, value in vars(module).items()
        if isinstance(value, type)
        and issubclass(value, base)
        and value.__module__ == module.__name__
        and not key.startswith("_")
    ]
    if len(classes) != 1:
        raise PlugError(f"{kind} '{name}': {module.__name__} has {len(classes)} public classes, expected one")
    return classes[0]


@functools.cache
def _files(package: str) -> frozenset[str]:
    folder = import_module(package)
    return frozenset(_walk(folder.__path__, "")) - frozenset(getattr(folder, "NOT_PLUGS", ()))


def _walk(paths: Iterable[str], prefix: str) -> Iterator[str]:
    for folder in paths:
        for _, name, is_folder in iter_modules([folder]):
            if name.startswith("_"):
                continue
            if is_folder:
                yield from _walk([str(Path(folder, name))], f"{prefix}{name}.")
            else:
                yield prefix + name


def entry_points(*, group: str, name: str | None = None) -> EntryPoints:
    """Return the plugs that other packages offer in a group."""
    from importlib import metadata  # a third of the time of NumPy: not before somebody asks

    found = metadata.entry_points(group=group)
    return found if name is None else found.select(name=name)
