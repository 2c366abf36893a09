"""Who may use the page: a browser on this machine that was given its token."""

from __future__ import annotations

import hmac

from starlette.datastructures import Headers, QueryParams
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, RedirectResponse
from starlette.types import ASGIApp, Receive, Scope, Send

POLICY = (
    "default-src 'none'; img-src data:; script-src {script}; style-src {style}; connect-src 'self'; form-action 'none';"
    " frame-ancestors 'none'; base-uri 'none'"
)
_LARGEST_BODY = 100_000
"""Bytes of a request that are read."""


class Guard:
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
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refused = self._refuse(scope, Headers(scope=scope))
        if refused is not None:
            await refused(scope, receive, send)
        elif self._has_token(QueryParams(scope["query_string"]).get("token")):
            # The token leaves the address, which stays in the browser's history.
            answer = RedirectResponse("/", status_code=303)
            answer.set_cookie(self._cookie, self._token, httponly=True, samesite="strict")
            await answer(scope, receive, send)
        elif self._has_token(HTTPConnection(scope).cookies.get(self._cookie)):
            await self._app(scope, receive, send)
        else:
            text = "Open the address that seatsim explore printed: it holds the token of this page.\n"
            await PlainTextResponse(text, status_code=403)(scope, receive, send)

    def _refuse(self, scope: Scope, headers: Headers) -> PlainTextResponse | None:
        if scope["type"] != "http" or headers.get("host") not in self._hosts:
            return PlainTextResponse("This page is served to this machine alone.\n", status_code=403)
        origin = headers.get("origin")
        if origin is not None and origin not in {f"http://{host}" for host in self._hosts}:
            return PlainTextResponse("Requests of other pages are refused.\n", status_code=403)
        if int(headers.get("content-length") or 0) > _LARGEST_BODY or "transfer-encoding" in headers:
            return PlainTextResponse("The request is too large.\n", status_code=413)
        return None

    def _has_token(self, given: str | None) -> bool:
        return hmac.compare_digest((given or "").encode(), self._token.encode())
