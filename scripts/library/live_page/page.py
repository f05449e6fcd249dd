"""Write a page in which an FMU runs, or a recorded simulation is played: one HTML file that needs no server and no network."""

import base64
import gzip
import html
import json
import re
import tempfile
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ..problem import Problem
from ..whole_files import write_whole
from .description import scene_of
from .origin import can_be_pulled, pulled_system
from .wasm import cached_wasm

HERE = Path(__file__).resolve().parent
# Files of three.js, in Debian's package libjs-three, or in the wheel beside this folder.
THREE_FILES = ("three.min.js", "examples/js/controls/OrbitControls.js")
THREE = next((folder for folder in (HERE.parent / "three", Path("/usr/share/javascript/three")) if (folder / THREE_FILES[0]).exists()), None)
THREE_LICENSES = (HERE.parent / "three" / "copyright", Path("/usr/share/doc/libjs-three/copyright"))
SCRIPTS = ("description.js", "history.js", "plot.js", "controls.js", "shapes.js", "lines.js", "arrows.js", "scene.js", "pull.js", "inputs.js", "video.js", "system.js", "energies.js", "presentation.js", "presets.js", "tasks.js", "equilibrium.js", "ghost.js", "main.js")
BEGIN = ("unpacking.js", "begin.js")
COMMON_WORKER = ("fmu.js", "variants.js", "linear_algebra.js", "linearization.js", "linear_motion.js", "worker.js")
MOST_ROWS, MOST_NUMBERS = 2000, 300_000  # limits of a recording, which bound the size of its page
SHORTEST, LONGEST = 2.0, 60.0  # recordings of a length between these, in s, are played in real time
PLAYED = 10.0  # s, playing time of shorter and longer recordings
PIECE = 8192  # bytes of interleaved pieces, well below the window of gzip, 32 kB


def packed(content):
    """Compress with gzip and encode in base 85, with "," for "<", which could end a script element; unpacking.js reverses this."""
    return base64.b85encode(gzip.compress(content, 9, mtime=0)).decode().replace("<", ",")


def _interleaved(modules):
    """
    Interleave the pieces of several modules.

    The modules have most functions in common, at about the same relative offset. Interleaved, equal parts are within the window of gzip.
    """
    count = -(-len(modules[0]) // PIECE)
    pieces = (module[len(module) * i // count : len(module) * (i + 1) // count] for i in range(count) for module in modules)
    return {"wasm": packed(b"".join(pieces)), "lengths": [len(module) for module in modules], "pieces": count}


def script_of(names):
    """Return the scripts one after another, without the lines that are comments and without indentation."""
    return re.sub(r"^ *(//.*\n)?", "", "\n".join((HERE / name).read_text(encoding="utf-8") for name in names), flags=re.M)


def renderer():
    """Return three.js, packed; raise Problem if it is not installed."""
    if THREE is None:
        raise Problem("three.js, which draws the page, is not installed; install Debian's package libjs-three")
    return packed("\n".join((THREE / name).read_text(encoding="utf-8") for name in THREE_FILES).encode())


def licenses(has_scene, has_fmu):
    """Return the licenses of the libraries in a page."""
    texts = ["The C library in the FMU's WebAssembly is musl, under the MIT license: https://musl.libc.org"] if has_fmu else []
    if has_scene:
        texts.append("three.js, Copyright 2010-2019 three.js authors, under the MIT license:\n\n" + _mit(next(path for path in THREE_LICENSES if path.exists()).read_text(encoding="utf-8")))
    return "\n\n".join(texts)


def _mit(copyright_file):
    """Return the text of the MIT license in a Debian copyright file."""
    found = re.search(r"^License: (?:Expat|MIT)\n((?: .*\n?)+)", copyright_file, re.M)
    if not found:
        raise Problem("three.js comes without the text of the MIT license; expected that of Debian's package libjs-three")
    return re.sub(r"^ \.?", "", found[1], flags=re.M)


def one_source(fmu, folder):
    """Unpack the FMU's C source into the folder and return its path; raise Problem if the FMU has none."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if re.fullmatch(r"sources/[^/]*\.c", name)]
        if len(names) != 1:
            raise Problem(f"{Path(fmu).name} contains no sources, since its method is of SUNDIALS; give the system another <solver>, such as auto")
        return archive.extract(names[0], folder)


def _text(content):
    """Return a text, given as bytes, in the form that textOf() of begin.js reads."""
    return {"packed": packed(content)}


def common(has_scene, has_fmu):
    """Return the data that pages of all systems have in common."""
    return {
        "renderer": renderer() if has_scene else "",
        "licenses": licenses(has_scene, has_fmu),
        "script": packed(f"(async () => {{\n{script_of(SCRIPTS)}\n}})();\n".encode()),
    }


def filled(template, **parts):
    """Return the text of a template in which each @NAME@ is replaced by the part of this name."""
    return re.sub("@([A-Z]+)@", lambda part: parts[part[1]], (HERE / template).read_text(encoding="utf-8"))


def json_of(data):
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def page_of_data(title, data):
    """Return the page as text; `data` is a dict that includes common(), or a text in its place."""
    style, content = (HERE / "page.css").read_text(encoding="utf-8"), data if isinstance(data, str) else json_of(data)
    return filled("page.html", TITLE=html.escape(title), STYLE=style, DATA=content, SCRIPT=script_of(BEGIN))


def _title(tree):
    return tree.get("description") or tree.get("modelName")


def _modules(source, pulled, cache):
    """Compile the FMU, and the variant whose bodies can be pulled if there is one, to WebAssembly."""
    return _interleaved([cached_wasm(one, cache) for one in (source, pulled) if one])


def page_of(fmu, origin=None, settings=None, cache=None):
    """
    Return the page of an FMU of FMI 2.0 as text; with an Origin bodies can be pulled, and the system can be saved. `settings` has numbers by name,
    with which the page begins. `cache` is a folder that keeps compiled modules for other pages.
    """
    with zipfile.ZipFile(fmu) as archive:
        description, equations = (archive.read(name) for name in ("modelDescription.xml", "documentation/index.html"))
    tree = ElementTree.fromstring(description)
    if tree.get("fmiVersion") != "2.0":
        raise Problem(f"{Path(fmu).name} is of FMI {tree.get('fmiVersion')}; expected the one of FMI 2.0")
    has_scene = bool(scene_of(tree))
    data = {"modelDescription": _text(description), "equations": _text(equations), "worker": packed(script_of(COMMON_WORKER).encode()), **common(has_scene, has_fmu=True)}
    with tempfile.TemporaryDirectory() as folder:
        source = one_source(fmu, folder)
        found, pulled = pulled_system(origin, source, folder) if origin and has_scene else None, None
        if found and can_be_pulled(found[0]):
            data["pulled"], pulled = _text(found[0]), found[1]
        data |= _modules(source, pulled, cache)
    if settings:
        data["settings"] = {name: float(value) for name, value in settings.items()}
    if origin:
        data["system"] = Path(origin.system).read_text(encoding="utf-8")
    return page_of_data(_title(tree), data)


def recording_of(result):
    """Return a simulation's result, a structured array, in the form that the page reads, thinned to at most MOST_ROWS rows."""
    names = [name for name in result.dtype.names if name != "time"]
    count = max(2, min(MOST_ROWS, len(result), MOST_NUMBERS // (len(names) + 1)))
    rows = np.unique(np.linspace(0, len(result) - 1, count).round().astype(int))
    numbers = np.stack([result[name][rows] for name in ("time", *names)], axis=1)
    duration = float(result["time"][-1] - result["time"][0])
    speed = 1.0 if SHORTEST <= duration <= LONGEST or duration == 0.0 else duration / PLAYED
    return {"rows": packed(numbers.astype("<f8").tobytes()), "names": names, "duration": duration, "speed": speed}


def page_of_motion(tree, result, start):
    """Return the page that plays a result as text; `tree` is modelDescription.xml, `start` has the start values of all variables by name."""
    data = {
        "modelDescription": _text(ElementTree.tostring(tree)),
        "recording": recording_of(result),
        "start": {name: float(value) for name, value in start.items()},
        **common(bool(scene_of(tree)), has_fmu=False),
    }
    return page_of_data(_title(tree), data)


def write_page(fmu, path, origin=None, settings=None, cache=None):
    """Write the page of an FMU, see page_of(), and return its path."""
    return write_whole(path, page_of(fmu, origin, settings, cache))
