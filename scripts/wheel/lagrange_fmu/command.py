"""Parse and run the command lagrange-fmu."""

import argparse
import re
import sys
import warnings
from importlib import import_module

import shtab

from . import __version__, caching
from .commands import COMMANDS
from .problem import Problem
from .variables import suggestion, near_file


FILES = ("system", "input")  # arguments that are completed as file names
MODULES = {name: import_module(f".commands.{name}", __package__) for name in COMMANDS}


class Words(argparse.ArgumentParser):
    """An argument parser whose errors suggest the nearest known word."""

    is_intermixed = False  # True while options are parsed apart from positional arguments

    def error(self, message):
        choice = re.fullmatch(r"(.*invalid choice: '?(.*?)'?) \(choose from (.*)\)", message)
        if choice:
            choices = re.findall(r"[^ ,']+", choice[3])
            message = f"{choice[1]}; {suggestion(choice[2], choices, 'choose from')}"
        super().error(message)

    def options(self, name):
        """Yield the options of the command of this name; those of all commands if it is None."""
        for action in self._actions:
            yield from action.option_strings
            if isinstance(action, argparse._SubParsersAction):
                for command in [action.choices[name]] if name else action.choices.values():
                    yield from command.options(None)

    def parse_known_args(self, args=None, namespace=None):
        """Allow options between positional arguments, as in `run FILE --stop-time 1 l=2`, except before the name of a command."""
        if self._subparsers is not None or self.is_intermixed:
            return super().parse_known_args(args, namespace)
        self.is_intermixed = True
        try:
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self.is_intermixed = False

    def parse_args(self, words=None):
        arguments, unknown = self.parse_known_args(words)
        if unknown:
            own = list(dict.fromkeys(self.options(getattr(arguments, "command", None))))
            remedy = f"; {suggestion(unknown[0].partition('=')[0], own, 'expected one of these')}" if unknown[0].startswith("-") else ""
            self.error(f"unrecognized arguments: {' '.join(unknown)}{remedy}")
        return arguments


def parser():
    """Return the parser of the command and of all its subcommands."""
    words = Words(
        prog="lagrange-fmu",
        description="Build an FMU from the energies and forces of a mechanical system, simulate it, and analyze it.",
        epilog=f"Compiled files are cached in {caching.folder()}; the environment variable LAGRANGE_FMU_CACHE names another folder. The cache can be deleted.",
    )
    words.add_argument("--version", action="version", version=f"lagrange-fmu {__version__}")
    shtab.add_argument_to(words, help="print the completion script for a shell")
    words.set_defaults(run=lambda arguments: words.print_help())
    commands = words.add_subparsers(metavar="COMMAND")
    for name, module in MODULES.items():
        text = module.__doc__.strip()
        command = commands.add_parser(name, help=text, description=text)
        command.set_defaults(run=module.run, command=name)
        module.arguments(command)
        for action in command._actions:
            if action.dest in FILES:
                action.complete = shtab.FILE
    return words


def main(words=None):
    warnings.showwarning = lambda message, *where: print(message, file=sys.stderr)
    try:
        arguments = parser().parse_args(words)
        arguments.run(arguments)
    except Problem as problem:
        sys.exit(f"lagrange-fmu: {problem}")
    except KeyboardInterrupt:
        print("lagrange-fmu: stopped; nothing more was written", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:  # the reader of the output, such as head, has ended
        sys.stdout = None
        sys.exit(141)
    except OSError as problem:
        near = near_file(problem.filename) if isinstance(problem, FileNotFoundError) and problem.filename else ""
        sys.exit(f"lagrange-fmu: {problem.filename}: {problem.strerror}{near}" if problem.filename else f"lagrange-fmu: {problem}")
