"""The page on loopback: a free port, an address with a token, a browser."""

from __future__ import annotations

import asyncio
import secrets
import socket
import threading
import webbrowser
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from seatsim.page.app import make_app
from seatsim.scenario.loading import find_file
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from seatsim.page.recording_view import RecordingView
    from seatsim.page.scenario_view import ScenarioView

_HOST = "127.0.0.1"
_LARGEST = 50_000_000
"""Bytes of the largest file that is read."""


class Impatient(H11Protocol):
    """A connection that is closed where no whole request comes, so that none who is silent can hold it open."""

    idle = 30.0
    """s; after twice this time at the latest it is closed."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as in uvicorn
        """Begin to look after the connection."""
        super().connection_made(transport)
        self.loop.call_later(self.idle, self._look, None)

    def _look(self, before: object) -> None:
        """Close the connection if it waits for the rest of the same request as at the last look, or for a first one."""
        cycle = self.cycle
        waits = cycle is None or cycle.response_complete or cycle.more_body
        if waits and cycle is before:
            self.transport.close()
        elif not self.transport.is_closing():
            self.loop.call_later(self.idle, self._look, cycle)


def find_target(path: Path) -> Path:
    """Return the path of what the page is to show: the folder of a recording, a scenario, or an example of that name.

    Raises:
        InputError: it is neither, or larger than the page reads.
    """
    if not path.is_dir():
        return find_file(path)
    for file in path.iterdir():
        if file.is_file() and file.stat().st_size > _LARGEST:
            raise InputError(f"{file}: larger than {_LARGEST / 1e6:.0f} MB, which is the most that the page reads")
    return path


def open_target(path: Path) -> ScenarioView | RecordingView:
    """Return what the page shows of a path that `find_target` found; the models are loaded here, not before.

    Raises:
        InputError: the file or the recording has a fault.
    """
    if path.is_dir():
        from seatsim.page.recording_view import RecordingView

        return RecordingView(path)
    from seatsim.page.scenario_view import ScenarioView

    return ScenarioView(path)


def serve(path: Path, folder: Path, port: int, browser: bool, say: Callable[[str], None]) -> None:
    """Serve the page until it is interrupted. Its target is loaded while the page is already answered.

    Args:
        path: what it shows, as `find_target` found it.
        folder: from which it reads, and into which it saves.
        port: of loopback; 0 takes a free one.
        browser: whether a browser is opened.
        say: is called with the address.

    Raises:
        InputError: the port is taken, or the target has a fault.
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
    target = ThreadPoolExecutor(1).submit(open_target, path)
    app = make_app(target, folder.resolve(), token, taken)
    settings = uvicorn.Config(app, http=Impatient, log_level="warning", access_log=False, server_header=False)
    server = uvicorn.Server(settings)

    def end_where_failed(loaded: Future[ScenarioView | RecordingView]) -> None:
        server.should_exit = loaded.exception() is not None

    target.add_done_callback(end_where_failed)
    say(address)
    if browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    server.run(sockets=[listener])
    target.result()
