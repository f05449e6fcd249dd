"""Report the mistakes in the file of a system, without building it; start values are checked by run."""

from ..building import check
from .shared_arguments import SYSTEM, add_robot, robot_of


def arguments(parser):
    parser.add_argument("system", **SYSTEM)
    add_robot(parser)


def run(arguments):
    print(check(arguments.system, robot=robot_of(arguments)))
