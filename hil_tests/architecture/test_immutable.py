"""Immutable classes: each slot is assigned in `__init__` as `Final`, which mypy then enforces."""

import ast
from collections.abc import Iterator
from inspect import getsource

import pytest

import firmware_bridge.bridge  # noqa: F401 - leads to all classes but a robot's own
from firmware_bridge.immutable import Immutable
from firmware_bridge.robots.rars.motion import RarsMotion


def below(cls: type) -> Iterator[type]:
    subclasses: list[type] = cls.__subclasses__()
    for each in subclasses:
        yield each
        yield from below(each)


def finals(cls: type) -> Iterator[str]:
    for node in ast.walk(ast.parse(getsource(cls))):
        match node:
            case ast.AnnAssign(
                target=ast.Attribute(value=ast.Name(id="self"), attr=name),
                annotation=ast.Name(id="Final") | ast.Subscript(value=ast.Name(id="Final")),
            ):
                yield name


@pytest.mark.parametrize("cls", list(below(Immutable)), ids=lambda cls: cls.__qualname__)
def test_every_slot_of_what_is_immutable_is_final(cls: type) -> None:
    assert set(vars(cls)["__slots__"]) == set(finals(cls))


def test_a_value_is_hashed_by_what_it_holds_and_has_no_room_for_more() -> None:
    one, same = RarsMotion(speed_mps=0.5), RarsMotion(speed_mps=0.5)
    assert hash(one) == hash(same)
    assert hash(one) != hash(RarsMotion())
    with pytest.raises(AttributeError):
        setattr(one, "sped_mps", 0.4)  # noqa: B010 - mypy would refuse it
