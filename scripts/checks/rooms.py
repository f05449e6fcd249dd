"""
Check the layers of the C sources.

lagc with the laboratory, the runtime of FMUs, and the ensemble each consist of rooms. A room is a folder of at most a dozen modules, and a module is
a .c file with its .h file. An #include leads to the same room or to one that is listed before it. Calls lead the same
way, as each function is defined in the room of the header that declares it. Prints violations; no output means there are none.
"""

import re
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
MOST_MODULES = 12


class Layers(NamedTuple):
    rooms: list  # folders from the lowest layer up; a room includes files of itself and of rooms before it
    paths: list  # include paths beside the file's own folder; they contain all rooms


LAGC = Layers(
    """
    src/compiler/base
    src/compiler/algebra
    src/compiler/algebra/polynomials
    src/compiler/algebra/units
    src/compiler/model
    src/compiler/mechanics/mass_matrix
    src/compiler/mechanics
    src/compiler/interface
    src/compiler/display
    src/compiler/names
    src/compiler/xml
    src/import/meshes
    src/import/robots/description
    src/import/robots/expansion
    src/import/robots/mjcf/values
    src/import/robots/mjcf
    src/import/robots
    src/compiler/read/tables
    src/compiler/read/expressions
    src/compiler/read/context
    src/compiler/read/space
    src/compiler/read/shapes
    src/compiler/read/elements
    src/compiler/read
    src/compiler/program/codegen
    src/compiler/program/expressions
    src/compiler/program/series
    src/compiler/program
    src/compiler/program/metadata
    src/compiler/program/tables
    src/compiler/write
    modelDescription/scene
    modelDescription
    modelDescription/drawing
    modelDescription/page
    src/compiler
    src/laboratory
    """.split(),
    ["src/compiler", "src/import", "modelDescription", "src/laboratory"],
)
RUNTIME = Layers(
    """
    src/runtime/support
    src/runtime/instance
    src/runtime/evaluation
    src/runtime/methods
    src/runtime/methods/sundials
    src/runtime/detection
    src/runtime/nonsmooth
    src/runtime/nonsmooth/cones
    src/runtime/nonsmooth/cones/interior
    src/runtime/nonsmooth/contacts
    src/runtime/nonsmooth/frictions
    src/runtime/nonsmooth/sliding
    src/runtime/nonsmooth/planes
    src/runtime/nonsmooth/rests
    src/runtime/events
    src/runtime/time_steps
    src/runtime/timing
    src/runtime/stepping
    src/runtime/fmi
    src/runtime/fmi2
    src/runtime/fmi3
    """.split(),
    ["src/runtime"],
)
ENSEMBLE = Layers(["src/ensemble/single", "src/ensemble"], ["src/ensemble"])
ALL_LAYERS = [LAGC, RUNTIME, ENSEMBLE]


def files_of(layers):
    """Return the C files of each room, by the room's path."""
    rooms = {}
    for file in sorted({file for path in layers.paths for file in (ROOT / path).rglob("*.[ch]")}):
        rooms.setdefault(str(file.parent.relative_to(ROOT)), []).append(file)
    return rooms


def arrows_from(file, layers):
    """Yield the #include lines that lead to a file of the layers, as (name, room)."""
    for name in re.findall(r'^#include "(.*)"', file.read_text(), re.MULTILINE):
        candidates = [file.parent / name, *(ROOT / path / name for path in layers.paths)]
        found = next((candidate for candidate in candidates if candidate.exists()), None)
        if found is not None:
            yield name, str(found.parent.relative_to(ROOT))


def functions_in(file):
    """Return the names of the functions that are not static: declared in a header, or defined in a source."""
    ends = ";" if file.suffix == ".h" else " {"
    return set(re.findall(rf"^(?!static|typedef|extern)[a-z][\w \*]*?(\w+)\([^;{{}}]*\){ends}$", file.read_text(), re.MULTILINE))


def stray_functions(rooms):
    """Yield each function that a room's header declares and a source of another room defines, as (name, header, source)."""
    files = [(room, file, functions_in(file)) for room in rooms for file in rooms[room]]
    for room, header, declared in files:
        for other, source, defined in files:
            if header.suffix == ".h" and source.suffix == ".c" and room != other:
                yield from ((name, header, source) for name in declared & defined)


def way(arrows, start, end):
    """Return the rooms on a shortest path from `start` to `end`, by breadth-first search; None if there is no path."""
    ways = [[start]]
    seen = {start}
    for path in ways:
        if path[-1] == end:
            return path
        for room in sorted(arrows[path[-1]] - seen):
            seen.add(room)
            ways.append([*path, room])
    return None


def complaints(layers):
    """Yield a message for each violation."""
    rooms = files_of(layers)
    lines = [(room, file, *arrow) for room in rooms for file in rooms[room] for arrow in arrows_from(file, layers)]
    arrows = {room: {to for start, _, _, to in lines if start == room} for room in rooms}
    for room, files in rooms.items():
        modules = {file.stem for file in files}
        if len(modules) > MOST_MODULES:
            yield f"{room}: {len(modules)} modules; expected at most {MOST_MODULES}, the others in a room of their own"
        if room not in layers.rooms:
            yield f"{room}: no room of scripts/checks/rooms.py; expected it there, behind all that it includes"
    for name, header, source in stray_functions(rooms):
        if {"fmi2", "fmi3"} != {header.parent.name, source.parent.name}:  # an FMU has one of these rooms
            yield f"{source.relative_to(ROOT)} defines {name}(), which {header.relative_to(ROOT)} declares; expected it in one room"
    heights = {room: height for height, room in enumerate(layers.rooms)}
    for start, file, name, to in lines:
        if heights.get(to, 0) > heights.get(start, len(heights)):
            back = way(arrows, to, start)
            circle = f", a circle: {' -> '.join([start, *back])}" if back else ""
            yield f"{file.relative_to(ROOT)} includes {name}, of a room above its own{circle}; expected arrows that lead down"


if __name__ == "__main__":
    found = [complaint for layers in ALL_LAYERS for complaint in complaints(layers)]
    sys.exit("\n".join(found) or None)
