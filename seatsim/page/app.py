"""The addresses of the page: itself, what it shows of a request, and saving a scenario."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from pathlib import Path
from threading import Lock, get_ident
from typing import TYPE_CHECKING

import jinja2
from markupsafe import Markup
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp

from seatsim.page.guard import POLICY, Guard
from seatsim.report.rendering import digest_of, make_environment, read_asset
from seatsim.schema.errors import InputError, RunError, SeatsimError
from seatsim.schema.files import write_text
from seatsim.schema.guarded import temporary_folder
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    from seatsim.page.recording_view import RecordingView
    from seatsim.page.scenario_view import ScenarioView, View

SCRIPTS = ("uPlot.iife.min.js", "charts.js", "page.js")
STYLES = ("uPlot.min.css", "report.css", "page.css")
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store"}
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._ -]{0,80}")
_WAITING = "wait"
"""In the address of the request that is answered when everything is loaded."""


def make_app(target: Future[ScenarioView | RecordingView], folder: Path, token: str, port: int) -> ASGIApp:
    """Return the page of a scenario or recording, which writes files of one folder alone.

    Until its target is loaded, the page says so; every other request waits.
    """
    page = _Page(target, folder)
    posted = {"/view": page.compute, "/save": page.save, "/stop": page.stop}
    routes = [Route("/", page.show, methods=["GET"])]
    routes += [Route(path, answer, methods=["POST"]) for path, answer in posted.items()]
    return Guard(Starlette(routes=routes), token, port)


class Stopped(BaseException):
    """Is raised in the thread that computes, wherever it is, as Ctrl-C is in a command."""


class _Page:
    """Answers the requests of one target, one at a time."""

    def __init__(self, target: Future[ScenarioView | RecordingView], folder: Path) -> None:
        self._target, self._folder, self._lock = target, folder, Lock()
        self._thread: int | None = None
        script, style = read_asset(SCRIPTS), read_asset(STYLES)
        policy = POLICY.format(script=digest_of(script), style=digest_of(style))
        self._headers = HEADERS | {"Content-Security-Policy": policy}
        loaders = [jinja2.PackageLoader("seatsim.report"), jinja2.PackageLoader("seatsim.page")]
        environment = make_environment().overlay(loader=jinja2.ChoiceLoader(loaders))
        self._page, self._parts = map(environment.get_template, ("page.html", "parts.html"))
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
        return await self._answer(request, self._show)

    async def save(self, request: Request) -> Response:
        """Write a scenario of some values into the folder."""
        return await self._answer(request, self._save)

    async def stop(self, _request: Request) -> Response:
        """End what is being computed, after the step of compiled code that it is in, once."""
        thread, self._thread = self._thread, None
        if thread is not None:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(Stopped))
        return JSONResponse({}, headers=self._headers)

    async def _answer(self, request: Request, compute: Callable[[Mapping[str, object]], object]) -> Response:
        """Return what follows from the values of a request, or what is wrong with them."""
        try:
            found = await run_in_threadpool(compute, await _read_values(request))
        except SeatsimError as error:
            return JSONResponse({"error": str(error)}, status_code=422, headers=self._headers)
        return JSONResponse(found, headers=self._headers)

    def _show(self, values: Mapping[str, object]) -> object:
        view = self._compute(values)
        parts = {name: str(getattr(self._parts.module, name)(view)) for name in ("tables", "gains")}
        return {"answer": view.answer, "signals": view.signals.data, "fitted": view.fitted, **parts}

    def _compute(self, values: Mapping[str, object]) -> View:
        with self._lock:
            self._thread = get_ident()
            try:
                return self._target.result().show(values)
            except Stopped:
                raise RunError("stopped: what is shown belongs to the values before") from None
            finally:
                self._thread = None

    def _save(self, values: Mapping[str, object]) -> object:
        # Loading these takes longer than everything that the first page needs.
        from seatsim.scenario.loading import single

        path = name_new(self._folder, str(values.get("name", "")))
        content = {**self._target.result().encode(values), "name": path.stem}
        with temporary_folder() as drafts:
            # What could not be read again is never saved.
            single(write_text(Path(drafts) / path.name, dump(content)))
        return {"saved": write_text(path, dump(content)).name}


def name_new(folder: Path, name: str) -> Path:
    """Return the path of a new scenario in a folder.

    Raises:
        InputError: the name cannot be used, or is taken.
    """
    stem = name.strip().removesuffix(".yaml")
    if not _NAME.fullmatch(stem):
        raise InputError(f"{name!r}: a name of letters, digits, spaces, '.', '-' and '_', beginning with a letter")
    path = folder / f"{stem}.yaml"
    if path.exists():
        raise InputError(f"{path.name}: is there already, and is not replaced; give another name")
    return path


async def _read_values(request: Request) -> dict[str, object]:
    if request.headers.get("content-type", "").partition(";")[0] != "application/json":
        raise InputError("a request holds JSON")
    try:
        found = await request.json()
    except ValueError as error:
        raise InputError("a request holds JSON") from error
    if not isinstance(found, dict):
        raise InputError("a request holds one JSON object")
    return found
