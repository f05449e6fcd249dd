"""The command lagrange-fmu."""

import argparse
import sys
import warnings
from importlib import import_module

import shtab

from . import __version__, caching
from .commands import COMMANDS
from .problem import Problem


FILES = ("system", "input")  # the words of commands that name files


def parser():
    """The command's words, those of each of COMMANDS among them."""
    words = argparse.ArgumentParser(
        prog="lagrange-fmu",
        description="Energies and forces of a mechanical system become an FMU.",
        epilog=f"What was compiled is kept in {caching.folder()}, or where LAGRANGE_FMU_CACHE says; the folder can be deleted.",
    )
    words.add_argument("--version", action="version", version=f"lagrange-fmu {__version__}")
    shtab.add_argument_to(words, help="prints what a shell completes the command's words by")
    words.set_defaults(run=lambda arguments: words.print_help())
    commands = words.add_subparsers(metavar="COMMAND")
    for name in COMMANDS:
        module = import_module(f".commands.{name}", __package__)
        text = module.__doc__.strip()
        command = commands.add_parser(name, help=text, description=text)
        command.set_defaults(run=module.run)
        module.arguments(command)
        for action in command._actions:
            if action.dest in FILES:
                action.complete = shtab.FILE
    return words


def main(words=None):
    arguments = parser().parse_args(words)
    warnings.showwarning = lambda message, *where: print(message, file=sys.stderr)
    try:
        arguments.run(arguments)
    except Problem as problem:
        sys.exit(f"lagrange-fmu: {problem}")
    except KeyboardInterrupt:
        print("lagrange-fmu: stopped; nothing more was written", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:  # who read has seen enough, as head does
        sys.stdout = None
        sys.exit(141)
    except OSError as problem:
        sys.exit(f"lagrange-fmu: {problem.filename}: {problem.strerror}" if problem.filename else f"lagrange-fmu: {problem}")
