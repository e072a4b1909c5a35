"""One-line texts of a drive's errors: the problem, its place, and the remedy."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.abort import AbortCode, meaning_of
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.job import (
    Job,
    JobError,
    NetworkJob,
    ReadJob,
    RefusedError,
    SilentError,
    WriteJob,
)
from firmware_bridge.families.epos2.wire.differences import ANY_TYPE
from firmware_bridge.units import MILLISECOND

REMEDIES: Final[Mapping[int, str]] = MappingProxyType(
    {
        AbortCode.TIMEOUT: "is that node on the bus behind the line, with power and the same bit rate?",
        AbortCode.READ_ONLY: "it can be read only",
        AbortCode.WRITE_ONLY: "it can be written only",
        AbortCode.UNSUPPORTED_ACCESS: "it cannot be accessed that way",
        AbortCode.NO_OBJECT: "this drive has no such object; check the index",
        AbortCode.NO_SUBINDEX: "check the sub-index",
        AbortCode.LENGTH: "leave --size out, or give the object's own size",
        AbortCode.TOO_LONG: "leave --size out, or give the object's own size",
        AbortCode.TOO_SHORT: "leave --size out, or give the object's own size",
        AbortCode.RANGE: "choose a value that the object allows",
        AbortCode.TOO_HIGH: "choose a lower value",
        AbortCode.TOO_LOW: "choose a higher value",
        AbortCode.LIMITS_CROSSED: "change the other limit first",
        AbortCode.DEVICE_STATE: "bring the drive into another state first, often `state disable`",
        AbortCode.CANNOT_STORE: "try again with the power stage off",
        AbortCode.WRONG_NMT_STATE: "send `nmt pre-operational` first",
        AbortCode.WRONG_NODE: "nodes are numbered 1 to 127",
        AbortCode.WRONG_PASSWORD: "write `save` or `load`",
        AbortCode.ILLEGAL_COMMAND: "the line was disturbed, or the drive does not know the command",
        AbortCode.CHECKSUM: "the line was disturbed; try again",
    }
)
"""Remedies for a refusal."""


def error_text(failure: JobError, where: str, silence: str) -> str:
    """Return what failed, `where` (a drive for people), and what to do; `silence` is the link's advice."""
    job = failure.job
    what = _what(job)
    if isinstance(failure, RefusedError):
        if failure.code == AbortCode.TIMEOUT:
            return f"{where} does not answer through the drive on the line ({what}): {REMEDIES[failure.code]}"
        remedy = REMEDIES.get(failure.code)
        text = f"{where} refuses {what}: {meaning_of(failure.code)}"
        return f"{text}{_range(job, failure.code)}" + (f"; {remedy}" if remedy else "")
    if isinstance(failure, SilentError):
        return f"{where} does not answer ({what}, {failure.waited // MILLISECOND} ms): {silence}"
    return f"{where} answers {what} with what cannot be understood: {failure.problem}; {silence}"


def _what(job: Job) -> str:
    if isinstance(job, NetworkJob):
        return str(job)
    if isinstance(job, ReadJob):
        return f"to read {ANY_TYPE.called(job.address)}"
    return f"to write {_value(job)} to {ANY_TYPE.called(job.address)}"


def _value(job: WriteJob) -> str:
    row = ANY_TYPE.get(job.address)
    known = row is not None and row.type.size == len(job.raw)
    value = row.type.decode(job.raw) if known and row is not None else None
    return f"0x{int.from_bytes(job.raw, 'little'):0{2 * len(job.raw)}X}" if value is None else f"{value}"


def _range(job: Job, code: int) -> str:
    """Return the bounds that the table knows, where they may be the reason."""
    if code not in {AbortCode.RANGE, AbortCode.TOO_HIGH, AbortCode.TOO_LOW} or isinstance(job, NetworkJob):
        return ""
    return _bounds(job.address)


def _bounds(address: Address) -> str:
    row = ANY_TYPE.get(address)
    if row is None or (row.minimum is None and row.maximum is None):
        return ""
    low, high = row.bounds
    return f" (a 70/10 allows {low} to {high})"
