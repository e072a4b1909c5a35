"""Lines of the control port: one JSON object each, a request from the client and its answer.

Version 1. A request is `{"id": 7, "do": "inject", "fault": "shaft_blocked", "keys": {"node": "one"}}`; the
answer has its `id`, `ok`, the instant `at_s` of the devices' clock, and what was requested or an `error`.
"""

import json
from typing import Any, Final

from firmware_bridge.json_line import JsonLineError, read_object

VERSION: Final = 1


class LineError(Exception):
    """A line that is no request."""


def request_of(line: bytes) -> dict[str, Any]:
    """Return the request in a line; LineError."""
    try:
        request = read_object(line)
    except JsonLineError as error:
        raise LineError(str(error)) from error
    if not isinstance(request.get("do"), str):
        raise LineError('a request is an object with "do": "state", for instance')
    return request


def line_of(answer: dict[str, Any]) -> bytes:
    """Return an answer as a line."""
    return json.dumps(answer, separators=(",", ":")).encode() + b"\n"
