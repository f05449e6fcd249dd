"""Declare the arguments that several commands share."""

SYSTEM = {"metavar": "SYSTEM", "help": "a system in XML, a robot in URDF, or a folder with a system.xml"}
SYSTEM_OR_FMU = SYSTEM | {"help": SYSTEM["help"] + ", or an FMU"}


def add_fmi(parser):
    parser.add_argument("--fmi", type=int, choices=(2, 3), default=2, help="version of FMI; default: 2")


def add_output(parser, what):
    parser.add_argument("-o", "--output", default=".", metavar="FOLDER", help=f"folder of {what}; default: the current folder")
