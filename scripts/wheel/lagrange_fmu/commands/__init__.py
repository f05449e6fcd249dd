"""
List the commands of lagrange-fmu, in the order of --help.

Each is a module of the command's name. Its docstring is its help; arguments(parser) declares its arguments; run(arguments) carries it out.
"""

COMMANDS = ("new", "check", "show", "build", "run", "live", "equilibrium", "linearize", "fit", "sweep", "words")
