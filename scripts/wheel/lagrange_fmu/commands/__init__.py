"""
The commands of lagrange-fmu, one a module with the command's name, in the order of --help: a docstring, which is its help; arguments(parser),
which declares its words; run(arguments).
"""

COMMANDS = ("new", "check", "build", "run", "live", "linearize", "fit", "sweep", "words")
