"""Messages received by a station, sorted: types of messages, and texts."""

from __future__ import annotations

from typing import Any


def types(messages: list[Any]) -> list[str]:
    return [one.get_type() for one in messages]


def texts(messages: list[Any]) -> list[str]:
    return [one.text for one in messages if one.get_type() == "STATUSTEXT"]
