"""``robophm users``: who may use the page of a robot."""

from __future__ import annotations

import getpass
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.report.words import moment_text

if TYPE_CHECKING:
    from robophm.web.access.users import Users

command = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None)

Design = Annotated[Path, typer.Argument(help="a design file or a fleet's store; its users are kept beside it")]
Name = Annotated[str, typer.Argument(help="name of a person or a program")]


@command.callback()
def _users() -> None:
    """Manage the users of a robot's page and their roles."""


@command.command()
def add(
    design: Design,
    name: Name,
    role: Annotated[
        str,
        typer.Option(help="viewer: looks; operator: also watches and acknowledges; editor: also changes the design"),
    ],
    token: Annotated[bool, typer.Option("--token", help="for a program: make a token and print it, this once")] = False,
    days: Annotated[
        float | None, typer.Option(min=0, help="days after which the token expires; default: never")
    ] = None,
) -> None:
    """Add a user, or give one another role and password; asks for the password, or reads it from standard input."""
    if days is not None and not token:
        raise RobophmError("--days is when a token ends; expected --token too")
    with _opened(design, make=True) as users:
        if token:
            typer.echo(users.add_token(name, role, days))
            print(f"{name} shows this token as `Authorization: Bearer …`; it is kept nowhere", file=sys.stderr)
            return
        users.add_person(name, role, _password())
    console().print(f"{name} may use the page of {design}, as {role}", markup=False, soft_wrap=True)


@command.command()
def remove(design: Design, name: Name) -> None:
    """Remove a user, whose sessions end at once."""
    with _opened(design) as users:
        users.remove(name)
        if not users:
            print(f"note: {design} has no users any more; on its own machine anybody may do anything", file=sys.stderr)


@command.command("list")
def list_(design: Design, as_json: Json = False) -> None:
    """List the users, their roles, and when tokens end."""
    with _opened(design) as users:
        found = users.all()
    if as_json:
        print_json({"users": [{"name": one.name, "role": one.role, "kind": one.kind, "ends": one.ends}
                              for one in found]})  # fmt: skip
        return
    rows = [[one.name, one.role, one.kind, moment_text(round(one.ends * SECOND)) if one.ends else "–"] for one in found]
    if rows:
        print_table(console(), table("", ("user", "role", "kind", "ends"), rows))
    else:
        console().print(f"{design} has no users: its page is for its own machine, where anybody may do anything",
                        markup=False, soft_wrap=True)  # fmt: skip


@contextmanager
def _opened(design: Path, *, make: bool = False) -> Iterator[Users]:
    """The users of a design. Raises RobophmError where there is no such design, StoreError where they cannot be had."""
    from robophm.web.access.file import AccessFile, access_path
    from robophm.web.access.users import Users

    path = access_path(design)
    if not design.is_file() and not path.exists():
        raise RobophmError(f"{design}: no such file; expected a robot's design, or a fleet's store")
    file = AccessFile(path if make or path.exists() else None)
    try:
        yield Users(file)
    finally:
        file.close()


def _password() -> str:
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    found = getpass.getpass("Password: ")
    if getpass.getpass("Once more: ") != found:
        raise RobophmError("the two passwords are not the same; nobody was added")
    return found
