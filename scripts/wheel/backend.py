"""
Build wheels for this machine and other platforms, as a build backend on top of scikit-build-core; zig compiles lagc.

    pip wheel --no-deps -C platform=win64 scripts/wheel

A source distribution contains the needed parts of the tree, and in libraries/ the linked libraries, so that it builds without packages of an
operating system.
"""

import io
import os
import platform
import subprocess
import sys
import tarfile
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

import scikit_build_core.build
from scikit_build_core.build import *  # noqa: F403

# Tag of the wheel, zig's target, and CMake's name of the system. A wheel for macOS is for one processor, while an FMU has both.
PLATFORMS = {
    "linux64": ("manylinux_2_17_x86_64", "x86_64-linux-gnu.2.17", "Linux"),
    "aarch64-linux": ("manylinux_2_17_aarch64", "aarch64-linux-gnu.2.17", "Linux"),
    "win64": ("win_amd64", "x86_64-windows-gnu", "Windows"),
    "darwin64": ("macosx_11_0_x86_64", "x86_64-macos.11.0", "Darwin"),
    "aarch64-darwin": ("macosx_11_0_arm64", "aarch64-macos.11.0", "Darwin"),
}

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
LIBRARIES = ROOT / "libraries"  # exists in a source distribution only
OF_THE_TREE = ("include", "modelDescription", "scripts", "src", "fmu/system.xsd", "fmu/README.md", "CMakeLists.txt", "LICENSE")
# pyproject.toml at the top of a source distribution; the other settings are beside this file.
PYPROJECT = """[build-system]
requires = ["scikit-build-core==1.1.2", "ziglang==0.17.1"]
build-backend = "backend"
backend-path = ["scripts/wheel"]
"""
os.chdir(HERE)


def this_machine():
    """Return the name of this machine's platform."""
    processor = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    for name, (_, target, system) in PLATFORMS.items():
        if target.startswith(f"{processor}-") and system == platform.system():
            return name
    sys.exit(f"there is no wheel for {platform.machine()} with {platform.system()}; expected -C platform=..., of {', '.join(PLATFORMS)}")


@contextmanager
def settings_for_platform(settings):
    """Yield the settings of scikit-build-core for the platform, while the environment defines the wheel's tag."""
    settings = dict(settings or {})
    name = settings.pop("platform", None) or this_machine()
    if name not in PLATFORMS:
        sys.exit(f"the platform '{name}' is not known; expected {', '.join(PLATFORMS)}")
    tag, target, system = PLATFORMS[name]
    defined = {"TARGET": target}
    if LIBRARIES.exists():
        defined |= {"SUNDIALS": str(LIBRARIES / "sundials"), "LIBXML2_SOURCE": str(LIBRARIES / "libxml2"), "LICENSES": str(LIBRARIES / "licenses"),
                    "THREE": str(LIBRARIES / "three"), "THREE_COPYRIGHT": str(LIBRARIES / "three" / "copyright")}  # fmt: skip
    if name != this_machine():
        defined |= {"CMAKE_SYSTEM_NAME": system, "CMAKE_SYSTEM_PROCESSOR": target.split("-")[0]}
    with mock.patch.dict("os.environ", _PYTHON_HOST_PLATFORM=tag):
        yield settings | {f"cmake.define.{key}": value for key, value in defined.items()}


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with settings_for_platform(config_settings) as settings:
        return scikit_build_core.build.build_wheel(wheel_directory, settings, metadata_directory)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    with settings_for_platform(config_settings) as settings:
        return scikit_build_core.build.prepare_metadata_for_build_wheel(metadata_directory, settings)


def get_requires_for_build_wheel(config_settings=None):
    with settings_for_platform(config_settings) as settings:
        return scikit_build_core.build.get_requires_for_build_wheel(settings)


def _description():
    """Return the name of the source distribution's folder, and its PKG-INFO."""
    with TemporaryDirectory() as folder:
        name = scikit_build_core.build.build_sdist(folder).removesuffix(".tar.gz")
        with tarfile.open(Path(folder) / f"{name}.tar.gz") as archive:
            return name, archive.extractfile(f"{name}/PKG-INFO").read()


def _contents():
    """Yield the files of a source distribution as (path in it, path here)."""
    for part in OF_THE_TREE:
        for path in [ROOT / part] if (ROOT / part).is_file() else sorted((ROOT / part).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path.relative_to(ROOT).as_posix(), path
    licenses = {f"{name}.txt": Path(f"/usr/share/doc/lib{name}-dev/copyright") for name in ("sundials", "suitesparse")}
    licenses["LGPL-2.1.txt"] = Path("/usr/share/common-licenses/LGPL-2.1")
    for name, path in licenses.items():
        yield f"libraries/licenses/{name}", LIBRARIES / "licenses" / name if LIBRARIES.exists() else path
    three = {name: Path("/usr/share/javascript/three") / name for name in ("three.min.js", "examples/js/controls/OrbitControls.js")}
    for name, path in (three | {"copyright": Path("/usr/share/doc/libjs-three/copyright")}).items():
        yield f"libraries/three/{name}", LIBRARIES / "three" / name if LIBRARIES.exists() else path
    for name, tree in (("libxml2", "libxml2"), ("sundials", "sundials-all")):
        folder = LIBRARIES / name if LIBRARIES.exists() else ROOT / "build" / tree
        for path in sorted(folder.rglob("*")):
            if path.is_file() and not {"test", "result", "doc", "python", "fuzz", "debian", ".pc"} & set(path.relative_to(folder).parts[:1]):
                yield f"libraries/{name}/{path.relative_to(folder).as_posix()}", path


def build_sdist(sdist_directory, config_settings=None):
    if not LIBRARIES.exists():
        for script in ("libxml2", "sundials-all"):
            subprocess.run([ROOT / "scripts" / "package" / script], env={**os.environ, "PYTHON": sys.executable}, check=True)
    name, description = _description()
    with tarfile.open(Path(sdist_directory) / f"{name}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:

        def add(place, content, mode):
            entry = tarfile.TarInfo(f"{name}/{place}")
            entry.size, entry.mode, entry.mtime = len(content), mode, 946684800  # 2000-01-01
            archive.addfile(entry, io.BytesIO(content))

        add("PKG-INFO", description, 0o644)
        add("pyproject.toml", PYPROJECT.encode(), 0o644)
        for place, path in _contents():
            add(place, path.read_bytes(), 0o755 if os.access(path, os.X_OK) else 0o644)
    return f"{name}.tar.gz"
