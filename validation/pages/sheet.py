"""A drawing of a few primitives in views, written as plain SVG: the same text for the same numbers."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from html import escape
from textwrap import wrap
from typing import Final, Literal, TypeAlias

Point: TypeAlias = tuple[float, float]
Anchor: TypeAlias = Literal["start", "middle", "end"]

WIDTH: Final = 960.0
MARGIN: Final = 80.0
"""Around each view, px: room for its dimensions."""
HEAD: Final = 74.0
LINE: Final = 19.0
TALLEST: Final = 440.0
IN_A_ROW: Final = 2
LETTERS: Final = 145
"""Of a line of notes."""
LETTER: Final = 7.0
"""Width of one, px, about."""
TEXT: Final = 12.0
ARROW: Final = 7.0
EXACT: Final = 1e-9
INK: Final = "#222222"
BLUE: Final = "#0072B2"
GREEN: Final = "#009E73"
PURPLE: Final = "#A0508A"
VERMILION: Final = "#D55E00"
GRAY: Final = "#777777"


@dataclass(frozen=True, slots=True)
class Stroke:
    """Color, width, dashes and fill of a line."""

    color: str
    width: float = 1.6
    dash: str = ""
    fill: str = "none"


PART: Final = Stroke(INK, fill="#E6E6E6")
LINK: Final = Stroke(INK, 5.0)
SCHEMATIC: Final = Stroke(GRAY, 1.2, "5 4")
SUPPORT: Final = Stroke(GREEN, 1.4, "8 3 2 3")
LIMIT: Final = Stroke(VERMILION, 1.2, "2 3")
DIMENSION: Final = Stroke(BLUE, 0.9)
SENSOR: Final = Stroke(PURPLE, 1.6, fill="white")
FLOOR: Final = Stroke(GRAY, 2.0)


@dataclass(frozen=True, slots=True)
class Line:
    """A polyline, or a polygon, in px."""

    points: tuple[Point, ...]
    stroke: Stroke
    closed: bool = False


@dataclass(frozen=True, slots=True)
class Text:
    """One line of text in px; `turn_deg` clockwise."""

    at: Point
    text: str
    color: str = INK
    anchor: Anchor = "middle"
    size: float = TEXT
    turn_deg: float = 0.0
    bold: bool = False


Item: TypeAlias = Line | Text
Place: TypeAlias = Callable[[tuple[Point, ...]], Iterator[Item]]
"""Return what is drawn, for its points in px."""


@dataclass(slots=True)
class View:
    """One view of a robot: lengths in m, the second coordinate upwards."""

    title: str
    items: list[tuple[tuple[Point, ...], Place]] = field(default_factory=list)

    def line(self, *points: Point, stroke: Stroke = PART, closed: bool = False) -> None:
        """Draw a polyline, or a polygon."""
        self.items.append((points, partial(_line, stroke=stroke, closed=closed)))

    def box(self, low: Point, high: Point, stroke: Stroke = PART) -> None:
        """Draw a rectangle by two corners."""
        self.line(low, (high[0], low[1]), high, (low[0], high[1]), stroke=stroke, closed=True)

    def circle(
        self, middle: Point, radius: float, stroke: Stroke = PART, *, across: float | None = None
    ) -> None:
        """Draw a circle, or an ellipse that is `across` wide, half."""
        half = radius if across is None else across
        angles = [math.tau * step / 72 for step in range(72)]
        points = ((middle[0] + half * math.cos(it), middle[1] + radius * math.sin(it)) for it in angles)
        self.line(*points, stroke=stroke, closed=True)

    def arc(self, middle: Point, radius: float, low: float, high: float, stroke: Stroke) -> None:
        """Draw an arc between two angles, rad."""
        angles = [low + (high - low) * step / 48 for step in range(49)]
        points = ((middle[0] + radius * math.cos(it), middle[1] + radius * math.sin(it)) for it in angles)
        self.line(*points, stroke=stroke)

    def text(
        self,
        at: Point,
        text: str,
        by: Point = (0.0, 0.0),
        *,
        color: str = INK,
        anchor: Anchor = "middle",
    ) -> None:
        """Write text at a place, moved by px to the right and upwards."""
        self.items.append(((at,), partial(_text, text=text, by=by, color=color, anchor=anchor)))

    def size(self, one: Point, other: Point, text: str, off: float) -> None:
        """Draw a dimension between two points, `off` px to the left of the way from one to the other."""
        self.items.append(((one, other), partial(_size, text=text, off=off)))

    def mark(self, at: Point, text: str, by: Point, anchor: Anchor = "start") -> None:
        """Draw the sign of a center of gravity, and its text."""
        self.items.append(((at,), _mark))
        self.text(at, text, by, anchor=anchor)

    def bounds(self) -> tuple[Point, Point]:
        """Return the lowest and the highest place of all that is drawn."""
        points = [point for points, _ in self.items for point in points]
        xs, ys = zip(*points, strict=True)
        return (min(xs), min(ys)), (max(xs), max(ys))


def millimeters(meters: float) -> str:
    """Return a length as a drawing has it: mm, to a tenth."""
    return f"{round(1000.0 * meters, 1):g}"


def svg(title: str, views: Sequence[View], notes: Sequence[str]) -> str:
    """Return the drawing as SVG."""
    height, items = placed(title, views, notes)
    size = f'width="{WIDTH:g}" height="{_number(height)}"'
    font = 'font-family="DejaVu Sans, Arial, sans-serif"'
    box = f'viewBox="0 0 {WIDTH:g} {_number(height)}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {box} {size} {font} role="img">',
        f"<title>{escape(title)}</title>",
        # A page in dark mode must not show dark lines on a dark ground.
        f'<rect {size} fill="#FFFFFF"/>',
        *map(_element, items),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def placed(title: str, views: Sequence[View], notes: Sequence[str]) -> tuple[float, list[Item]]:
    """Return the sheet's height and all that is on it, in px: two views in a row, and notes below."""
    items: list[Item] = [Text((20.0, 28.0), title, anchor="start", size=16.0, bold=True)]
    top = 54.0
    for row in (views[begin : begin + IN_A_ROW] for begin in range(0, len(views), IN_A_ROW)):
        room = WIDTH / IN_A_ROW - 2.0 * MARGIN
        boxes = [(view, *view.bounds()) for view in row]
        scales = [min(room / (high[0] - low[0]), TALLEST / (high[1] - low[1])) for _, low, high in boxes]
        tall = max(scale * (high[1] - low[1]) for scale, (_, low, high) in zip(scales, boxes, strict=True))
        center = top + MARGIN * 0.7 + tall / 2.0
        for place, (scale, (view, low, high)) in enumerate(zip(scales, boxes, strict=True)):
            middle = (place + 0.5) * WIDTH / len(row)
            origin = (middle - scale * (low[0] + high[0]) / 2.0, center + scale * (low[1] + high[1]) / 2.0)
            items.append(Text((middle, top), view.title, size=13.0, bold=True))
            for points, put in view.items:
                there = tuple((origin[0] + scale * x, origin[1] - scale * y) for x, y in points)
                items += put(there)
        top = center + tall / 2.0 + MARGIN
    lines = [line for note in notes for line in wrap(note, LETTERS)]
    items += [
        Text((20.0, top + LINE * row), line, color=GRAY, anchor="start") for row, line in enumerate(lines)
    ]
    return top + LINE * len(lines), items


def _line(points: tuple[Point, ...], *, stroke: Stroke, closed: bool) -> Iterator[Item]:
    yield Line(points, stroke, closed)


def _text(points: tuple[Point, ...], *, text: str, by: Point, color: str, anchor: Anchor) -> Iterator[Item]:
    ((x, y),) = points
    yield Text((x + by[0], y - by[1]), text, color, anchor)


def _mark(points: tuple[Point, ...]) -> Iterator[Item]:
    ((x, y),) = points
    yield Line(tuple(_around(x, y, 7.0, 24)), Stroke(INK, 1.4, fill="white"), closed=True)
    yield Line(((x - 7.0, y), (x + 7.0, y)), Stroke(INK, 1.4))
    yield Line(((x, y - 7.0), (x, y + 7.0)), Stroke(INK, 1.4))


def _around(x: float, y: float, radius: float, count: int) -> Iterator[Point]:
    for step in range(count):
        yield x + radius * math.cos(math.tau * step / count), y + radius * math.sin(math.tau * step / count)


def _size(points: tuple[Point, ...], *, text: str, off: float) -> Iterator[Item]:
    """Yield both extension lines, the dimension's line with its arrows, and its text above it."""
    one, other = points
    length = math.dist(one, other)
    if not length:
        return
    along = ((other[0] - one[0]) / length, (other[1] - one[1]) / length)
    # Left of the way, where y counts downwards.
    aside = (along[1], -along[0])
    ends = [(x + off * aside[0], y + off * aside[1]) for x, y in points]
    over = math.copysign(4.0, off)
    for (x, y), (end_x, end_y) in zip(points, ends, strict=True):
        if off:
            yield Line(((x, y), (end_x + over * aside[0], end_y + over * aside[1])), DIMENSION)
    yield Line(tuple(ends), DIMENSION)
    for (x, y), sign in zip(ends, (1.0, -1.0), strict=True):
        back = (x + sign * ARROW * along[0], y + sign * ARROW * along[1])
        wings = [(back[0] + side * 2.4 * aside[0], back[1] + side * 2.4 * aside[1]) for side in (1.0, -1.0)]
        yield Line(((x, y), *wings), Stroke(BLUE, 0.5, fill=BLUE), closed=True)
    middle = ((ends[0][0] + ends[1][0]) / 2.0, (ends[0][1] + ends[1][1]) / 2.0)
    yield _size_text(middle, along, text, off, room=length - 2.0 * ARROW)


def _size_text(middle: Point, along: Point, text: str, off: float, *, room: float) -> Text:
    """Return a dimension's text: along its line, or beside it where that is too short."""
    if LETTER * len(text) > room:
        side = math.copysign(1.0, off)
        out = (side * along[1], -side * along[0])
        flat = abs(out[0]) < abs(out[1])
        anchor: Anchor = "middle" if flat else "start" if out[0] > 0.0 else "end"
        down = 16.0 if flat and out[1] > 0.0 else -7.0 if flat else 4.0
        return Text((middle[0] + 7.0 * out[0], middle[1] + down), text, BLUE, anchor)
    # A text is read from below or from the right, never upside down.
    upright = along[0] > EXACT or (abs(along[0]) <= EXACT and along[1] < 0.0)
    ahead = along if upright else (-along[0], -along[1])
    at = (middle[0] + 4.0 * ahead[1], middle[1] - 4.0 * ahead[0])
    return Text(at, text, BLUE, turn_deg=math.degrees(math.atan2(ahead[1], ahead[0])))


def _element(item: Item) -> str:
    if isinstance(item, Text):
        x, y = (_number(it) for it in item.at)
        turn = f' transform="rotate({_number(item.turn_deg)} {x} {y})"' if item.turn_deg else ""
        bold = ' font-weight="bold"' if item.bold else ""
        return (
            f'<text x="{x}" y="{y}" font-size="{item.size:g}" text-anchor="{item.anchor}" fill="{item.color}"'
            ' stroke="#FFFFFF" stroke-width="3" paint-order="stroke" stroke-linejoin="round"'
            f"{bold}{turn}>{escape(item.text)}</text>"
        )
    points = " ".join(f"{_number(x)},{_number(y)}" for x, y in item.points)
    stroke = item.stroke
    dash = f' stroke-dasharray="{stroke.dash}"' if stroke.dash else ""
    return (
        f'<{"polygon" if item.closed else "polyline"} points="{points}" fill="{stroke.fill}" '
        f'stroke="{stroke.color}" stroke-width="{stroke.width:g}"{dash} stroke-linejoin="round"/>'
    )


def _number(value: float) -> str:
    # One decimal hides the last bits of sines, which differ between machines; -0 is 0.
    return f"{round(value, 1) + 0.0:g}"
