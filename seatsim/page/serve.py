"""The page on loopback: a free port, an address with a token, a browser."""

from __future__ import annotations

import secrets
import socket
import threading
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import uvicorn

from seatsim.page.app import make_app
from seatsim.page.folder import LARGEST, Folder
from seatsim.scenario.loading import find_file
from seatsim.schema.errors import InputError

if TYPE_CHECKING:
    from seatsim.page.recording_view import RecordingView
    from seatsim.page.scenario_view import ScenarioView

HOST = "127.0.0.1"


def open_target(path: Path) -> ScenarioView | RecordingView:
    """Return what the page shows of a path: a folder is a recording, a file or the name of an example a scenario.

    Raises:
        InputError: it is neither, or larger than the page reads.
    """
    if path.is_dir():
        for file in path.iterdir():
            if file.is_file() and file.stat().st_size > LARGEST:
                raise InputError(f"{file}: larger than {LARGEST / 1e6:.0f} MB, which is the most that the page reads")
        # The views are loaded when they are wanted: what a diagnosis needs takes a second, which a scenario is spared.
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
        listener.bind((HOST, port))
    except OSError as error:
        raise InputError(f"--port {port}: {error.strerror}; give another port, or 0 for a free one") from error
    taken, token = listener.getsockname()[1], secrets.token_urlsafe(24)
    address = f"http://{HOST}:{taken}/?token={token}"
    app = make_app(target, Folder(folder), token, taken)
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", access_log=False, server_header=False))
    say(address)
    if browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    server.run(sockets=[listener])
