"""Declare the arguments that several commands share."""

SYSTEM = {"metavar": "SYSTEM", "help": "a system in XML, a robot in URDF, or a folder with a system.xml"}
SYSTEM_OR_FMU = SYSTEM | {"help": SYSTEM["help"] + ", or an FMU"}


def add_fmi(parser):
    parser.add_argument("--fmi", type=int, choices=(2, 3), default=2, help="version of FMI; default: 2")


def add_robot(parser):
    """Add the options for the file of a robot; robot_of() collects them."""
    options = parser.add_argument_group("options for a robot in URDF or MJCF, as in an <include>")
    options.add_argument("--base", choices=("fixed", "floating"), help="the root link of a URDF, or bodies of an MJCF without joints, are fixed or move freely; default: fixed")
    options.add_argument("--ground", action="store_true", help="the shapes of all links touch the ground")
    options.add_argument("--feet", metavar="LINK,...", help="the shapes of these links touch the ground")
    options.add_argument("--self", action="store_true", help="shapes of links touch each other, and static shapes of the file")
    options.add_argument("--limits", choices=("outputs", "stops"), help="limits of joints are outputs, or stops; default: outputs")
    options.add_argument("--friction", choices=("creeps", "sticks"), help="friction of joints is smooth, or dry; default: creeps")
    options.add_argument("--effort", choices=("unlimited", "limited"), help="motors are unlimited, or limited by the effort of the file; default: unlimited")
    options.add_argument("--keyframe", metavar="NAME", help="the <key> of MJCF with the start values")
    options.add_argument("--mocap", choices=("still", "inputs"), help="bodies of MJCF with mocap stand still, or inputs move them; default: still")
    options.add_argument("--tool", metavar="LINK", help="the link whose position is an output; default: the last one")


def robot_of(arguments):
    """Return the options of add_robot() that are given, as a dict."""
    given = {word: getattr(arguments, word) for word in ("base", "limits", "friction", "effort", "keyframe", "mocap", "tool")}
    given["self"] = arguments.self or None
    given["ground"] = arguments.feet.replace(",", " ") if arguments.feet else arguments.ground or None
    return {word: value for word, value in given.items() if value is not None}


def add_output(parser, what):
    parser.add_argument("-o", "--output", default=".", metavar="FOLDER", help=f"folder of {what}; default: the current folder")
