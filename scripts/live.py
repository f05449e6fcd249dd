"""Writes the page in which an FMU runs: live.py FMU [PAGE] [--system FILE --build FOLDER]"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from scripts.live_page.origin import Origin
from scripts.live_page.page import write_page
from scripts.one_file import one_file
from scripts.problem import Problem


ROOT = Path(__file__).resolve().parent.parent


def origin_in(build, system):
    """Of an FMU that was made of the system in this build folder."""
    return Origin(Path(system), build / "bin" / "lagc", lambda code, name: one_file(ROOT, build / "global_names", 2, code, name))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("page", type=Path, nargs="?")
    parser.add_argument("--system", type=Path, help="the file that the FMU was made of: then its bodies can be pulled, and it can be saved")
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="the build folder that made it")
    arguments = parser.parse_args()
    origin = origin_in(arguments.build, arguments.system) if arguments.system else None
    try:
        path = write_page(arguments.fmu, arguments.page or Path("build/live") / f"{arguments.fmu.stem}.html", origin)
    except Problem as problem:
        sys.exit(f"scripts/live: {problem}")
    print(path.resolve())


if __name__ == "__main__":
    main()
