"""The command lagrange-fmu."""

import argparse
import sys
import warnings

from . import __version__
from .building import NATIVE, build, check, new
from .problem import Problem
from .runtime.scripts.cross import PLATFORMS


def start_value(text):
    from .simulation import start_value

    return start_value(text)


def build_command(arguments):
    print(build(arguments.system, arguments.platforms, arguments.solver, arguments.output, arguments.fmi))


def run_command(arguments):
    from .running import run
    from .simulation import print_results

    print_results(run(arguments.system, dict(arguments.start), arguments.output))


def check_command(arguments):
    print(check(arguments.system))


def new_command(arguments):
    path = new(arguments.name)
    print(f"{path} is a pendulum to begin with; next: lagrange-fmu run {path}")


def parse(words):
    parser = argparse.ArgumentParser(prog="lagrange-fmu", description="Energies and forces of a mechanical system become an FMU.")
    parser.add_argument("--version", action="version", version=f"lagrange-fmu {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name, function, text):
        command = commands.add_parser(name, help=text, description=text)
        command.set_defaults(function=function)
        return command

    system = {"metavar": "SYSTEM.xml", "help": "the file, or a folder with a system.xml in it"}
    one = add("build", build_command, "Builds the FMU of a system, and prints where it is.")
    one.add_argument("system", **system)
    one.add_argument("--platforms", nargs="+", metavar="PLATFORM", help=f"of {', '.join(PLATFORMS)}; {NATIVE} where none are given")
    one.add_argument("--solver", metavar="METHOD", help="in place of the system's own")
    one.add_argument("--fmi", type=int, choices=(2, 3), default=2, help="the version of FMI; 2 where none is given")
    one.add_argument("-o", "--output", default=".", metavar="FOLDER", help="where the FMU goes; else the current folder")
    one = add("run", run_command, "Builds the FMU of a system and simulates it; leaves a CSV, a plot and an animation.")
    one.add_argument("system", **system | {"help": system["help"] + "; or an FMU"})
    one.add_argument("start", nargs="*", type=start_value, metavar="VARIABLE=VALUE", help="start values")
    one.add_argument("-o", "--output", default=".", metavar="FOLDER", help="where the results go; else the current folder")
    one = add("new", new_command, "Writes NAME.xml, a system with comments to begin with.")
    one.add_argument("name", metavar="NAME")
    one = add("check", check_command, "Tells what is wrong with a system, or that it is right.")
    one.add_argument("system", **system)
    return parser.parse_args(words)


def main(words=None):
    arguments = parse(words)
    warnings.showwarning = lambda message, *where: print(message, file=sys.stderr)
    try:
        arguments.function(arguments)
    except Problem as problem:
        sys.exit(f"lagrange-fmu: {problem}")
    except OSError as problem:
        sys.exit(f"lagrange-fmu: {problem.filename}: {problem.strerror}")
