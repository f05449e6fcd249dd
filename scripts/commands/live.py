"""Write the page in which an FMU runs: live.py FMU [PAGE] [NAME=VALUE ...] [--system FILE --build FOLDER [--edit]]"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from scripts.library.live_page.editor import write_editor
from scripts.library.live_page.origin import Origin
from scripts.library.live_page.page import write_page
from scripts.library.problem import Problem
from scripts.library.quantities import assignment
from scripts.library.simulation import settings_of
from scripts.package.one_file import one_file

ROOT = Path(__file__).resolve().parents[2]
LABORATORY = ROOT / "build" / "laboratory" / "laboratory.wasm"  # made by scripts/package/build-laboratory


def origin_in(build, system, robot=()):
    """Return the Origin of an FMU that was built from the system in this build folder. robot: options for the file of a robot."""
    words = tuple(word for text in robot for word in ("--robot", text))
    return Origin(Path(system), build / "bin" / "lagc", lambda code, name: one_file(ROOT, build / "global_names", 2, code, name), words)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path, help="the FMU")
    parser.add_argument("page", type=Path, nargs="?", help="the page to write; default: build/live/NAME.html")
    parser.add_argument("settings", nargs="*", type=assignment, metavar="NAME=VALUE", help="start values and parameters with which the page begins")
    parser.add_argument("--system", type=Path, help="file of the FMU's system, with which bodies can be pulled and the system can be saved")
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="build folder of the FMU")
    parser.add_argument("--robot", action="append", default=[], metavar="WORD=VALUE", help="an option for the file of a robot, with which the FMU was built")
    parser.add_argument("--edit", action="store_true", help="show the system in the page, where it can be changed")
    arguments = parser.parse_args()
    if arguments.edit and not arguments.system:
        parser.error("--edit needs --system")
    if arguments.edit and arguments.settings:
        parser.error("--edit takes no NAME=VALUE; expected values in the system itself")
    origin = origin_in(arguments.build, arguments.system, arguments.robot) if arguments.system else None
    try:
        if not arguments.edit:
            print(f"scripts/live: compiling {arguments.fmu.stem} to WebAssembly, which can take a minute ...", file=sys.stderr, flush=True)
        page = arguments.page or Path("build/live") / f"{arguments.fmu.stem}{'-edit' if arguments.edit else ''}.html"
        path = write_editor(arguments.system, LABORATORY, page, robot=arguments.robot) if arguments.edit else write_page(arguments.fmu, page, origin, settings_of(arguments.fmu, dict(arguments.settings)), arguments.build / "wasm")
    except Problem as problem:
        sys.exit(f"scripts/live: {problem}")
    print(path.resolve())


if __name__ == "__main__":
    main()
