"""What a recording shows, as text, as Markdown for a summary, and as data for programs."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, TypeAlias

from firmware_bridge.explain.explainer import Explained
from firmware_bridge.explain.incident import Evidence, Incident
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

TOGETHER: Final[Nanoseconds] = 300 * MILLISECOND
"""The same incident at several nodes within this time is shown once."""
FORMAT: Final = 1
"""Of the data: a number that grows when a key gets another meaning."""
Group: TypeAlias = list[Incident]
Json: TypeAlias = dict[str, object]


def grouped(incidents: Iterable[Incident]) -> list[Group]:
    """Return incidents in the order of time, the same one at several nodes as one group."""
    groups: list[Group] = []
    for incident in incidents:
        for group in reversed(groups):
            first = group[0]
            if incident.at - first.at > TOGETHER:
                continue
            if first.kind is incident.kind and first.what == incident.what and first.node is not None:
                group.append(incident)
                break
        else:
            groups.append([incident])
    return groups


def text(explained: Explained, source: str) -> Iterator[str]:
    """Yield the lines of the explanation."""
    groups = grouped(explained.incidents)
    for group in groups:
        yield from _block(group, explained.began_at)
        yield ""
    for remark in explained.remarks:
        yield f"note: {remark}"
    yield verdict(explained, source)


def verdict(explained: Explained, source: str) -> str:
    """Return the whole in one line."""
    length = to_seconds(explained.ended_at - explained.began_at)
    seen = (
        f"{explained.frames} {'chunks' if explained.lines else 'frames'}, {length:.1f} s, {_who(explained)}"
    )
    groups = grouped(explained.incidents)
    if not groups:
        return f"{source}: no incident ({seen})"
    first = groups[0][0]
    many = f"{len(groups)} incidents, the first" if len(groups) > 1 else "1 incident"
    at = _instant(first.at, explained.began_at)
    open_ = [group for group in groups if any(one.recovered_at is None for one in group)]
    rest = f"; {len(open_)} without recovery" if open_ else ""
    return f"{source}: {many} at {at} s, {_where(groups[0])}: {first.kind.title}{rest} ({seen})"


def _who(explained: Explained) -> str:
    """Return who was seen: nodes, or lines and the nodes behind them."""
    nodes = len(explained.nodes)
    seen = f"{nodes} node{'' if nodes == 1 else 's'}"
    if not explained.lines:
        return seen
    return f"{explained.lines}, {seen}" if nodes else explained.lines


def markdown(explained: Explained, source: str) -> Iterator[str]:
    """Yield the explanation as a table."""
    yield f"### {_cell(verdict(explained, source))}"
    groups = grouped(explained.incidents)
    if groups:
        yield ""
        yield "| at | where | incident | likely cause | recovery | check first |"
        yield "| ---: | --- | --- | --- | --- | --- |"
    for group in groups:
        one = group[0]
        cells = (
            f"{_instant(one.at, explained.began_at)} s",
            _where(group),
            f"{one.what}{_times(one)}" + (f" `{one.evidence.frame}`" if one.evidence is not None else ""),
            one.causes[0] if one.causes else "",
            _recovery(group, explained.began_at) or "none",
            one.check,
        )
        yield "| " + " | ".join(map(_cell, cells)) + " |"
    if explained.remarks:
        yield ""
        yield from (f"* {_cell(remark)}" for remark in explained.remarks)


def data(explained: Explained, source: str) -> Json:
    """Return the explanation for programs; instants in seconds since the first frame."""
    began = explained.began_at
    return {
        "format": FORMAT,
        "source": source,
        "verdict": verdict(explained, source),
        "frames": explained.frames,
        "seconds": to_seconds(explained.ended_at - began),
        "nodes": list(explained.nodes),
        "incidents": [_incident(one, began) for one in explained.incidents],
        "remarks": list(explained.remarks),
    }


def _incident(one: Incident, began: Nanoseconds) -> Json:
    recovered = one.recovered_at
    return {
        "kind": one.kind.name,
        "title": one.kind.title,
        "at_s": to_seconds(one.at - began),
        "node": one.node,
        "where": one.where,
        "what": one.what,
        "count": one.count,
        "evidence": None if one.evidence is None else _evidence(one.evidence, began),
        "causes": list(one.causes),
        "consequence": one.consequence,
        "check": one.check,
        "recovery": one.recovery or None,
        "recovered_at_s": None if recovered is None else to_seconds(recovered - began),
    }


def _evidence(evidence: Evidence, began: Nanoseconds) -> Json:
    return {"at_s": to_seconds(evidence.at - began), "frame": evidence.frame, "text": evidence.text}


def _block(group: Group, began: Nanoseconds) -> Iterator[str]:
    one = group[0]
    yield f"{_instant(one.at, began)} s  {_where(group)}: {one.what}{_times(one)}"
    if one.evidence is not None:
        at = _instant(one.evidence.at, began)
        yield f"    evidence     {at} s  {one.evidence.frame}  {one.evidence.text}"
    for place, cause in enumerate(one.causes):
        yield f"    {'cause       ' if not place else 'or          '} {cause}"
    yield f"    consequence  {one.consequence}"
    yield f"    recovery     {_recovery(group, began) or 'not seen'}"
    yield f"    check first  {one.check}"


def _where(group: Sequence[Incident]) -> str:
    return ", ".join(dict.fromkeys(one.where for one in group))


def _times(one: Incident) -> str:
    return f", {one.count} times" if one.count > 1 else ""


def _recovery(group: Sequence[Incident], began: Nanoseconds) -> str:
    ended = [one for one in group if one.recovered_at is not None]
    if not ended:
        return ""
    last = max(ended, key=lambda one: one.recovered_at or 0)
    not_all = f", not at {len(group) - len(ended)} of them" if len(ended) < len(group) else ""
    return f"{_instant(last.recovered_at or 0, began)} s  {last.recovery}{not_all}"


def _instant(at: Nanoseconds, began: Nanoseconds) -> str:
    return f"{to_seconds(at - began):.6f}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
