"""
Pack an FMU from the files that lagc wrote and compiled libraries, or FMUs that are coupled as an SSP archive.

    python -m scripts.package.pack fmu FOLDER VERSION ARCHIVE --libraries FILE... --names FILE --licenses FOLDER [--system FILE]
    python -m scripts.package.pack ssp SystemStructure.ssd ARCHIVE FMU...

Equal content gives equal bytes. All parts of FMUs and their places are defined in this file; the Python package has it too.
"""

import argparse
import io
import os
import re
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

from .one_file import one_file

ROOT = Path(__file__).resolve().parents[2]
TIME = (2000, 1, 1, 0, 0, 0)  # modification time of all members
LICENSES = "documentation/licenses"


def archive_of(members, first="modelDescription.xml"):
    """Return the bytes of a zip archive; members are files or bytes by their names in it. They come in order of name, after the first one."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as file:
        for name in sorted(members, key=lambda name: (name != first, name)):
            entry = zipfile.ZipInfo(name, TIME)
            entry.create_system = 3  # Unix, so that external_attr holds permissions
            entry.external_attr = 0o100644 << 16
            content = members[name]
            file.writestr(entry, content if isinstance(content, bytes) else content.read_bytes(), zipfile.ZIP_DEFLATED, 9)
    return packed.getvalue()


def name_of(folder):
    """Return the name of the system from which lagc wrote the folder."""
    return ElementTree.parse(folder / "modelDescription.xml").find("CoSimulation").get("modelIdentifier")


def library_members(libraries):
    """Return the members for libraries, each in a folder that has the name of its platform. WebAssembly needs a manifest."""
    members = {f"binaries/{library.parent.name}/{library.name}": library for library in libraries}
    if any(library.parent.name.startswith("wasm") for library in libraries):
        # The first name is that of the draft FMI-LS-WASM, the second that of FMI 3.0 for all layered standards.
        for manifest in ("manifest.xml", "fmi-ls-manifest.xml"):
            members[f"extra/org.modelica.fmi-ls-wasm/{manifest}"] = ROOT / "scripts" / "package" / "wasm_component" / "manifest.xml"
    return members


def license_members(folder, licenses):
    """Return the members for the license, which lagc wrote, and for those of the libraries that it names, which are in the folder `licenses`."""
    file = folder / LICENSES / "license.txt"
    members = {f"{LICENSES}/license.txt": file}
    for names in re.findall(" is linked into it: (.*)", file.read_text(encoding="utf-8")):
        for name in names.split(", "):
            if (licenses / name).exists():
                members[f"{LICENSES}/{name}"] = licenses / name
            else:
                print(f"warning: {LICENSES}/{name} is missing: put the licence of the library into {licenses / name}", file=sys.stderr)
    return members


def source_members(folder, name, version, global_names):
    """Return the members for the sources. lagc asks for them by a build description, which FMI 3.0 has, for FMUs without external libraries."""
    description = folder / "fmi3" / "buildDescription.xml"
    if not description.exists():
        return {}
    members = {f"sources/{name}.c": one_file(ROOT, global_names, version, folder / "system.c", name).encode()}
    return members | ({"sources/buildDescription.xml": description} if version == 3 else {})


def description_members(folder, version):
    """Return the members for descriptions, documentation and icons."""
    members = {"documentation/index.html": folder / "documentation" / "index.html"}
    if version == 2:
        return members | {name: folder / name for name in ("modelDescription.xml", "model.png")}
    pictures = ("terminalsAndIcons.xml", "icon.svg", *(path.name for path in (folder / "fmi3").glob("flange.*")))
    members |= {f"terminalsAndIcons/{name}": folder / "fmi3" / name for name in pictures}
    return members | {"modelDescription.xml": folder / "fmi3" / "modelDescription.xml", "terminalsAndIcons/icon.png": folder / "model.png"}


def fmu_of(folder, version, libraries, global_names, licenses):
    """
    Return the bytes of an FMU.

    `folder` is what lagc wrote, `version` that of FMI, `global_names` the file with the global names of the compiled runtime.
    """
    members = description_members(folder, version) | library_members(libraries) | license_members(folder, licenses)
    return archive_of(members | source_members(folder, name_of(folder), version, global_names))


def write(archive, content):
    """Write the archive, which exists completely or not at all."""
    archive.parent.mkdir(parents=True, exist_ok=True)
    temporary = archive.with_name(f".{archive.name}.{os.getpid()}")
    temporary.write_bytes(content)
    os.replace(temporary, archive)


def words():
    parser = argparse.ArgumentParser(description=__doc__.strip().partition("\n")[0])
    kinds = parser.add_subparsers(dest="kind", required=True)
    fmu = kinds.add_parser("fmu")
    fmu.add_argument("folder", type=Path)
    fmu.add_argument("version", type=int)
    fmu.add_argument("archive", type=Path)
    fmu.add_argument("--libraries", type=Path, nargs="+", required=True)
    fmu.add_argument("--names", type=Path, required=True)
    fmu.add_argument("--licenses", type=Path, required=True)
    fmu.add_argument("--system", default="", help="the system's file, for messages")
    ssp = kinds.add_parser("ssp")
    ssp.add_argument("structure", type=Path)
    ssp.add_argument("archive", type=Path)
    ssp.add_argument("fmus", type=Path, nargs="+")
    return parser.parse_args()


def main():
    given = words()
    if given.kind == "ssp":
        write(given.archive, archive_of({"SystemStructure.ssd": given.structure} | {f"resources/{fmu.name}": fmu for fmu in given.fmus}, "SystemStructure.ssd"))
        return
    found, expected = name_of(given.folder), given.libraries[0].name.partition(".")[0]
    if found != expected:  # importers look for the library by the name in modelDescription.xml
        sys.exit(f"{given.system}: the system is named '{found}'; expected '{expected}', as its folder or lagrange_add_fmu() names it")
    write(given.archive, fmu_of(given.folder, given.version, given.libraries, given.names, given.licenses))


if __name__ == "__main__":
    main()
