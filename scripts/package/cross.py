"""
Compile for other platforms with zig, which has compilers, linkers and C libraries for all of them (the Python package ziglang).

    cross.py fmu PLATFORM SYSTEM.c BINARIES NAME [--fmi 3] [--sundials FOLDER]    compiles a system.c to the libraries in binaries/
    cross.py libraries PLATFORM NAME [--fmi 3]                                    prints the paths of these libraries, separated by ;
    cross.py sundials FOLDER SUNDIALS SUITESPARSE                                 compiles SUNDIALS and KLU for all platforms

All properties of platforms are defined in this file.
"""

import argparse
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

# Folders in binaries/ of FMI 2.0, with the suffix of libraries and zig's targets. FMI 2.0.5 defines the first three, and takes others from
# FMI 3.0, whose names are those of the targets, one for each processor.
PLATFORMS = {
    "linux64": (".so", ["x86_64-linux-gnu.2.17"]),
    "win64": (".dll", ["x86_64-windows-gnu"]),
    "darwin64": (".dylib", ["x86_64-macos.11.0", "aarch64-macos.11.0"]),
    "aarch64-linux": (".so", ["aarch64-linux-gnu.2.17"]),
}
WEBASSEMBLY = "wasm32"  # a component of the draft FMI-LS-WASM, for FMI 3.0 only; see wasm_component/
PLATFORM_NAMES = [*PLATFORMS, WEBASSEMBLY]
ROOT = Path(__file__).resolve().parents[2]  # contains include/ and src/runtime/

# No fused multiply-add, so that results are equal on all platforms. Unused functions are removed.
FLAGS = ["-std=c11", "-O2", "-fvisibility=hidden", "-ffp-contract=off", "-ffunction-sections", "-fdata-sections", "-fno-sanitize=all"]
# Redirect the allocations of SUNDIALS, see src/runtime/methods/sundials/sundials_memory.c: not all linkers have --wrap.
ALLOCATIONS = [f"-D{name}=__wrap_{name}" for name in ("malloc", "calloc", "realloc", "free")]
SUNDIALS_PARTS = ["sundials", "arkode", "cvode", "nvector/serial", "sunmatrix/dense", "sunmatrix/band", "sunmatrix/sparse", "sunlinsol/dense",
                  "sunlinsol/band", "sunlinsol/klu", "sunnonlinsol/newton", "sunnonlinsol/fixedpoint"]  # fmt: skip
# Interfaces to Fortran and to other libraries, and profilers, which some platforms lack.
LEFT_OUT = re.compile(r"^f(ark|cv|n|sun)|xbraid|hypamg|profiler|fused|futils")
KLU_PARTS = ["KLU", "AMD", "COLAMD", "BTF"]


class Failure(Exception):
    """A compilation failed; the text has the compiler's messages."""


def zig(*words, cache):
    """
    Run zig with these arguments; raise Failure if it fails.

    `cache` is its local cache. The compiled C libraries of platforms stay in ZIG_GLOBAL_CACHE_DIR, by default zig's own folder.
    """
    environment = {"ZIG_LOCAL_CACHE_DIR": str(cache), **os.environ}
    result = subprocess.run([sys.executable, "-m", "ziglang", *map(str, words)], env=environment, capture_output=True, text=True)
    if result.returncode != 0:
        raise Failure(result.stderr.strip())


@contextmanager
def scratch(output):
    """Yield a temporary folder beside the output, so that a finished file can be moved atomically."""
    output.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=output.parent, prefix=".cross-") as folder:
        yield Path(folder)


def libraries_of(platform, name, fmi=2):
    """Return the targets of each library of an FMU for the platform, by its path in binaries/. Raise Failure if the platform is unknown."""
    if platform not in PLATFORM_NAMES:
        raise Failure(f"the platform '{platform}' is not known; expected {', '.join(PLATFORM_NAMES)}")
    require_package("ziglang", f"compiles for {platform}")
    if platform == WEBASSEMBLY:
        require_package("wasmtime", f"makes components for {platform}")
        if fmi == 2:
            raise Failure(f"FMI 2.0 knows no platform {platform}; expected FMI 3")
        return {f"wasm32-wasip2/{name}.wasm": ["wasm32-wasi"]}
    suffix, targets = PLATFORMS[platform]
    if fmi == 2:
        # Importers on Apple's own processors look first, or only, into the folder of FMI 3.0.
        further = {f"{folder_of(target)}/{name}{suffix}": [target] for target in targets[1:]}
        return {f"{platform}/{name}{suffix}": targets, **further}
    return {f"{folder_of(target)}/{name}{suffix}": [target] for target in targets}


def require_package(name, purpose):
    if find_spec(name) is None:
        pinned = re.search(rf"^{name}==.*", (ROOT / "scripts" / "requirements" / "platforms.txt").read_text(), re.M)
        raise Failure(f"the Python package {name}, which {purpose}, is not installed; expected one after pip install {pinned[0]}")


def folder_of(target):
    """Return the name of a target's folder in FMI 3.0."""
    processor, system = target.split(".")[0].split("-")[:2]
    return f"{processor}-{'darwin' if system == 'macos' else system}"


def universal(slices):
    """Join Mach-O files for several processors into a universal binary: a big-endian header with the offset of each, a multiple of 2^14."""
    align = 14
    header, content = struct.pack(">II", 0xCAFEBABE, len(slices)), b""
    start = 1 << align
    for data in slices:
        content = content.ljust(-(-len(content) // start) * start, b"\0")
        processor, variant = struct.unpack_from("<II", data, 4)
        header += struct.pack(">IIIII", processor, variant, start + len(content), len(data), align)
        content += data
    return header.ljust(start, b"\0") + content


def compiler_arguments(target, system, fmi, source):
    """
    Return the arguments that compile system.c, the runtime that it includes, and the functions of the version of FMI into one object.

    system.c comes first, since it defines how series are compiled: unrolled series of large systems take compilers minutes.
    """
    *before, last = [system, *sorted((source / "src" / "runtime" / f"fmi{fmi}").glob("*.c"))]
    words = ["-target", target, *FLAGS, "-DFMU_IN_ONE_FILE", f"-ffile-prefix-map={source}=.", f"-ffile-prefix-map={system.parent}=."]
    words += [f"-I{source / 'include'}", f"-I{source / 'src' / 'runtime'}"]
    return [*words, *(word for file in before for word in ("-include", file)), last]


def compile_target(target, system, library, fmi, source, sundials, folder):
    """Compile the FMU for one target in the folder; return the bytes of the library."""
    output = folder / target / library
    output.parent.mkdir()
    words = ["-shared", "-s", "-Wl,--gc-sections"]
    if "macos" in target:
        words.append(f"-Wl,-install_name,@rpath/{library}")
    if sundials is not None:
        words += [f"-I{sundials / 'include'}", sundials / target / "libsundials.a"]
    zig("cc", *compiler_arguments(target, system, fmi, source), *words, "-lm", "-o", output, cache=folder / "cache")
    return output.read_bytes()


def compile_component(target, system, source, folder):
    """Compile the FMU and its adapter to a WebAssembly module; return the bytes of the component around it."""
    if __package__:
        from .wasm_component.component import ADAPTER, LINK_WORDS, component_of
    else:
        from wasm_component.component import ADAPTER, LINK_WORDS, component_of
    fmu, module = folder / "fmu.o", folder / "module.wasm"
    zig("cc", *compiler_arguments(target, system, 3, source), "-c", "-o", fmu, cache=folder / "cache")
    zig("cc", "-target", target, *FLAGS, f"-I{source / 'include'}", ADAPTER, fmu, *LINK_WORDS, "-o", module, cache=folder / "cache")
    return component_of(module.read_bytes())


def compile_fmu(platform, system, binaries, name, fmi=2, source=ROOT, sundials=None):
    """
    Compile a system.c of lagc to the platform's libraries in the folder `binaries`.

    `name` and `fmi` are the name and the version of FMI of the FMU. The runtime is in source/include and source/src/runtime. `sundials` is the
    folder of compile_sundials(), which systems with the methods erk and bdf need. Raise Failure if the compilation fails.
    """
    system, source = Path(system).resolve(), Path(source).resolve()
    if '#include "methods/sundials/' not in system.read_text():
        sundials = None
    elif platform == WEBASSEMBLY:
        raise Failure(f"{system} needs SUNDIALS, which is not available for {platform}; expected another <solver> than erk and bdf")
    elif sundials is None or not (Path(sundials) / "include").exists():
        raise Failure(f"{system} needs SUNDIALS for {platform}; expected the libraries of scripts/package/sundials-all, or another <solver> than erk and bdf")
    else:
        sundials = Path(sundials).resolve()
    compiled = {}
    for path, targets in libraries_of(platform, name, fmi).items():
        library = Path(binaries).resolve() / path
        with scratch(library) as folder:
            for target in targets:
                if platform == WEBASSEMBLY:
                    compiled[target] = compile_component(target, system, source, folder)
                elif target not in compiled:
                    compiled[target] = compile_target(target, system, library.name, fmi, source, sundials, folder)
            slices = [compiled[target] for target in targets]
            (folder / library.name).write_bytes(universal(slices) if len(slices) > 1 else slices[0])
            (folder / library.name).replace(library)


def sundials_configuration(source):
    """Return the text of sundials_config.h: double precision, indices of 32 bits, which KLU has on all platforms, and no optional parts."""
    version = re.search(r'PACKAGE_VERSION_MAJOR "(\d+)".*?MINOR "(\d+)".*?PATCH "(\d+)"', (source / "CMakeLists.txt").read_text(), re.S).groups()
    values = dict(zip(("PACKAGE_VERSION_MAJOR", "PACKAGE_VERSION_MINOR", "PACKAGE_VERSION_PATCH"), version), PACKAGE_VERSION=".".join(version),
                  PRECISION_LEVEL="#define SUNDIALS_DOUBLE_PRECISION 1", INDEX_TYPE="#define SUNDIALS_INT32_T 1", SUNDIALS_CINDEX_TYPE="int32_t",
                  SUNDIALS_LOGGING_LEVEL="0")  # fmt: skip
    there = ("SUNDIALS_C_COMPILER_HAS_MATH_PRECISIONS", "SUNDIALS_C_COMPILER_HAS_ISINF_ISNAN", "SUNDIALS_C_COMPILER_HAS_INLINE",
             "SUNDIALS_C_COMPILER_HAS_SNPRINTF_AND_VA_COPY")  # fmt: skip
    text = (source / "include" / "sundials" / "sundials_config.in").read_text()
    text = re.sub(r"#cmakedefine01 (\w+)", r"#define \1 0", text)
    text = re.sub(r"#cmakedefine (\w+).*", lambda found: f"#define {found[1]}" if found[1] in there else "", text)
    return re.sub(r"@(\w+)@", lambda found: values.get(found[1], ""), text)


def write_headers(include, sundials, suitesparse):
    shutil.copytree(sundials / "include", include)
    (include / "sundials" / "sundials_config.h").write_text(sundials_configuration(sundials))
    (include / "sundials" / "sundials_export.h").write_text("#define SUNDIALS_EXPORT\n#define SUNDIALS_NO_EXPORT\n#define SUNDIALS_DEPRECATED_EXPORT\n")
    for header in [*(suitesparse / "SuiteSparse_config").glob("*.h"), *(path for part in KLU_PARTS for path in (suitesparse / part / "Include").glob("*.h"))]:
        shutil.copy(header, include)


def compile_sundials(folder, sundials, suitesparse):
    """Compile SUNDIALS and KLU from their unpacked sources to folder/include and, for each target, folder/TARGET/libsundials.a."""
    folder, sundials, suitesparse = (Path(path).resolve() for path in (folder, sundials, suitesparse))
    sources = [path for part in SUNDIALS_PARTS for path in sorted((sundials / "src" / part).glob("*.c")) if not LEFT_OUT.search(path.name)]
    sources += [path for part in KLU_PARTS for path in sorted((suitesparse / part / "Source").glob("*.c"))]
    sources.append(suitesparse / "SuiteSparse_config" / "SuiteSparse_config.c")
    with scratch(folder) as work:
        write_headers(work / "ready" / "include", sundials, suitesparse)
        includes = [work / "ready" / "include", *(sundials / "src" / part for part in ("sundials", "arkode", "cvode"))]
        for target in [target for _, targets in PLATFORMS.values() for target in targets]:
            library = work / "ready" / target / "libsundials.a"
            library.parent.mkdir()
            zig("build-lib", "-static", "-target", target, "-OReleaseFast", "-fstrip", "-fno-compiler-rt", "-lc", "-fPIC", "--name", "sundials",
                f"-femit-bin={library}", *[f"-I{include}" for include in includes], "-cflags", *FLAGS, *ALLOCATIONS,
                f"-ffile-prefix-map={work.parent}=.", "-w", "--", *sources, cache=work / "cache")  # fmt: skip
        shutil.rmtree(folder, ignore_errors=True)
        (work / "ready").replace(folder)


def main():
    parser = argparse.ArgumentParser(prog="cross.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    fmu, libraries, sundials = (commands.add_parser(name) for name in ("fmu", "libraries", "sundials"))
    for parser_of_one, names in (
        (fmu, ("platform", "system", "binaries", "name")),
        (libraries, ("platform", "name")),
        (sundials, ("folder", "sundials", "suitesparse")),
    ):
        for name in names:
            parser_of_one.add_argument(name)
    for parser_of_one in (fmu, libraries):
        parser_of_one.add_argument("--fmi", type=int, choices=(2, 3), default=2)
    fmu.add_argument("--sundials")
    words = parser.parse_args()
    try:
        if words.command == "libraries":
            print(";".join(libraries_of(words.platform, words.name, words.fmi)))
        elif words.command == "fmu":
            compile_fmu(words.platform, words.system, words.binaries, words.name, words.fmi, sundials=words.sundials)
        else:
            compile_sundials(words.folder, words.sundials, words.suitesparse)
    except Failure as problem:
        sys.exit(f"cross.py: {problem}")


if __name__ == "__main__":
    main()
