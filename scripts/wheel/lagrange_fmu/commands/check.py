"""Report the mistakes in the file of a system, without building it; start values are checked by run."""

from ..building import check
from .shared_arguments import SYSTEM


def arguments(parser):
    parser.add_argument("system", **SYSTEM)


def run(arguments):
    print(check(arguments.system))
