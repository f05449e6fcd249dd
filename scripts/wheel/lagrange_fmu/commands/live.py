"""Write a page in which the FMU of a system runs, with sliders for parameters and inputs, in any browser and without a network."""

from ..quantities import assignment
from .shared_arguments import SYSTEM_OR_FMU, add_robot, robot_of


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("settings", nargs="*", type=assignment, metavar="NAME=VALUE", help="start values and parameters with which the page begins, such as l=20cm or theta=pi/2")
    parser.add_argument("--edit", action="store_true", help="show the system in the page, where it can be changed and derived again")
    add_robot(parser)
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="the page to write; default: NAME.html, or with --edit NAME-edit.html, in the current folder")


def run(arguments):
    from ..pages import live

    print(live(arguments.system, dict(arguments.settings), arguments.output, arguments.edit, robot_of(arguments)).resolve())
