"""A page in which an FMU runs, or a simulation of it is played: one HTML file, which needs no server and no network."""

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
from .wasm import compile_to_wasm

HERE = Path(__file__).resolve().parent
# Of Debian's package libjs-three, or beside this folder, where the wheel has them.
THREE_FILES = ("three.min.js", "examples/js/controls/OrbitControls.js")
THREE = next((folder for folder in (HERE.parent / "three", Path("/usr/share/javascript/three")) if (folder / THREE_FILES[0]).exists()), None)
THREE_LICENSES = (HERE.parent / "three" / "copyright", Path("/usr/share/doc/libjs-three/copyright"))
SCRIPTS = ("description.js", "history.js", "plot.js", "controls.js", "shapes.js", "scene.js", "pull.js", "inputs.js", "video.js", "system.js", "main.js")
BEGIN = ("unpacking.js", "begin.js")
COMMON_WORKER = ("fmu.js", "sides.js", "worker.js")
MOST_ROWS, MOST_NUMBERS = 2000, 300_000  # of a simulation that is played
SHORTEST, LONGEST = 2.0, 60.0  # s that are played as they are; others take
PLAYED = 10.0  # s
PIECE = 8192  # bytes of WebAssembly


def packed(content):
    """By gzip, in letters of base 85, of which "<" would end scripts of a page; begin.js unpacks it."""
    return base64.b85encode(gzip.compress(content, 9, mtime=0)).decode().replace("<", ",")


def _interleaved(modules):
    """
    Some modules as one, a piece of each after the other: they have most functions in common, about as far into each, so that gzip finds them again within its window.
    Their lengths tell the page how to take them apart.
    """
    count = -(-len(modules[0]) // PIECE)
    pieces = (module[len(module) * i // count : len(module) * (i + 1) // count] for i in range(count) for module in modules)
    return {"wasm": packed(b"".join(pieces)), "lengths": [len(module) for module in modules], "pieces": count}


def script_of(names):
    return "\n".join((HERE / name).read_text(encoding="utf-8") for name in names)


def renderer():
    """three.js, packed."""
    if THREE is None:
        raise Problem("there is no three.js, which draws the page; install Debian's package libjs-three")
    return packed("\n".join((THREE / name).read_text(encoding="utf-8") for name in THREE_FILES).encode())


def licenses(has_scene, has_fmu):
    """What is in the page, and on what terms."""
    texts = ["The C library in the FMU's WebAssembly is musl, under the MIT license: https://musl.libc.org"] if has_fmu else []
    if has_scene:
        texts.append("three.js, Copyright 2010-2019 three.js authors, under the MIT license:\n\n" + _mit(next(path for path in THREE_LICENSES if path.exists()).read_text(encoding="utf-8")))
    return "\n\n".join(texts)


def _mit(copyright_file):
    """The text of the license in a Debian copyright file."""
    found = re.search(r"^License: (?:Expat|MIT)\n((?: .*\n?)+)", copyright_file, re.M)
    if not found:
        raise Problem("three.js comes without the text of the MIT license; expected that of Debian's package libjs-three")
    return re.sub(r"^ \.?", "", found[1], flags=re.M)


def one_source(fmu, folder):
    """The FMU's one file of C, unpacked into the folder."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if re.fullmatch(r"sources/[^/]*\.c", name)]
        if len(names) != 1:
            raise Problem(f"{Path(fmu).name} carries no sources, since its method is SUNDIALS'; give the system another <solver>, such as auto")
        return archive.extract(names[0], folder)


def _text(content):
    """A text of the page, in bytes, packed; begin.js has it back."""
    return {"packed": packed(content)}


def common(has_scene, has_fmu):
    """What pages of all systems have."""
    return {
        "renderer": renderer() if has_scene else "",
        "licenses": licenses(has_scene, has_fmu),
        "script": packed(f"(async () => {{\n{script_of(SCRIPTS)}\n}})();\n".encode()),
    }


def filled(template, **parts):
    """The text of a file in which names between @ stand for parts."""
    return re.sub("@([A-Z]+)@", lambda part: parts[part[1]], (HERE / template).read_text(encoding="utf-8"))


def json_of(data):
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def page_of_data(title, data):
    """The page as text; data: what it runs or plays, and common(); or a text that stands for them."""
    style, content = (HERE / "page.css").read_text(encoding="utf-8"), data if isinstance(data, str) else json_of(data)
    return filled("page.html", TITLE=html.escape(title), STYLE=style, DATA=content, SCRIPT=script_of(BEGIN))


def _title(tree):
    return tree.get("description") or tree.get("modelName")


def _modules(source, pulled):
    """The FMU in WebAssembly, and where bodies can be pulled what runs then."""
    return _interleaved([compile_to_wasm(one) for one in (source, pulled) if one])


def page_of(fmu, origin=None):
    """The page of an FMU (FMI 2.0) that lagrange-fmu made, as text; where its Origin is known, bodies can be pulled and the system is there to be saved."""
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
        data |= _modules(source, pulled)
    if origin:
        data["system"] = Path(origin.system).read_text(encoding="utf-8")
    return page_of_data(_title(tree), data)


def recording_of(result):
    """Rows of a simulation's result, a structured array, as the page reads them: the time and all variables, as many rows as it can show."""
    names = [name for name in result.dtype.names if name != "time"]
    count = max(2, min(MOST_ROWS, len(result), MOST_NUMBERS // (len(names) + 1)))
    rows = np.unique(np.linspace(0, len(result) - 1, count).round().astype(int))
    numbers = np.stack([result[name][rows] for name in ("time", *names)], axis=1)
    duration = float(result["time"][-1] - result["time"][0])
    speed = 1.0 if SHORTEST <= duration <= LONGEST or duration == 0.0 else duration / PLAYED
    return {"rows": packed(numbers.astype("<f8").tobytes()), "names": names, "duration": duration, "speed": speed}


def page_of_motion(tree, result, start):
    """The page that plays the result of simulating an FMU, whose modelDescription.xml is the tree, from these start values of all that have one, as text."""
    data = {
        "modelDescription": _text(ElementTree.tostring(tree)),
        "recording": recording_of(result),
        "start": {name: float(value) for name, value in start.items()},
        **common(bool(scene_of(tree)), has_fmu=False),
    }
    return page_of_data(_title(tree), data)


def write_page(fmu, path, origin=None):
    return write_whole(path, page_of(fmu, origin))
