"""Writes the page in which an FMU runs: live.py FMU [PAGE]"""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from scripts.live_page.page import write_page
from scripts.problem import Problem


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("fmu", type=Path)
    parser.add_argument("page", type=Path, nargs="?")
    arguments = parser.parse_args()
    try:
        path = write_page(arguments.fmu, arguments.page or Path("build/live") / f"{arguments.fmu.stem}.html")
    except Problem as problem:
        sys.exit(f"scripts/live: {problem}")
    print(path.resolve())


if __name__ == "__main__":
    main()
