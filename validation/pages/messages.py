"""Messages of the program with their causes and remedies, read from the source's own texts.

A text of the source is a template: what is computed stands as `...`. A message's remedy stands behind its
first semicolon; an error whose messages have none has that of its class in `ERRORS`.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final, NamedTuple

ROOT: Final = Path(__file__).parents[2]
PACKAGES: Final = ("firmware_bridge", "emulators", "fmu")
INTERLOCKS: Final = {"Interlock", "AxisInterlock", "Limit"}
NEED: Final = "Need"
"""What a request needs: its second argument returns the refusals."""
ANSWERS: Final = {"denied", "Answer", "CommandAnswer", "Unusable"}
ERRORS: Final[Mapping[str, tuple[str, str]]] = {
    "BlackBoxError": ("a recording cannot be written", "free the disk, or choose another folder"),
    "ChoiceError": ("an emulated drive has no such choice", "see `emulate epos2 --help`"),
    "CommissioningError": (
        "a drive refuses, or does what it should not",
        "look at its state with `epos2 state`",
    ),
    "ConditionsError": ("the conditions of a slow link are wrong", "see `--link` in the help"),
    "CutOffError": ("a recording ends in the middle of a message", "use what comes before its end"),
    "ExtraMissingError": ("an optional package is not installed", "install the extra that is named"),
    "FaultError": ("a fault does not fit this robot", "see `firmware-bridge faults`"),
    "FittingError": ("a motor or encoder does not fit its drive", "correct the option that is named"),
    "MissionFileError": ("a mission has wrong keys or values", "correct the keys that are named"),
    "MotorError": ("a motor's data are missing or impossible", "correct the option that is named"),
    "NatNetError": ("a capture system sends what no version of NatNet has", "compare the versions"),
    "PathError": ("a pilot's path cannot be driven", "correct the path"),
    "PathFileError": ("a file of points is not a path of this robot", "correct the line that is named"),
    "PlantError": ("an FMU is missing, damaged, or not what the robot needs", "build it with `fmu build`"),
    "PortError": ("an adapter or a serial port cannot be used", "plug it in, or name another one"),
    "RecordingError": ("a recording is not in a known format", "see `replay --help`"),
    "RecordingFileError": ("a recording does not fit what it is played into", "see `replay --help`"),
    "RefusedError": ("a device answers with an abort code", "look the code up in the object's row"),
    "RigError": ("a test requests what this robot cannot do", "see docs/testing.md"),
    "RobotFileError": ("a robot file has wrong keys or values", "correct the keys that are named"),
    "SheetError": ("a data sheet cannot be read or written", "correct the file that is named"),
    "ServoError": ("the servo kernel is missing, or its plant fails", "run `firmware-bridge doctor`"),
    "SilentNodeError": ("no device answers at this address", "check power, cable, address and bit rate"),
    "SketchError": ("a sketch for a board cannot be made", "correct the option that is named"),
    "SpecificationError": ("what `new` is given makes no robot", "correct the option that is named"),
    "StartupError": ("a bridge cannot start", "correct what is named, and start it again"),
    "StateError": ("a plant's state is not one of its own", "restart the run"),
    "StorageError": ("an emulated drive's memory cannot be kept", "choose another file"),
    "UnknownNameError": ("there is no plant or parameter of this name", "take one of those that are named"),
    "UnknownObjectError": ("the object dictionary has no such object", "see docs/objects.md"),
    "UnsupportedError": ("an FMU needs what FMI has and this program has not", "export it without"),
    "ValueTextError": ("a value does not fit its object", "give a number within the object's range"),
    "WordError": (
        "a fault or its keys cannot be read, or be put on these devices",
        "see `firmware-bridge faults`",
    ),
    "WorldError": ("nodes and wires of a bench do not fit together", "correct the set-up that is named"),
    "refusal": ("an option or an argument is wrong", "see `--help` of the command"),
}
"""Cause and remedy of each class of errors that a user meets."""


class Message(NamedTuple):
    """One interlock: its name, its messages, its remedy."""

    text: str
    cause: str
    remedy: str


class Module:
    """One module: its functions, its texts by name, its calls."""

    def __init__(self, path: Path) -> None:
        """Read it."""
        self.tree: Final = ast.parse(path.read_text(encoding="utf-8"))
        nodes = list(ast.walk(self.tree))
        self.functions: Final = {one.name: one for one in nodes if isinstance(one, ast.FunctionDef)}
        self.calls: Final = [one for one in nodes if isinstance(one, ast.Call)]
        self.raised: Final = [one.exc for one in nodes if isinstance(one, ast.Raise) and one.exc is not None]
        self._texts: Final = {
            one.target.id: one.value
            for one in self.tree.body
            if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name) and one.value is not None
        }

    def template(self, node: ast.expr | None) -> str | None:
        """Return a text of the source with `...` for what is computed; None where it is no text."""
        match node:
            case ast.Constant(value=str(text)):
                return text
            case ast.JoinedStr(values=parts):
                return "".join(self.template(part) or "..." for part in parts)
            case ast.Name(id=name) if name in self._texts:
                return self.template(self._texts[name])
        return None

    def returned(self, name: str, deeper: int = 2) -> Iterator[str]:
        """Yield the templates that a function of this module may return, by way of helpers as well."""
        for node in ast.walk(self.functions[name]) if name in self.functions else ():
            if isinstance(node, ast.Return) and node.value is not None:
                for part in _outermost(node.value):
                    text = self.template(part)
                    if text is not None and " " in text.strip("., "):
                        yield text
                    if isinstance(part, ast.Call) and isinstance(part.func, ast.Name) and deeper:
                        yield from self.returned(part.func.id, deeper - 1)


def modules() -> Iterator[Module]:
    """Yield every module of the program."""
    for package in PACKAGES:
        yield from map(Module, sorted((ROOT / package).rglob("*.py")))


def interlocks(module: Module) -> Iterator[Message]:
    """Yield the interlocks and limits of a module: name, messages, remedy."""
    for call in module.calls:
        if _name(call.func) in INTERLOCKS and len(call.args) > 2:  # noqa: PLR2004 - name, judge, remedy
            name, remedy = module.template(call.args[0]), module.template(call.args[2])
            causes = dict.fromkeys(module.returned(_name(call.args[1])))
            if name and remedy:
                yield Message(name, "<br>".join(causes) or "-", remedy)


def answers(module: Module) -> Iterator[tuple[str, str]]:
    """Yield the refusals of an operator's orders, each with the order."""
    for call in module.calls:
        if _name(call.func) == NEED:
            yield from (("any", text) for text in module.returned(_name(call.args[1])))
        if _refuses(call):
            given = [*call.args, *(keyword.value for keyword in call.keywords)]
            text = max(filter(None, map(module.template, given)), key=len, default="")
            if _is_text(text):
                order, colon, _ = text.partition(": ")
                yield order if colon and "..." not in order else "any", text


def errors(module: Module) -> Iterator[tuple[str, str]]:
    """Yield the errors that end a command, each with its class."""
    for call in module.raised:
        if isinstance(call, ast.Call) and _name(call.func) in ERRORS:
            text = max(filter(None, map(module.template, call.args)), key=len, default="")
            if _is_text(text):
                yield _name(call.func), text


def _is_text(text: str) -> bool:
    """Return whether a template has words of its own."""
    return len(re.findall(r"[a-z]{2,}", text)) > 1


def _refuses(call: ast.Call) -> bool:
    """Return whether an answer is a refusal."""
    texts = " ".join(map(ast.unparse, [*call.args, *(keyword.value for keyword in call.keywords)]))
    return _name(call.func) in ANSWERS and "True" not in texts and "ACCEPTED" not in texts


def _outermost(node: ast.AST) -> Iterator[ast.expr]:
    """Yield the expressions below a node, but for the parts of a text."""
    if isinstance(node, ast.expr):
        yield node
    if not isinstance(node, ast.JoinedStr):
        for child in ast.iter_child_nodes(node):
            yield from _outermost(child)


def _name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
