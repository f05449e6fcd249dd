"""Writes a page in which the FMU of a system runs, in any browser and without a network, with its parameters and inputs at hand."""

from pathlib import Path

from .words_of_systems import SYSTEM_OR_FMU


def arguments(parser):
    parser.add_argument("system", **SYSTEM_OR_FMU)
    parser.add_argument("--edit", action="store_true", help="the system can be changed in the page, which derives it anew")
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="the page; else NAME.html, or with --edit NAME-edit.html, in the current folder")


def run(arguments):
    from .. import caching
    from ..building import origin_of, system_file
    from ..live_page.editor import write_editor
    from ..live_page.page import write_page
    from ..problem import Problem
    from ..running import fmu_of, is_fmu

    if arguments.edit:
        if is_fmu(arguments.system):
            raise Problem(f"{arguments.system} is an FMU; with --edit expected the system.xml that it was made of")
        laboratory = Path(__file__).parent.parent / "live_page" / "laboratory.wasm"
        system = system_file(arguments.system)
        name = system.parent.resolve().name if system.name == "system.xml" else system.stem
        print(write_editor(system, laboratory, arguments.output or Path(f"{name}-edit.html")).resolve())
        return
    caching.keep_what_zig_compiles()
    with fmu_of(arguments.system) as fmu:
        origin = None if is_fmu(arguments.system) else origin_of(arguments.system)
        print(write_page(fmu, arguments.output or Path(f"{fmu.stem}.html"), origin).resolve())
