"""A page in which a system is written, derived and run: lagc and the FMU's runtime are in it, as WebAssembly, and no compiler is needed."""

import html
import os
import re
from pathlib import Path

from ..problem import Problem
from ..whole_files import write_whole
from .page import COMMON_WORKER, common, filled, json_of, licenses, packed, page_of_data, script_of

HERE = Path(__file__).resolve().parent
LIBXML2_LICENSES = (HERE.parent / "licenses" / "libxml2.txt", HERE.parent.parent / "build" / "libxml2" / "Copyright")  # in the wheel, in the tree
STYLE, SCRIPTS = "editor.css", ("unpacking.js", "editor.js")
MESHES = (".stl", ".obj")
CHECKER = ("laboratory.js", "checker.js")
WORKER = (*COMMON_WORKER[:-1], "laboratory.js", COMMON_WORKER[-1])


def _named_in(file):
    """The files that a system's file names, as far as they are there: what it includes, and tables."""
    if file.suffix != ".xml":
        return
    for name in re.findall(r'\bfile\s*=\s*["\']([^"\'{}]+)["\']', file.read_text(encoding="utf-8")):
        if (file.parent / name).is_file():
            yield (file.parent / name).resolve()


def files_of(system):
    """The texts of a system's files by their paths below one folder, and the path of the system's own among them."""
    found = [Path(system).resolve()]
    for file in found:
        mesh = next((other for other in _named_in(file) if other.suffix.lower() in MESHES), None)
        if mesh is not None:
            raise Problem(f"{file.name} names the mesh {mesh.name}, which a page that changes systems cannot hold; expected other shapes, or a page without --edit")
        found += [other for other in _named_in(file) if other not in found]
    folder = Path(os.path.commonpath([file.parent for file in found]))
    if folder == found[0].parent:
        folder = folder.parent  # a system is called by its folder in messages and by what is saved
    texts = {file.relative_to(folder).as_posix(): file.read_text(encoding="utf-8") for file in found}
    return {"files": texts, "file": next(iter(texts))}


def _licenses():
    """What is in the page, and on what terms: as in pages of FMUs, and libxml2."""
    file = next((path for path in LIBXML2_LICENSES if path.exists()), None)
    if file is None:
        raise Problem("the license of libxml2, which is in the page, is not there; see scripts/libxml2")
    return f"{licenses(has_scene=True, has_fmu=True)}\n\nlibxml2:\n\n{file.read_text(encoding='utf-8')}"


def editor_of(system, laboratory, examples=None):
    """The page as text. laboratory: the module laboratory.wasm; examples: further systems to choose, as files_of() by name."""
    if not Path(laboratory).exists():
        raise Problem(f"there is no {laboratory}, in which systems are derived in a page; see scripts/laboratory")
    data = {
        **files_of(system),
        "examples": examples or {},
        "laboratory": packed(Path(laboratory).read_bytes()),
        "checker": packed(script_of(CHECKER).encode()),
        "common": {"worker": packed(script_of(WORKER).encode()), **common(has_scene=True, has_fmu=True), "licenses": _licenses()},
        "page": packed(page_of_data("A system", "@DATA@").encode()),
    }
    title = f"{Path(data['file']).parent.name or Path(data['file']).stem}, to be written"
    style = (HERE / STYLE).read_text(encoding="utf-8")
    return filled("editor.html", TITLE=html.escape(title), STYLE=style, DATA=json_of(data), SCRIPT=script_of(SCRIPTS))


def write_editor(system, laboratory, path, examples=None):
    return write_whole(path, editor_of(system, laboratory, examples))
