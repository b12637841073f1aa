"""The schema in the documents is the service's own, and the service keeps to it whatever it is sent."""

import json

import pytest
import schemathesis
from hypothesis import HealthCheck, settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import response_schema_conformance, status_code_conformance

from robophm.web.app import api

from .conftest import ROOT

DOCUMENT = ROOT / "docs" / "reference" / "openapi.json"
HOW = "python -c \"from robophm.web.app import write_schema; write_schema('docs/reference/openapi.json')\""


def test_the_document_is_the_services_own():
    assert json.loads(DOCUMENT.read_text(encoding="utf-8")) == api().openapi(), f"make it anew: {HOW}"


def test_routes_of_another_package_are_found(tmp_path, monkeypatch):
    (tmp_path / "their_routes.py").write_text(
        "from fastapi import APIRouter\n\nrouter = APIRouter()\n\n\n"
        "@router.get('/api/theirs')\ndef get_theirs() -> int:\n    return 5\n"
    )
    about = tmp_path / "theirs-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[robophm.web.routes]\ntheirs = their_routes\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert "/api/theirs" in api().openapi()["paths"]


schema = schemathesis.openapi.from_dict(json.loads(DOCUMENT.read_text(encoding="utf-8")))
schema.config.phases.coverage.enabled = False  # it makes bodies of tens of megabytes, to no end but to be refused
CHECKS = (not_a_server_error, status_code_conformance, response_schema_conformance)
STARTS = ("/api/monitoring/start", "/api/new/example", "/api/topics")
"""What reaches for robots on the network, or takes seconds: tested by itself."""


def examples(number):
    return settings(
        max_examples=number, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
    )


@schema.exclude(path=list(STARTS)).parametrize()
@examples(3)
def test_whatever_it_is_sent_it_answers_as_it_says(case, shared_small):
    case.call_and_validate(base_url=shared_small.address.rstrip("/"), checks=CHECKS, timeout=60)


@pytest.mark.full
@schema.exclude(path=list(STARTS)).parametrize()
@examples(100)
def test_whatever_it_is_sent_often(case, shared_small):
    case.call_and_validate(base_url=shared_small.address.rstrip("/"), checks=CHECKS, timeout=60)
