"""Object files linked into each FMU, from the linker's map."""

import re

import fmu


def linked_members(name, map="link.map"):
    """Bytes of each object file after garbage collection of sections."""
    text = (fmu.archive(name).parent.parent / "systems" / name / map).read_text()
    text = text[text.index("Linker script and memory map") :]
    sizes = {}
    for size, member in re.findall(r"^ \.\S+\s+0x0*[1-9a-f][0-9a-f]*\s+0x([0-9a-f]+) (\S+)$", text, re.M):
        member = member.rsplit("/", 1)[-1]
        sizes[member] = sizes.get(member, 0) + int(size, 16)
    return {member: size for member, size in sizes.items() if size > 0}


def sizes():
    """Sizes in bytes of each FMU, as rows (name, archive, library, SUNDIALS, equations)."""
    rows = []
    for name in fmu.all_names():
        members = linked_members(name)
        sundials = sum(size for member, size in members.items() if "sundials" in member)
        own = sum(size for member, size in members.items() if "system.c.o" in member)
        rows.append((name, fmu.archive(name).stat().st_size, fmu.library(name).stat().st_size, sundials, own))
    return rows
