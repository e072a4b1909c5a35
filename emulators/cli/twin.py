"""What every command says that runs drives: whether they are slower than they could be."""

import typer

from emulators.servo.kernel import choose


def tell_of_twin() -> None:
    """Say in one line when the drives run without their kernel; ServoError where one was asked for."""
    reason = choose().reason
    if reason:
        typer.echo(f"the drives' loops run in Python, which is slower: {reason}", err=True)
