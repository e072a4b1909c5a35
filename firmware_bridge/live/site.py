"""The files of the live page, and the answer to each HTTP request: the page, the WebSocket, or a refusal.

Only who has the token is served, and only under the address that was printed: a page of another origin, or
one whose name was made to lead here (DNS rebinding), is refused. The page may load and reach nothing else.
"""

import base64
import hashlib
import hmac
import re
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from importlib.resources import files
from types import MappingProxyType
from typing import Final

PAGE: Final = "page.html"
WEBSOCKET: Final = "ws"
VENDORED: Final[Mapping[str, str]] = MappingProxyType(
    {"uplot.js": "text/javascript", "uplot.css": "text/css"}
)
"""Files of uPlot beside the page, by their type; without them the page shows values and no plots."""
_SCRIPT: Final = re.compile(r"<script>(.*?)</script>", re.DOTALL)
_STYLE: Final = re.compile(r"<style>(.*?)</style>", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Answer:
    """An HTTP response; an `OK` without a content type opens the WebSocket."""

    status: HTTPStatus
    content_type: str = ""
    body: bytes = b""
    policy: str = ""
    """Content-Security-Policy."""

    @property
    def opens(self) -> bool:
        """True where the WebSocket is opened."""
        return self.status is HTTPStatus.SWITCHING_PROTOCOLS


@dataclass(frozen=True, slots=True)
class PageRequest:
    """What matters of an HTTP request."""

    path: str
    host: str
    origin: str
    """Empty where the client states none, as programs and a browser's own navigation do."""


class LiveSite:
    """The page's files, under a token."""

    def __init__(self, token: str, port: int) -> None:
        """Take the token of the address, and the port that it names."""
        self._token: Final = token
        self._hosts: Final = frozenset(f"{name}:{port}" for name in ("127.0.0.1", "localhost"))
        self._files: Final = _files()

    def answer(self, request: PageRequest) -> Answer:
        """Return the answer to a request; what is refused learns no more than the status."""
        if request.host not in self._hosts:
            return _refused(HTTPStatus.MISDIRECTED_REQUEST)
        if request.origin and request.origin.removeprefix("http://") not in self._hosts:
            return _refused(HTTPStatus.FORBIDDEN)
        token, slash, name = request.path.removeprefix("/").partition("/")
        if not slash or not hmac.compare_digest(token.encode(), self._token.encode()):
            return _refused(HTTPStatus.FORBIDDEN)
        if name == WEBSOCKET:
            # A browser always states where a WebSocket's page comes from.
            return Answer(HTTPStatus.SWITCHING_PROTOCOLS)
        return self._files.get(name) or _refused(HTTPStatus.NOT_FOUND)


def _refused(status: HTTPStatus) -> Answer:
    return Answer(status, "text/plain; charset=utf-8", f"{status.value} {status.phrase}\n".encode())


def _files() -> Mapping[str, Answer]:
    """Return the answers by the last part of the path; the page has the empty name."""
    folder = files("firmware_bridge.live")
    page = (folder / PAGE).read_text(encoding="utf-8")
    sources = f"{_hashes(_SCRIPT, page)} 'self'", f"{_hashes(_STYLE, page)} 'self'"
    policy = (
        f"default-src 'none'; script-src {sources[0]}; style-src {sources[1]}; connect-src 'self'; "
        "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    found = {"": Answer(HTTPStatus.OK, "text/html; charset=utf-8", page.encode(), policy)}
    for name, kind in VENDORED.items():
        place = folder / name
        if place.is_file():
            found[name] = Answer(HTTPStatus.OK, f"{kind}; charset=utf-8", place.read_bytes(), policy)
    return MappingProxyType(found)


def _hashes(pattern: re.Pattern[str], page: str) -> str:
    """Return the sources that a policy allows by their content, as CSP has them."""
    found = (hashlib.sha256(part.encode()).digest() for part in pattern.findall(page))
    return " ".join(f"'sha256-{base64.b64encode(one).decode()}'" for one in found)
