"""Write NAME.xml, a system with comments, as a starting point."""

from ..building import TEMPLATES, new


def arguments(parser):
    parser.add_argument("name", metavar="NAME", help="name of the system: letters, digits and _")
    parser.add_argument("--template", choices=TEMPLATES, default="pendulum", help="system to copy; default: pendulum")


def run(arguments):
    path = new(arguments.name, arguments.template)
    print(f"wrote {path} from the template {arguments.template}; next: lagrange-fmu run {path}")
