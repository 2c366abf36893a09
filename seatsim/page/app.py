"""The page on loopback: a free port, an address with a token, a browser; what it answers, and whom."""

from __future__ import annotations

import ctypes
import hmac
import re
import secrets
import socket
import threading
import webbrowser
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from threading import Lock, get_ident
from typing import TYPE_CHECKING

import jinja2
import uvicorn
from markupsafe import Markup
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers, QueryParams
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Receive, Scope, Send

from seatsim.report.rendering import digest_of, make_environment, read_asset
from seatsim.scenario.loading import find_file
from seatsim.schema.errors import InputError, RunError, SeatsimError
from seatsim.schema.files import write_text
from seatsim.schema.yaml_text import dump

if TYPE_CHECKING:
    from seatsim.page.recording_view import RecordingView
    from seatsim.page.scenario_view import ScenarioView, View

_POLICY = (
    "default-src 'none'; img-src data:; script-src {script}; style-src {style}; connect-src 'self'; form-action 'none';"
    " frame-ancestors 'none'; base-uri 'none'"
)
_LARGEST_BODY = 100_000
"""Bytes of a request that are read."""


class _Guard:
    """Lets a request pass if its Host is loopback, its Origin none or the page itself, and it has the token.

    A foreign Host or Origin is answered by 403, so that no other site's page can reach this one (DNS rebinding, forged
    requests). The token comes with the first address and is kept in a cookie that scripts cannot read.
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        """Guard `app`, which is served at `port` of loopback."""
        self._app, self._token = app, token
        # Cookies of one host are shared by all of its ports, on which other pages may be open.
        self._cookie = f"seatsim-{port}"
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request or refuse it."""
        await (self._app if scope["type"] == "lifespan" else self._choose(scope))(scope, receive, send)

    def _choose(self, scope: Scope) -> ASGIApp:
        """Return the page for a request that may pass, or else an answer that refuses it or takes its token."""
        headers = Headers(scope=scope)
        if scope["type"] != "http" or headers.get("host") not in self._hosts:
            return PlainTextResponse("This page is served to this machine alone.\n", status_code=403)
        if headers.get("origin", f"http://{headers['host']}") not in {f"http://{host}" for host in self._hosts}:
            return PlainTextResponse("Requests of other pages are refused.\n", status_code=403)
        if int(headers.get("content-length") or 0) > _LARGEST_BODY or "transfer-encoding" in headers:
            return PlainTextResponse("The request is too large.\n", status_code=413)
        if self._has_token(QueryParams(scope["query_string"]).get("token")):
            # The token leaves the address, which stays in the browser's history.
            answer = RedirectResponse("/", status_code=303)
            answer.set_cookie(self._cookie, self._token, httponly=True, samesite="strict")
            return answer
        if self._has_token(HTTPConnection(scope).cookies.get(self._cookie)):
            return self._app
        text = "Open the address that seatsim explore printed: it holds the token of this page.\n"
        return PlainTextResponse(text, status_code=403)

    def _has_token(self, given: str | None) -> bool:
        return hmac.compare_digest((given or "").encode(), self._token.encode())


SCRIPTS = ("uPlot.iife.min.js", "charts.js", "page.js")
STYLES = ("uPlot.min.css", "report.css", "page.css")
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store"}
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._ -]{0,80}")


def make_app(target: ScenarioView | RecordingView, folder: Path, token: str, port: int) -> ASGIApp:
    """Return the page of a scenario or recording, which writes files of one folder alone."""
    page = _Page(target, folder)
    routes = [Route("/", page.show, methods=["GET"]), Route("/stop", page.stop, methods=["POST"])]
    for path, compute in (("/view", page.view), ("/save", page.save)):
        routes.append(Route(path, partial(page.answer, compute), methods=["POST"]))
    return _Guard(Starlette(routes=routes), token, port)


class _Stopped(BaseException):
    """Is raised in the thread that computes, wherever it is, as Ctrl-C is in a command."""


class _Page:
    """Answers the requests of one target, one at a time."""

    def __init__(self, target: ScenarioView | RecordingView, folder: Path) -> None:
        self._target, self._folder, self._lock = target, folder, Lock()
        self._thread: int | None = None
        script, style = read_asset(SCRIPTS), read_asset(STYLES)
        policy = _POLICY.format(script=digest_of(script), style=digest_of(style))
        self._headers = HEADERS | {"Content-Security-Policy": policy}
        loaders = [jinja2.PackageLoader("seatsim.report"), jinja2.PackageLoader("seatsim.page")]
        environment = make_environment().overlay(loader=jinja2.ChoiceLoader(loaders))
        self._page, self._parts = map(environment.get_template, ("page.html", "parts.html"))
        self._given = {"script": Markup(script), "style": Markup(style)}

    async def show(self, request: Request) -> Response:
        """Return the page with what it shows at first."""
        try:
            view = await run_in_threadpool(self._compute, {})
        except SeatsimError as error:
            return PlainTextResponse(f"{error}\n", status_code=422, headers=self._headers)
        text = self._page.render(target=self._target, view=view, **self._given)
        return HTMLResponse(text, headers=self._headers)

    async def stop(self, _request: Request) -> Response:
        """End what is being computed, after the step of compiled code that it is in, once."""
        thread, self._thread = self._thread, None
        if thread is not None:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(_Stopped))
        return JSONResponse({}, headers=self._headers)

    async def answer(self, compute: Callable[[Mapping[str, object]], object], request: Request) -> Response:
        """Return what follows from the values of a request, or what is wrong with them."""
        try:
            found = await run_in_threadpool(compute, await _read_values(request))
        except SeatsimError as error:
            return JSONResponse({"error": str(error)}, status_code=422, headers=self._headers)
        return JSONResponse(found, headers=self._headers)

    def view(self, values: Mapping[str, object]) -> object:
        """Return what is shown of some values."""
        view = self._compute(values)
        parts = {name: str(getattr(self._parts.module, name)(view)) for name in ("tables", "gains")}
        return {"answer": view.answer, "signals": view.signals.data, "fitted": view.fitted, **parts}

    def _compute(self, values: Mapping[str, object]) -> View:
        with self._lock:
            self._thread = get_ident()
            try:
                return self._target.show(values)
            except _Stopped:
                raise RunError("stopped: what is shown belongs to the values before") from None
            finally:
                self._thread = None

    def save(self, values: Mapping[str, object]) -> object:
        """Write a scenario of some values into the folder; return its name."""
        # Loading these takes longer than everything that the first page needs.
        from seatsim.scenario.loading import single

        path = _name_new(self._folder, str(values.get("name", "")))
        content = {**self._target.encode(values), "name": path.stem}
        single(content)  # what could not be read again is never saved
        return {"saved": write_text(path, dump(content)).name}


def _name_new(folder: Path, name: str) -> Path:
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


_HOST = "127.0.0.1"


def open_target(path: Path) -> ScenarioView | RecordingView:
    """Return what the page shows of a recording's folder, a scenario or an example; its models are loaded here.

    Raises:
        InputError: there is no such file, or it or the recording has a fault.
    """
    if path.is_dir():
        from seatsim.page.recording_view import RecordingView

        return RecordingView(path)
    from seatsim.page.scenario_view import ScenarioView

    return ScenarioView(find_file(path))


def serve(
    target: ScenarioView | RecordingView, folder: Path, port: int, browser: bool, say: Callable[[str], None]
) -> None:
    """Serve the page until it is interrupted.

    Args:
        target: what it shows.
        folder: from which it reads, and into which it saves.
        port: of loopback; 0 takes a free one.
        browser: whether a browser is opened.
        say: is called with the address.

    Raises:
        InputError: the port is taken.
    """
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((_HOST, port))
    except OSError as error:
        raise InputError(f"--port {port}: {error.strerror}; give another port, or 0 for a free one") from error
    listener.listen()  # who asks before the server runs is kept waiting, and not refused
    taken, token = listener.getsockname()[1], secrets.token_urlsafe(24)
    address = f"http://{_HOST}:{taken}/?token={token}"
    app = make_app(target, folder.resolve(), token, taken)
    settings = uvicorn.Config(app, log_level="warning", access_log=False, server_header=False)
    say(address)
    if browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    uvicorn.Server(settings).run(sockets=[listener])
