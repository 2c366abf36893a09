"""The addresses of the page: itself, what it shows of a request, files of its folder, and saving a scenario."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Future
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

import jinja2
from markupsafe import Markup
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp

from seatsim.page.folder import Folder, NotInFolderError, TooLargeError
from seatsim.page.guard import POLICY, Guard
from seatsim.report.rendering import digest_of, make_environment, read_asset
from seatsim.schema.errors import InputError, SeatsimError
from seatsim.schema.files import write_text
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    from seatsim.page.recording_view import RecordingView
    from seatsim.page.scenario_view import ScenarioView

SCRIPTS = ("uPlot.iife.min.js", "charts.js", "page.js")
STYLES = ("uPlot.min.css", "report.css", "page.css")
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store"}
_READABLE = (".yaml", ".yml")
"""Endings of files that are shown as they are."""
_WAITING = "wait"
"""In the address of the request that is answered when everything is loaded."""


def make_app(target: Future[ScenarioView | RecordingView], folder: Folder, token: str, port: int) -> ASGIApp:
    """Return the page of a scenario or recording, which reads and writes files of one folder alone.

    Until its target is loaded, the page says so; every other request waits.
    """
    page = _Page(target, folder)
    app = Starlette(
        routes=[
            Route("/", page.show, methods=["GET"]),
            Route("/view", page.compute, methods=["POST"]),
            Route("/save", page.save, methods=["POST"]),
            Route("/files/{path:path}", page.read, methods=["GET"]),
        ]
    )
    return Guard(app, token, port)


class _Page:
    """Answers the requests of one target, one at a time."""

    def __init__(self, target: Future[ScenarioView | RecordingView], folder: Folder) -> None:
        self._target, self._folder, self._lock = target, folder, Lock()
        script, style = read_asset(SCRIPTS), read_asset(STYLES)
        self._headers = HEADERS | {
            "Content-Security-Policy": POLICY.format(script=digest_of(script), style=digest_of(style))
        }
        environment = make_environment().overlay(
            loader=jinja2.ChoiceLoader([jinja2.PackageLoader("seatsim.report"), jinja2.PackageLoader("seatsim.page")])
        )
        self._tables = environment.get_template("tables.html")
        self._page = environment.get_template("page.html")
        self._given = {"script": Markup(script), "style": Markup(style)}
        self._loading = environment.get_template("loading.html").render(style=Markup(style))

    async def show(self, request: Request) -> Response:
        """Return the page with what it shows at first, or one that asks for it and is replaced by it."""
        if not self._target.done() and _WAITING not in request.query_params:
            return HTMLResponse(self._loading, headers=self._headers | {"Refresh": f"0; url=/?{_WAITING}"})
        try:
            view = await run_in_threadpool(self._compute, {})
        except SeatsimError as error:
            return PlainTextResponse(f"{error}\n", status_code=422, headers=self._headers)
        text = self._page.render(target=self._target.result(), view=view, **self._given)
        return HTMLResponse(text, headers=self._headers)

    async def compute(self, request: Request) -> Response:
        """Return what is shown of some values."""
        try:
            values = await _read_values(request)
            view = await run_in_threadpool(self._compute, values)
        except SeatsimError as error:
            return JSONResponse({"error": str(error)}, status_code=422, headers=self._headers)
        tables = self._tables.render(tables=view.tables)
        content = {"answer": view.answer, "tables": tables, "signals": view.signals.data}
        return JSONResponse(content, headers=self._headers)

    async def save(self, request: Request) -> Response:
        """Write a scenario of some values into the folder."""
        try:
            values = await _read_values(request)
            path = await run_in_threadpool(self._save, values)
        except SeatsimError as error:
            return JSONResponse({"error": str(error)}, status_code=422, headers=self._headers)
        return JSONResponse({"saved": path.name}, headers=self._headers)

    async def read(self, request: Request) -> Response:
        """Return a scenario or the head of a recording as text."""
        try:
            path = self._folder.find(request.path_params["path"])
        except NotInFolderError as error:
            return PlainTextResponse(f"{error}\n", status_code=404, headers=self._headers)
        except TooLargeError as error:
            return PlainTextResponse(f"{error}\n", status_code=413, headers=self._headers)
        if path.suffix not in _READABLE or not path.is_file():
            return PlainTextResponse("Only scenarios and recordings are shown.\n", status_code=404)
        return PlainTextResponse(path.read_text(encoding="utf-8", errors="replace"), headers=self._headers)

    def _compute(self, values: Mapping[str, Any]) -> Any:
        with self._lock:
            return self._target.result().show(values)

    def _save(self, values: Mapping[str, Any]) -> Path:
        # Loading these takes longer than everything that the first page needs.
        from seatsim.scenario.loading import single

        path = self._folder.name_new(str(values.get("name", "")))
        content = {**self._target.result().encode(values), "name": path.stem}
        with temporary_folder() as drafts:
            # What could not be read again is never saved.
            single(write_text(Path(drafts) / path.name, dump(content)))
        return write_text(path, dump(content))


async def _read_values(request: Request) -> dict[str, Any]:
    if request.headers.get("content-type", "").partition(";")[0] != "application/json":
        raise InputError("a request holds JSON")
    try:
        found = await request.json()
    except ValueError as error:
        raise InputError("a request holds JSON") from error
    if not isinstance(found, dict):
        raise InputError("a request holds one JSON object")
    return found
