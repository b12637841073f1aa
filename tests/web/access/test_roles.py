"""Each route says which role it needs, so that none is forgotten."""

from __future__ import annotations

import pytest
from starlette.routing import BaseRoute

from robophm.web.access.roles import ROLES, changes, declared_role, may, role_needed
from robophm.web.app import api, routers

ROUTES = [route for router in routers() for route in router.routes]


def name(route: BaseRoute) -> str:
    return f"{','.join(getattr(route, 'methods', ['websocket']))} {getattr(route, 'path', route)}"


@pytest.mark.parametrize("route", ROUTES, ids=name)
def test_a_route_that_changes_something_declares_the_role_that_it_needs(route: BaseRoute) -> None:
    assert getattr(route, "endpoint", None), "a router within a router hides what its routes declare"
    assert not changes(route) or declared_role(route) in ROLES, "expected @needs(…) right above the function"


def test_roles_of_requests() -> None:
    def needed(method: str, path: str) -> str:
        return role_needed({"type": "http", "method": method, "path": path, "root_path": ""}, ROUTES)

    assert needed("GET", "/api/design") == needed("HEAD", "/") == needed("POST", "/api/tasks/predict") == "viewer"
    assert needed("POST", "/api/monitoring/stop") == needed("DELETE", "/api/jobs/5") == "operator"
    assert needed("POST", "/api/design/edits") == needed("PUT", "/api/design/text") == "editor"
    assert needed("POST", "/api/what/nobody/declared") == needed("DELETE", "/api/design") == "editor"
    assert role_needed({"type": "websocket", "path": "/api/live", "root_path": ""}, ROUTES) == "viewer"


def test_each_role_may_do_what_those_before_it_may() -> None:
    assert [[may(role, needed) for needed in ROLES] for role in ROLES] == [
        [True, False, False],
        [True, True, False],
        [True, True, True],
    ]


def test_the_schema_tells_the_role_of_each_route() -> None:
    paths = api().openapi()["paths"]
    assert {one["x-role"] for methods in paths.values() for one in methods.values()} == set(ROLES)
    assert paths["/api/monitoring/start"]["post"]["x-role"] == "operator"
