"""Data in and out: examples, parts lists, files of the 2020 tool, the report, metrics."""

from __future__ import annotations

import json
import tempfile
import threading
from pathlib import Path as File
from typing import Annotated, Any

from fastapi import APIRouter, Body, Query
from fastapi.responses import HTMLResponse, PlainTextResponse, Response

from robophm.core.errors import DesignError, nearest
from robophm.drafting.received import file_name
from robophm.health.reporting import health_report
from robophm.monitoring.seen_wear import seen_wear, with_alarms
from robophm.monitoring.told_past import told_past
from robophm.report.health_page import health_page
from robophm.report.pdf import Printer
from robophm.report.words import rate_text
from robophm.stores import open_store, store_exists
from robophm.web.access.roles import needs
from robophm.web.guard import REPORT_POLICY
from robophm.web.metrics import metrics_text
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served, Service
from robophm.web.shapes import DesignText, Imported, Shape

router = APIRouter(tags=["data"])

MOST_UPLOADED = 20_000_000
Upload = Annotated[bytes, Body(media_type="application/octet-stream", max_length=MOST_UPLOADED)]
FileName = Annotated[str, Query(min_length=1, max_length=200)]


_PRINTING = threading.Lock()
"""A PDF takes seconds and a hundred megabytes: one at a time."""


class PdfResponse(Response):
    """A response that is a PDF file."""

    media_type = "application/pdf"


class Example(Shape):
    """An example design that is part of the package."""

    name: str
    title: str


class Examples(Shape):
    """All example designs."""

    examples: list[Example]


_EXAMPLES = {
    "ota": ("ota/robot.yaml", "The OTA of the paper: a transport robot of 47 parts"),
    "ota-handbook": ("ota/handbook.yaml", "The same, its rates computed from handbook models"),
    "arm": ("arm/robot.yaml", "A six-joint arm"),
    "drone": ("drone/robot.yaml", "A drone"),
}


@router.get("/api/examples")
def get_examples() -> Examples:
    """The example designs that are part of the package."""
    return Examples(examples=[Example(name=name, title=title) for name, (_, title) in _EXAMPLES.items()])


@router.get("/api/examples/{name}", responses=REFUSED)
def get_example(name: str) -> DesignText:
    """The text of an example design."""
    if name not in _EXAMPLES:
        raise DesignError(f"no example '{name}'{nearest(name, _EXAMPLES)}")
    return DesignText(revision=0, text=_folder().joinpath(_EXAMPLES[name][0]).read_text(encoding="utf-8"))


def _folder() -> File:
    package = File(__file__).parents[2]
    for folder in (package / "examples", package.parents[1] / "examples"):
        if (folder / "ota" / "robot.yaml").is_file():
            return folder
    raise DesignError("the examples are not installed")


@router.post("/api/imports/parts-list", responses=REFUSED)
@needs("editor")
def import_parts(
    body: Upload,
    service: Served,
    name: FileName,
    module: Annotated[str, Query(max_length=2000)] = "",
    columns: Annotated[list[str] | None, Query(max_length=40)] = None,
) -> Imported:
    """The design with a parts list (.csv, .xlsx, .ods) added, to be looked at; nothing is changed.

    ``columns`` say what a header means, where it is not what was found: 'part_number=Manufacturer number'.
    """
    from robophm.design.importers.bom import assumed_inputs, import_bom
    from robophm.design.importers.bom.columns import FIELDS, ColumnMapping

    said = dict(pair.partition("=")[::2] for pair in columns or ())
    with tempfile.TemporaryDirectory(prefix="robophm-") as folder:
        source, design = File(folder) / file_name(name), File(folder) / "design" / "robot.yaml"
        design.parent.mkdir()
        source.write_bytes(body)
        design.write_text(service.workspace.draft().text, encoding="utf-8")
        try:
            service.prepared()
        except DesignError:  # nothing yet: the list is the design
            design.unlink()
        mapping = ColumnMapping(said)
        steps = [step for step in module.split("/") if step]
        try:
            found = import_bom(source, design, mapping=mapping, module=steps)
        except DesignError as error:
            raise DesignError(str(error).replace(f"{folder}/design/", "").replace(f"{folder}/", "")) from None
    rows = [
        [
            one.part.name, str(one.part.quantity), one.rating.by if one.rating else "–",
            rate_text(one.hazard_rate) if one.hazard_rate is not None else "to be rated by hand",
            ", ".join(f"{name.replace('_', ' ')} {value}" for (name, (value,)) in assumed_inputs([one]).items()),
            one.outcome.state,
        ]
        for one in found.parts
    ]  # fmt: skip
    table = found.parts_list.table
    kept = [f"{one.name}: {one.state} {one.text}".strip() for one in found.removed]
    return Imported(
        text=found.text, findings=kept, rows=rows,
        columns=["part", "quantity", "model", "rate of one", "assumed", "what"],
        mapping={column.field: column.header for column in table.columns}, unused=list(table.unused),
        fields=list(FIELDS),
    )  # fmt: skip


@router.post("/api/imports/legacy", responses=REFUSED)
@needs("editor")
def import_2020(body: Upload, name: FileName = "phm_configurations.yaml") -> Imported:
    """The design that a file of the 2020 tool becomes, to be looked at; nothing is changed."""
    from robophm.design.importers.legacy.reading import import_legacy

    with tempfile.TemporaryDirectory(prefix="robophm-") as folder:
        source = File(folder) / file_name(name)
        source.write_bytes(body)
        try:
            found = import_legacy(source)
        except DesignError as error:
            raise DesignError(str(error).replace(f"{folder}/", "")) from None
    rows = [
        [figure.path or found.robot.name, "–" if figure.stored is None else rate_text(figure.stored),
         rate_text(figure.recomputed)]
        for figure in found.figures
    ]  # fmt: skip
    findings = [str(finding) for finding in found.findings]
    return Imported(text=found.text, findings=findings, columns=["level", "λ stored", "λ recomputed, 2020 tool"],
                    rows=rows)  # fmt: skip


@router.get("/api/report", response_class=HTMLResponse, responses=REFUSED)
def get_report(service: Served, download: bool = False, short: bool = False) -> HTMLResponse:
    """The robot's health on one page that needs nothing else; ``short``: without what it follows from."""
    headers = {"content-security-policy": REPORT_POLICY}
    if download:
        headers["content-disposition"] = 'attachment; filename="health.html"'
    return HTMLResponse(_report(service, short=short), headers=headers)


@router.get("/api/report.pdf", response_class=PdfResponse, responses=REFUSED)
def get_report_as_pdf(service: Served, short: bool = False) -> PdfResponse:
    """The report as PDF; refused where the package that makes a PDF is not installed."""
    printer = Printer()
    with _PRINTING:
        return PdfResponse(
            printer.pdf(_report(service, short=short)),
            headers={"content-disposition": 'attachment; filename="health.pdf"'},
        )


def _report(service: Service, *, short: bool) -> str:
    prepared = service.prepared()
    exposure, ledger = service.past(prepared)
    settled = exposure.settled(ledger)
    wear = with_alarms(prepared.robot, settled, seen_wear(prepared.robot, settled))
    report = health_report(prepared.plant, exposure, settled, task=prepared.robot.task, wear=wear)
    past = None
    if (store := service.settings.store) and store_exists(store):
        with open_store(store) as kept:
            past = told_past(kept.history(prepared.robot.identity), report)
    return health_page(prepared.robot, report, past, ledger.to_json(), short=short)


@router.get("/api/grafana")
def get_dashboard() -> dict[str, Any]:
    """A dashboard for Grafana, of what /metrics says."""
    found: dict[str, Any] = json.loads(File(__file__).parents[1].joinpath("grafana.json").read_text(encoding="utf-8"))
    return found


@router.get("/metrics", response_class=PlainTextResponse)
def get_metrics(service: Served) -> PlainTextResponse:
    """The latest figures, for Prometheus."""
    return PlainTextResponse(metrics_text(service), media_type="text/plain; version=0.0.4")
