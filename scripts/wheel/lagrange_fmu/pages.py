"""Write pages in which the FMU of a system runs."""

from pathlib import Path

from .building import origin_of, report, robot_texts, robot_words, system_file
from .caching import share_zig_cache
from .live_page.editor import write_editor
from .live_page.page import write_page
from .problem import Problem
from .running import fmu_of, is_fmu
from .simulation import settings_of

LABORATORY = Path(__file__).parent / "live_page" / "laboratory.wasm"


def editor(system, output=None, robot=None):
    """Write the page in which the system can be changed; return its path."""
    if is_fmu(system):
        raise Problem(f"{system} is an FMU, which cannot be edited; expected the system.xml of which it was made")
    file = system_file(system)
    name = file.parent.resolve().name if file.name == "system.xml" else file.stem
    return write_editor(file, LABORATORY, output or Path(f"{name}-edit.html"), robot=robot_texts(robot))


def live(system, settings=None, output=None, edit=False, robot=None):
    """See lagrange_fmu.live."""
    if edit and settings:
        raise Problem(f"an editable page of {system} starts with the values in the file; write {', '.join(settings)} there as start=\"...\", or leave out --edit (edit=True)")
    if edit:
        return editor(system, output, robot)
    share_zig_cache()
    report(f"compiling {system} to WebAssembly, which can take a minute ...")
    with fmu_of(system, words=robot_words(robot)) as fmu:
        return write_page(fmu, output or Path(f"{fmu.stem}.html"), None if is_fmu(system) else origin_of(system, robot_words(robot)), settings_of(fmu, settings))
