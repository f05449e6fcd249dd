"""A page in which an FMU runs: one HTML file, which needs no server and no network."""

import base64
import gzip
import html
import json
import re
import tempfile
import zipfile
from pathlib import Path

from ..problem import Problem
from .description import description_of, first_plots, read_tree, scene_of, shown_variables
from .wasm import compile_to_wasm

HERE = Path(__file__).resolve().parent
# Debian's package libjs-three.
THREE = Path("/usr/share/javascript/three")
THREE_FILES = ("three.min.js", "examples/js/controls/OrbitControls.js")
THREE_LICENSE = Path("/usr/share/doc/libjs-three/copyright")
SCRIPTS = ("history.js", "plot.js", "controls.js", "shapes.js", "scene.js", "main.js")
WORKER = ("fmu.js", "worker.js")
WINDOW = 20.0  # s that plots show, or the experiment where that is shorter


def _packed(content):
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()


def _script(names):
    return "\n".join((HERE / name).read_text(encoding="utf-8") for name in names)


def renderer():
    """three.js, packed."""
    missing = [name for name in THREE_FILES if not (THREE / name).exists()]
    if missing:
        raise Problem(f"there is no {THREE / missing[0]}, which draws the page; install Debian's package libjs-three")
    return _packed("\n".join((THREE / name).read_text(encoding="utf-8") for name in THREE_FILES).encode())


def licenses(has_scene):
    """What is in the page, and on what terms."""
    texts = ["The C library in the FMU's WebAssembly is musl, under the MIT license: https://musl.libc.org"]
    if has_scene:
        texts.append("three.js, Copyright 2010-2019 three.js authors, under the MIT license:\n\n" + _mit(THREE_LICENSE.read_text(encoding="utf-8")))
    return "\n\n".join(texts)


def _mit(copyright_file):
    """The text of the license in a Debian copyright file."""
    found = re.search(r"^License: (?:Expat|MIT)\n((?: .*\n?)+)", copyright_file, re.M)
    if not found:
        raise Problem(f"{THREE_LICENSE} has no text of the MIT license; expected that of Debian's package libjs-three")
    return re.sub(r"^ \.?", "", found[1], flags=re.M)


def one_source(fmu, folder):
    """The FMU's one file of C, unpacked into the folder."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if re.fullmatch(r"sources/[^/]*\.c", name)]
        if len(names) != 1:
            raise Problem(f"{Path(fmu).name} carries no sources, since its method is SUNDIALS'; give the system another <solver>, such as auto")
        return archive.extract(names[0], folder)


def page_of(fmu):
    """The page of an FMU (FMI 2.0) that lagrange-fmu made, as text."""
    tree = read_tree(fmu)
    if tree.get("fmiVersion") != "2.0":
        raise Problem(f"{Path(fmu).name} is of FMI {tree.get('fmiVersion')}; expected the one of FMI 2.0")
    description, scene = description_of(tree), scene_of(tree)
    shown = shown_variables(tree, description, scene)
    with tempfile.TemporaryDirectory() as folder:
        wasm = compile_to_wasm(one_source(fmu, folder))
    data = {
        "description": description,
        "scene": scene,
        "hasScene": bool(scene),
        "shown": shown,
        "plots": first_plots(description, shown),
        "window": min(WINDOW, description["duration"]),
        "worker": _script(WORKER),
        "wasm": _packed(wasm),
        "renderer": renderer() if scene else "",
        "licenses": licenses(bool(scene)),
    }
    parts = {
        "TITLE": html.escape(description["title"]),
        "STYLE": (HERE / "page.css").read_text(encoding="utf-8"),
        "DATA": json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
        "SCRIPT": f"(() => {{\n{_script(SCRIPTS)}\n}})();\n",
    }
    return re.sub("@(TITLE|STYLE|DATA|SCRIPT)@", lambda part: parts[part[1]], (HERE / "page.html").read_text(encoding="utf-8"))


def write_page(fmu, path):
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page_of(fmu), encoding="utf-8")
    return path
