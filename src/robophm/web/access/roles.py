"""The roles of those who use the service, and the role that each route needs, which the route itself declares."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Literal, TypeVar, get_args

from starlette.routing import BaseRoute, Match
from starlette.types import Scope

Role = Literal["viewer", "operator", "editor"]
"""A viewer looks, an operator also watches the robot and takes note of what happens to it, an editor also changes the
design."""

ROLES: tuple[Role, ...] = get_args(Role)
"""All roles: each may do what those before it may."""

LOOKING = ("GET", "HEAD", "OPTIONS")
"""Methods that change nothing."""

Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])


def needs(role: Role) -> Callable[[Endpoint], Endpoint]:
    """Declare the role that a route needs; to be written between the route's decorator and its function."""

    def declared(endpoint: Endpoint) -> Endpoint:
        endpoint.__dict__["needed_role"] = role
        return endpoint

    return declared


def declared_role(route: BaseRoute) -> Role | None:
    """Return the role that a route declares; None where it declares none."""
    return getattr(getattr(route, "endpoint", None), "needed_role", None)


def role_needed(scope: Scope, routes: Iterable[BaseRoute]) -> Role:
    """Return the role that a request needs: what its route declares, else a viewer's to look, an editor's to change."""
    for route in routes:
        if route.matches(scope)[0] is Match.FULL and (declared := declared_role(route)):
            return declared
    return "viewer" if scope["type"] == "websocket" or scope["method"] in LOOKING else "editor"


def role_of(route: BaseRoute) -> Role:
    """Return the role that all of a route's methods need."""
    return declared_role(route) or ("editor" if changes(route) else "viewer")


def may(role: Role, needed: Role) -> bool:
    """Return whether somebody in a role may do what needs another."""
    return ROLES.index(role) >= ROLES.index(needed)


def changes(route: BaseRoute) -> bool:
    """Return whether a route takes methods that change something."""
    return not set(getattr(route, "methods", None) or ()) <= set(LOOKING)
