"""The mark of what cannot be a frozen dataclass, and changes no more than one: generic classes, mostly."""


class Immutable:
    """Every slot of a class below this one is `Final`, and assigned in `__init__`.

    Where the core is compiled, only a class that is compiled, too, can stand below it.
    """

    __slots__ = ()
