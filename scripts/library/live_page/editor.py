"""Write a page in which a system is edited, derived and run; it contains lagc and the runtime as WebAssembly and needs no compiler."""

import html
import os
import re
from pathlib import Path

from ..problem import Problem
from ..whole_files import write_whole
from .page import BEGIN, COMMON_WORKER, common, filled, json_of, licenses, packed, page_of_data, script_of
from .schema import Schema, documentation, enumerated

HERE = Path(__file__).resolve().parent
LIBXML2_LICENSES = (HERE.parent / "licenses" / "libxml2.txt", HERE.parents[2] / "build" / "libxml2" / "Copyright")  # in the wheel, and in the tree
STYLE, SCRIPTS = "editor.css", ("syntax.js", "completion.js", "editor.js")
SCHEMAS = (HERE / "system.xsd", HERE.parents[2] / "fmu" / "system.xsd")  # in the wheel, and in the tree
MESHES = (".stl", ".obj")
CHECKER = ("laboratory.js", "checker.js")
WORKER = (*COMMON_WORKER[:-1], "laboratory.js", COMMON_WORKER[-1])


def _named_in(file):
    """Yield the existing files that a system's file names: included systems, and tables."""
    if file.suffix != ".xml":
        return
    for name in re.findall(r'\bfile\s*=\s*["\']([^"\'{}]+)["\']', file.read_text(encoding="utf-8")):
        if (file.parent / name).is_file():
            yield (file.parent / name).resolve()


def files_of(system):
    """
    Return a dict of "files" and "file". "files" has the texts of a system's files by their paths in a common folder; "file" is the path of the
    system's own.
    """
    found = [Path(system).resolve()]
    for file in found:
        mesh = next((other for other in _named_in(file) if other.suffix.lower() in MESHES), None)
        if mesh is not None:
            raise Problem(f"{file.name} uses the mesh {mesh.name}, which an editable page cannot contain; expected other shapes, or a page without --edit")
        found += [other for other in _named_in(file) if other not in found]
    folder = Path(os.path.commonpath([file.parent for file in found]))
    if folder == found[0].parent:
        folder = folder.parent  # keeps the name of the system's folder, for messages and for names of saved files
    texts = {file.relative_to(folder).as_posix(): file.read_text(encoding="utf-8") for file in found}
    return {"files": texts, "file": next(iter(texts))}


def _licenses():
    """Return the licenses of a page of an FMU, and that of libxml2."""
    file = next((path for path in LIBXML2_LICENSES if path.exists()), None)
    if file is None:
        raise Problem("the license of libxml2, which the page needs, is missing; run scripts/package/libxml2")
    return f"{licenses(has_scene=True, has_fmu=True)}\n\nlibxml2:\n\n{file.read_text(encoding='utf-8')}"


def language():
    """Return the completions of the editor: for each element its parents, a sentence, its attributes and its contents."""
    schema = Schema(next(path for path in SCHEMAS if path.exists()).read_text(encoding="utf-8"))

    def kind(parents, declaration):
        sentence, attributes, contents, has_text = schema.frame(declaration)
        named = {a.get("name"): {"text": documentation(a).replace("`", ""), "isRequired": a.get("use") == "required", "values": enumerated(a)} for a in attributes}
        return {"in": parents, "text": sentence.replace("`", ""), "attributes": named, "contains": contents, "hasText": has_text}

    return {name: [kind(*pair) for pair in schema.kinds(name)] for name in schema.elements}


def editor_of(system, laboratory, examples=None, home=None, robot=()):
    """
    Return the page as text. `laboratory` is the path of laboratory.wasm. `examples` has further systems by name, as of files_of(); the page opens the
    one that its address names after "#". `home` is the address of a page to which it links. `robot` has options for the file of a robot, such as
    "base=floating".
    """
    if not Path(laboratory).exists():
        raise Problem(f"there is no {laboratory}, which derives systems in the page; run scripts/package/laboratory")
    data = {
        **files_of(system),
        "robot": list(robot),
        "examples": examples or {},
        "home": home,
        "laboratory": packed(Path(laboratory).read_bytes()),
        "checker": packed(script_of(CHECKER).encode()),
        "common": {"worker": packed(script_of(WORKER).encode()), **common(has_scene=True, has_fmu=True), "licenses": _licenses()},
        "language": packed(json_of(language()).encode()),
        "page": packed(page_of_data("A system", "@DATA@").encode()),
        "script": packed(script_of(SCRIPTS).encode()),
    }
    title = f"{Path(data['file']).parent.name or Path(data['file']).stem}, to be written"
    style = (HERE / STYLE).read_text(encoding="utf-8")
    return filled("editor.html", TITLE=html.escape(title), STYLE=style, DATA=json_of(data), SCRIPT=script_of(BEGIN))


def write_editor(system, laboratory, path, examples=None, home=None, robot=()):
    """Write the page and return its path."""
    return write_whole(path, editor_of(system, laboratory, examples, home, robot))
