"""Build the site build/gallery, from the FMUs in build/fmu and build/fmi3 and the pages of the tree, with MkDocs; for scripts/gallery."""

import html
import json
import logging
import re
import shutil
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from markdown.extensions import toc
from mkdocs.commands.build import build
from mkdocs.config import load_config

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from scripts.commands.live import LABORATORY, origin_in
from scripts.library.live_page.description import read_tree
from scripts.library.live_page.editor import files_of, write_editor
from scripts.library.live_page.page import write_page
from scripts.library.problem import Problem
from scripts.library.whole_files import write_whole
from scripts.pages.reference_pages import PYTHON, reference_pages, relink, sections_of

BUILD = ROOT / "build"
PAGES, SITE = BUILD / "gallery-pages", BUILD / "gallery"
# Pages by title, with their paths in the tree, on which their links to one another depend.
READ = {
    "Start": "README.md",
    "Gallery": "gallery.md",
    "Tutorials": {
        "All tutorials": "fmu/tutorials/README.md",
        "A pendulum in the browser": "fmu/tutorials/pendulum-in-the-browser.md",
        "From a pendulum to a robot": "fmu/TUTORIAL.md",
        "A crane for Simulink": "fmu/tutorials/crane-for-simulink.md",
        "A robot from URDF": "fmu/howto/robot-from-urdf.md",
        "A controller coupled by SSP": "fmu/howto/couple-by-ssp.md",
    },
    "How-to": {
        "All tasks": "fmu/howto/README.md",
        "Close a loop": "fmu/howto/close-a-loop.md",
        "Draw a system": "fmu/howto/draw-a-system.md",
        "Add a sampled controller": "fmu/howto/sampled-controller.md",
        "Fit data": "fmu/howto/fit-data.md",
        "Sweep on many machines": "fmu/howto/sweep-on-many-machines.md",
        "Gear with losses": "fmu/howto/gear-with-losses.md",
        "Brake": "fmu/howto/brake.md",
        "Rope": "fmu/howto/rope.md",
        "Tanks": "fmu/howto/tanks.md",
        "One-way clutch": "fmu/howto/one-way-clutch.md",
        "Tyre": "fmu/howto/tyre.md",
        "Import into FMPy": "fmu/howto/import-into-fmpy.md",
        "Import into OMSimulator": "fmu/howto/import-into-omsimulator.md",
        "Import into CasADi": "fmu/howto/import-into-casadi.md",
        "Import into Simulink and Dymola": "fmu/howto/import-into-simulink-and-dymola.md",
        "Integrate into CMake": "fmu/howto/integrate-into-cmake.md",
    },
    "Reference": {},  # made of fmu/README.md and fmu/system.xsd by reference_pages
    "Theory": {
        "Overview": "fmu/theory/README.md",
        "1. Equations of motion": "fmu/theory/01-equations-of-motion.md",
        "2. Constraints": "fmu/theory/02-constraints.md",
        "3. Kinematic trees": "fmu/theory/03-kinematic-trees.md",
        "4. Impacts": "fmu/theory/04-impacts.md",
        "5. Contact and friction": "fmu/theory/05-contact-and-friction.md",
        "6. Events": "fmu/theory/06-events.md",
        "7. Taylor series": "fmu/theory/07-taylor-series.md",
        "8. Stiff systems": "fmu/theory/08-stiff-systems.md",
        "9. Derivatives": "fmu/theory/09-derivatives.md",
        "10. Tolerances": "fmu/theory/10-tolerances.md",
        "Bibliography": "fmu/theory/BIBLIOGRAPHY.md",
    },
    "More": {
        "Questions, by message": "fmu/FAQ.md",
        "Glossary": "fmu/GLOSSARY.md",
        "Systems, and what they were checked against": "fmu/SYSTEMS.md",
        "What the solvers guarantee": "fmu/SOLVERS.md",
        "Importing FMUs": "fmu/IMPORTING.md",
        "Other tools": "fmu/COMPARISON.md",
        "The Python package": "scripts/wheel/README.md",
        "Python functions and classes": "python.md",
        "Scripts": "scripts/README.md",
        "The code": "src/README.md",
        "Contributing": "CONTRIBUTING.md",
        "Style guide": "src/STYLE.md",
        "Changes": "CHANGELOG.md",
    },
}
DOCSTRINGS = {"docstring_style": "numpy", "show_source": False, "show_root_toc_entry": False, "show_bases": False, "heading_level": 2, "separate_signature": True}
PYTHON_WORDS = "From the docstrings. [The Python package](scripts/wheel/README.md) introduces it by examples."
MADE = {"gallery.md", "python.md"}  # pages that are no files of the tree
FIRST = "DoublePendulum"  # system that the laboratory shows first
# Files to which pages link.
BESIDE = ("fmu/systems.gif", "fmu/tutorials/laboratory.png", "fmu/tutorials/crane-blocks.svg", "fmu/system.xsd", "scripts/coupling/slaves.py", "scripts/coupling/BalancedCart/SystemStructure.ssd", *(f"fmu/{name}/system.xml" for name in (
    "BristleFriction", "ChainPendulum", "DigitalServo", "FourBar", "GantryCrane", "HangingCable", "HydraulicCylinder", "PidController", "Rope", "SpinningBeam", "StateFeedback",
    "WormGear")))  # fmt: skip
STYLE = """
.systems { display: grid; grid-template-columns: repeat(auto-fill, minmax(230px, 1fr)); gap: 1rem; }
.systems div { border: 1px solid #8884; border-radius: 8px; padding: .8rem; display: flex; flex-direction: column; gap: .4rem; }
.scene { display: none; }
.sketch svg { display: block; width: 100%; height: 170px; }
.sketch circle { fill: currentColor; }
.sketch polyline { fill: none; stroke: currentColor; stroke-width: 3; stroke-linecap: round; stroke-linejoin: round; }
.sketch .area { fill: currentColor; fill-opacity: .3; stroke-width: 1.5; }
.sketch .face { fill-opacity: .1; }
.sketch .ground { fill-opacity: .12; }
.sketch .ground, .sketch .thin { stroke-width: 1.8; }
.sketch .body { stroke-width: 7; }
.sketch .body.area { stroke-width: 3; fill-opacity: .1; }
.sketch .ground, .sketch .link { color: var(--bs-secondary-color); }
.sketch .body, .sketch .solid, .sketch .particle { color: var(--bs-link-color); }
.sketch .base { color: var(--bs-body-color); }
.systems h3 { margin: 0; font-size: 1.05rem; overflow-wrap: anywhere; }
.systems p { margin: 0; font-size: .9rem; flex: 1; }
.systems a { white-space: nowrap; }
[data-bs-theme=light] { --bs-link-color-rgb: 20, 102, 170; --bs-link-hover-color-rgb: 12, 70, 120; }
@media (max-width: 800px) {
  table { display: block; overflow-x: auto; }
  td code { white-space: normal; overflow-wrap: anywhere; }
}
"""


def paths_of(pages):
    """Yield the paths of all pages."""
    for page in pages.values():
        yield from paths_of(page) if isinstance(page, dict) else [page]


def write_system(archive):
    """Write the files of a system's FMU into a folder of its name; return its card as HTML."""
    name, folder = archive.stem, PAGES / "systems" / archive.stem
    folder.mkdir(parents=True)
    with zipfile.ZipFile(archive) as content:
        equations = content.read("documentation/index.html").decode()
    write_whole(folder / "equations.html", equations)
    shutil.copy(archive, folder / f"{name}.fmu")
    links = {"equations": "equations.html", "FMU": f"{name}.fmu"}
    if (BUILD / "fmi3" / archive.name).exists():
        shutil.copy(BUILD / "fmi3" / archive.name, folder / f"{name}-FMI3.fmu")
        links["FMI 3"] = f"{name}-FMI3.fmu"
    source = ROOT / "fmu" / name / "system.xml"
    if source.exists():
        shutil.copy(source, folder / "system.xml")
        links["system.xml"] = "system.xml"
    try:
        write_page(archive, folder / "live.html", origin_in(BUILD, source) if source.exists() else None, cache=BUILD / "wasm")
        links = {"<b>live</b>": "live.html"} | links
    except Problem as problem:  # an FMU whose method has no sources in it
        print(f"scripts/gallery: no live page: {problem}", file=sys.stderr)
    addresses = {text: f"systems/{name}/{path}" for text, path in links.items()}
    name_of_first, first = next(iter(addresses.items()))
    if can_be_edited(name):
        addresses = {name_of_first: first, "edit": f"laboratory.html#{name}"} | addresses
    sentence = html.escape(read_tree(archive).get("description") or "")
    words = " · ".join(f'<a href="{address}">{text}</a>' for text, address in addresses.items())
    return f'<div><a href="{first}" aria-label="{name}">{scene_of_page(equations)}</a><h3>{name}</h3><p>{sentence}</p><span>{words}</span></div>'


def scene_of_page(page):
    """Return the scene in a system's page of equations, which the site's script draws; "" if it has none."""
    found = re.search(r'<pre class="scene">.*?</pre>', page, re.S)
    return found[0] if found else ""


def drawing_script():
    """Return the script of the pages that draws scenes, which begins when a page of the site is loaded."""
    script = (ROOT / "modelDescription" / "page" / "sketch.js").read_text(encoding="utf-8")
    return f"{{{script}\ndocument.querySelectorAll('.scene').forEach((scene) => drawScene(scene));\n}}\n"


def can_be_edited(name):
    """Return whether the laboratory supports the method of a system of fmu/."""
    source = ROOT / "fmu" / name / "system.xml"
    return source.exists() and not re.search(r"""method *= *["'](erk|bdf)["']""", source.read_text(encoding="utf-8"))


def write_laboratory(names):
    """Write the page in which systems can be changed. Return a sentence about it."""
    chosen = list(filter(can_be_edited, names))
    if not chosen:
        return ""
    first = FIRST if FIRST in chosen else chosen[0]
    sources = {name: ROOT / "fmu" / name / "system.xml" for name in chosen}
    write_editor(sources[first], LABORATORY, PAGES / "laboratory.html", {name: files_of(source) for name, source in sources.items()}, "gallery.html")
    return 'In the [laboratory](laboratory.html) you change them, or write your own: it derives the equations in your browser.\n'


def write_pages(paths):
    """Write the pages of the tree, with the reference cut into its parts, and return the navigation of the reference."""
    source = (ROOT / "fmu" / "README.md").read_text(encoding="utf-8")
    reference, navigation = reference_pages(source, (ROOT / "fmu" / "system.xsd").read_text(encoding="utf-8"))
    sections = sections_of(source)
    for path in paths:
        (PAGES / path).parent.mkdir(parents=True, exist_ok=True)
        if path.endswith(".md"):
            write_whole(PAGES / path, relink((ROOT / path).read_text(encoding="utf-8"), path, path, sections))
        else:
            shutil.copy(ROOT / path, PAGES / path)
    for path, text in reference.items():
        (PAGES / path).parent.mkdir(parents=True, exist_ok=True)
        write_whole(PAGES / path, text)
    parts = [f"::: {module}\n    options:\n      members: {json.dumps(members)}" for module, members in PYTHON.items()]
    write_whole(PAGES / "python.md", "\n\n".join(["# Python functions and classes", PYTHON_WORDS, *parts]))
    return navigation


def slug(text, separator):
    """Return the anchor of a heading; the theme does not find anchors that begin with a digit."""
    word = toc.slugify(text, separator)
    return f"part{separator}{word}" if word[:1].isdigit() else word


def build_site(navigation):
    logging.basicConfig(format="%(message)s", level=logging.WARNING)  # shows the warnings that end a strict build
    shutil.copy(ROOT / "scripts" / "pages" / "gallery_search.js", PAGES / "search.js")
    write_whole(PAGES / "drawing.js", drawing_script())
    settings = {"site_name": "lagrange-fmu", "docs_dir": str(PAGES), "site_dir": str(SITE), "nav": navigation, "use_directory_urls": False, "strict": True,
                "extra_css": ["style.css"], "extra_javascript": ["search.js", "drawing.js"], "plugins": ["search", {"mkdocstrings": {"handlers": {"python": {"paths": [str(ROOT / "scripts" / "wheel")], "options": DOCSTRINGS}}}}],
                "theme": {"name": "mkdocs", "highlightjs": False}}  # fmt: skip
    file = BUILD / "mkdocs.json"  # JSON is YAML, which MkDocs reads
    write_whole(file, json.dumps(settings))
    build(load_config(str(file), markdown_extensions=[{"toc": {"slugify": slug}}]))
    index = (SITE / "search" / "search_index.json").read_text()
    write_whole(SITE / "search" / "search_index.js", f"window.searchIndex = {index};")


def main():
    archives = sorted((BUILD / "fmu").glob("*.fmu"))
    if not archives:
        sys.exit("scripts/gallery: there are no FMUs in build/fmu")
    shutil.rmtree(PAGES, ignore_errors=True)
    contents = READ | {"Reference": write_pages({*paths_of(READ), *BESIDE} - MADE)}
    with ThreadPoolExecutor() as pool:
        cards = list(pool.map(write_system, archives))
    words = "Each system runs in its live page, without a server or a network: the FMU itself is in the page. "
    words += write_laboratory([archive.stem for archive in archives])
    write_whole(PAGES / "gallery.md", f'# Gallery\n\n{words}\n<div class="systems">\n{"".join(cards)}\n</div>\n')
    write_whole(PAGES / "style.css", STYLE)
    navigation = [{title: [{t: p} for t, p in page.items()] if isinstance(page, dict) else page} for title, page in contents.items()]
    build_site(navigation)
    print(f"gallery    {SITE / 'index.html'}")


if __name__ == "__main__":
    try:
        main()
    except Problem as problem:
        sys.exit(f"scripts/gallery: {problem}")
