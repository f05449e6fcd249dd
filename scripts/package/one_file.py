"""
Write the C source of an FMU as one file, made of the system and the runtime: one_file.py ROOT GLOBAL_NAMES VERSION SYSTEM.c NAME FILE

GLOBAL_NAMES is the output of nm for the compiled runtime. The names in it get the FMU's name and the version of FMI as a prefix. So several FMUs, and
both versions of one, can be linked into one program.
"""

import re
import sys
from pathlib import Path

INCLUDE = re.compile(r'#include "([a-z0-9_/]+\.[ch])"\n')
LIBRARY = re.compile(r"#include <([a-z/]+\.h)>\n")
NAMING = {2: "FMI 2.0.4, section 2.1.1", 3: "FMI 3.0.2, section 2.2.2"}  # sections of the standards that define the prefix
HEAD = """/*
 * {license}
 */

/*
 * {name} in C11, without any library but libm. Several FMUs can be linked into one program: the functions of FMI begin
 * with {name}_ ({section}). For a shared library, whose functions have no prefix, define
 * {fmi}_OVERRIDE_FUNCTION_PREFIX. CMake defines {name}_EXPORTS for a shared library of this name, which does the same.
 */
#define FMU_IN_ONE_FILE
#ifdef __GNUC__ /* a system needs few of the functions and arguments */
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#ifndef LANES
{names}#endif
#if !defined({fmi}_OVERRIDE_FUNCTION_PREFIX) && !defined({name}_EXPORTS)
#ifndef {fmi}_FUNCTION_PREFIX
#define {fmi}_FUNCTION_PREFIX {name}_
#endif
#define {fmi}_PASTE(prefix, name) prefix##name
#define {fmi}_FULL_NAME(prefix, name) {fmi}_PASTE(prefix, name)
{functions}#endif

{text}"""


def included_once(text, root, included):
    """
    Replace the first #include of each project file by its text, and delete the others; `included` is the set of files so far.

    Files of the runtime lose the repeated ones of C's library. Those of include/ keep them, since they are compiled without the runtime over lanes.
    """

    def library(found):
        is_new = found[1] not in included
        included.add(found[1])
        return found[0] if is_new else ""

    def content(found):
        if found[1] in included:
            return ""
        included.add(found[1])
        file = next(path for path in (root / "include" / found[1], root / "src" / "runtime" / found[1]) if path.exists())
        part = file.read_text(encoding="utf-8").replace("#pragma once\n", "")
        if file.is_relative_to(root / "src"):
            part = LIBRARY.sub(library, part)
        return included_once(part, root, included)

    return INCLUDE.sub(content, text)


def one_file(root, global_names, version, system, name):
    """Return the text of the file; `version` is the version of FMI, `system` the path of system.c, `name` the FMU's name."""
    fmi, runtime = f"FMI{version}", root / "src" / "runtime"
    # The functions of this version of FMI; the rest of the runtime is common to all versions.
    layer = "".join(f'#include "{path.relative_to(runtime).as_posix()}"\n' for path in sorted((runtime / f"fmi{version}").glob("*.c")))
    text = system.read_text(encoding="utf-8").replace("#ifdef FMU_IN_ONE_FILE\n", f"#ifdef FMU_IN_ONE_FILE\n{layer}")
    text = included_once(text, root, set())
    text = re.sub(r"(?<=\S) +(?=/\*|\\\n)", " ", text)  # aligned comments and continued lines
    text = re.sub(r"\n{3,}", "\n\n", text)
    symbols = sorted({*re.findall(r"([A-Za-z0-9_]+) [A-Z] ", global_names.read_text()), "lagrangian"})
    functions = [symbol for symbol in symbols if symbol.startswith(f"fmi{version}")]
    words = set(re.findall(r"\w+", text))
    names = [symbol for symbol in symbols if not re.match("fmi[0-9]", symbol) and symbol in words]
    return HEAD.format(
        license=re.sub(r" \* $", " *", (root / "LICENSE").read_text().strip().replace("\n", "\n * "), flags=re.M),
        name=name,
        fmi=fmi,
        section=NAMING[version],
        names="".join(f"#define {symbol} {name}_fmi{version}_{symbol}\n" for symbol in names),
        functions="".join(f"#define {symbol} {fmi}_FULL_NAME({fmi}_FUNCTION_PREFIX, {symbol})\n" for symbol in functions),
        text=text,
    )


def main():
    root, global_names, version, system, name, file = sys.argv[1:]
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    text = one_file(Path(root), Path(global_names), int(version), Path(system), name)
    Path(file).write_bytes(text.encode())


if __name__ == "__main__":
    main()
