"""Compare the time of one evaluation of a robot's accelerations: the C code of the FMU, and Pinocchio's articulated-body algorithm in C++."""

import importlib.util
import math
import shutil
import subprocess
from pathlib import Path
from statistics import median

from building import runtime
from fmu import LAGC, ROOT

from numerics.space import hand

FOLDER = ROOT / "build" / "accelerations"
SOURCES = Path(__file__).parent
# Name, description, file among the example robots, and base of each robot.
ROBOTS = [
    ("UR5", "6 axes", "ur_description/urdf/ur5_robot.urdf", "fixed"),
    ("Panda", "7 axes and 2 fingers", "panda_description/urdf/panda.urdf", "fixed"),
    ("Allegro", "hand of 16 axes", "allegro_hand_description/urdf/allegro_right_hand.urdf", "fixed"),
    ("ANYmal", "quadruped, 12 axes on a base that flies", "anymal_b_simple_description/robots/anymal.urdf", "floating"),
    ("Humanoid", "29 axes on a base that flies", "simple_humanoid_description/urdf/simple_humanoid.urdf", "floating"),
    ("iCub", "32 axes on a base that flies", "icub_description/robots/icub_reduced.urdf", "floating"),
]
CHAINS = [10, 20, 40, 80, 120, 200]  # axes in series
ROUND = 0.05  # s of one program in one round
# A header of each package, the folders in which releases of Debian have it, and the package.
SYSTEM = Path("/usr/include")
HEADERS = [("Eigen/Core", [SYSTEM / "eigen3"], "libeigen3-dev"),
           ("urdf_model/model.h", [SYSTEM / "urdfdom_headers", SYSTEM], "liburdfdom-headers-dev")]  # fmt: skip
# Pinocchio's headers have longer lists than Boost's preprocessed headers allow.
FLAGS = ["-O3", "-DNDEBUG", "-std=c++17", "-DPINOCCHIO_WITH_URDFDOM", "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
         "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]  # fmt: skip
# Pinocchio's programs, and their flags. Those for this machine keep the alignment and the allocation of Eigen in the library, which is built without them.
PROGRAMS = {"aba": [], "aba-native": ["-march=native", "-DEIGEN_MAX_ALIGN_BYTES=16", "-DEIGEN_MALLOC_ALREADY_ALIGNED=1"]}
LIBRARIES = ["-lpinocchio_default", "-lpinocchio_parsers", "-lurdfdom_model"]
NOTE = ("Nanoseconds of the processor's time, medians of rounds in which the programs take turns; the ratio is the median of the rounds' ratios. The FMU's: "
        "derivatives() of its generated C, with gcc -O2 as in the FMU. Pinocchio's: aba() of "
        "its release for Python, from C++ with -O3, in the faster of its two conventions; native: with -march=native, which the FMU does without. It has a joint of its own for the finger of the Panda that mimics the other.")  # fmt: skip
HEADER = ["robot", "joints", "FMU [ns]", "Pinocchio [ns]", "native [ns]", "Pinocchio / FMU", "native / FMU"]


class Missing(Exception):
    """A program or package is not installed; the text is a sentence for the report."""


def prefix():
    """Return the folder of Pinocchio's headers and libraries, and of the example robots; raise Missing if it is not installed."""
    spec = importlib.util.find_spec("pinocchio")
    if spec is None or spec.origin is None:
        raise Missing("Pinocchio (the Python package pin) is not installed here.")
    return next(folder for folder in Path(spec.origin).parents if folder.name == "cmeel.prefix")


def written(path, text):
    """Write a file, unless it has this content already; return its path."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    return path


def chain(count):
    """Write the URDF of a chain of links, with hinges about x, y and z in turn; return its path."""
    link = """<link name="link{0}"><inertial><origin xyz="0.01 0.02 -0.15"/><mass value="1.5"/>
      <inertia ixx="0.02" iyy="0.021" izz="0.004" ixy="0.001" iyz="0.0005" ixz="0.0007"/></inertial></link>"""
    hinge = """<joint name="joint{0}" type="continuous"><parent link="link{1}"/><child link="link{0}"/>
      <origin xyz="0.02 0.01 -0.3"/><axis xyz="{2} {3} {4}"/></joint>"""
    parts = [hinge.format(i, i - 1, *(int(i % 3 == axis) for axis in range(3))) + link.format(i) for i in range(1, count + 1)]
    return written(FOLDER / f"chain{count}.urdf", f'<robot name="chain{count}"><link name="link0"/>{"".join(parts)}</robot>')


def is_current(target, *sources):
    return target.exists() and all(target.stat().st_mtime >= source.stat().st_mtime for source in sources)


def run(*words):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise RuntimeError(f"{words[0]} ends with {result.returncode}: {result.stderr.strip()[:300]}")
    return result.stdout


def our_program(name, path, base):
    folder = FOLDER / name
    program, system = folder / "accelerations", folder / "system.xml"
    if is_current(program, LAGC, path, SOURCES / "accelerations.c"):
        return program
    folder.mkdir(parents=True, exist_ok=True)
    system.write_text(f'<system name="{name}"><include file="{path}" as="robot" base="{base}"/></system>')
    run(LAGC, system, "-o", folder)
    flags = ["-O2", "-std=gnu11", "-ffp-contract=off", "-falign-functions=64", "-ffunction-sections", "-Wl,--gc-sections"]
    run("gcc", *flags, f"-I{ROOT}/include", f"-I{ROOT}/src/runtime", SOURCES / "accelerations.c", folder / "system.c", *runtime(2), "-o", program)
    return program


def folder_of(header, folders, package):
    """Return the folder in which a header is installed; raise Missing if there is none."""
    found = next((folder for folder in folders if (folder / header).exists()), None)
    if found is None:
        raise Missing(f"Pinocchio's times are not here: its program needs {header} (Debian's {package}).")
    return found


def pinocchio_program(name, quick):
    """Compile the program of PROGRAMS and return its path; this takes minutes once, and is skipped in a quick report."""
    program, source, folder = FOLDER / name, SOURCES / "aba.cpp", prefix()
    if is_current(program, source):
        return program
    if shutil.which("g++") is None:
        raise Missing("Pinocchio's times are not here: its program needs g++, which is not installed.")
    eigen, robots = (folder_of(*header) for header in HEADERS)
    if quick:
        raise Missing("Pinocchio's times are not here: its program takes minutes to compile, which a report without --quick does once.")
    FOLDER.mkdir(parents=True, exist_ok=True)
    includes = [f"-I{path}" for path in (eigen, folder / "include", folder / "include" / "urdfdom", robots)]
    run("g++", *FLAGS, *PROGRAMS[name], *includes, source, "-o", program, f"-L{folder}/lib", *LIBRARIES, f"-Wl,-rpath,{folder}/lib")
    return program


def seconds(words, count):
    """Return the seconds of one evaluation, the shortest time that the program prints."""
    return min(map(float, run(*words, count).split()))


def measured(programs, rounds):
    """Return the seconds of one evaluation, rounds x programs."""
    counts = [max(1, round(ROUND / seconds(words, 100))) for words in programs]
    return [[seconds(words, count) for words, count in zip(programs, counts)] for _ in range(rounds)]


def row(name, text, times):
    """Return the row of a robot; `times` has the seconds of the FMU, and of Pinocchio's programs if they are there, in each round."""
    ours, *others = zip(*times)
    others += [[math.nan] * len(ours)] * (len(PROGRAMS) - len(others))
    ratios = [median(their / our for our, their in zip(ours, theirs)) for theirs in others]
    return [name, text, round(1e9 * median(ours)), *(1e9 * median(theirs) for theirs in others), *ratios]


def rows(quick):
    """Return the rows, and sentences about missing programs and packages."""
    sentences, lines = [], []
    try:
        robots = prefix() / "share" / "example-robot-data" / "robots"
        if not robots.exists():
            raise Missing("The robots (the Python package example-robot-data) are not installed here.")
    except Missing as error:
        return [], [f"No accelerations of robots: {error}"]
    try:
        pinocchio = [pinocchio_program(name, quick) for name in PROGRAMS]
    except (Missing, RuntimeError) as error:
        pinocchio, sentences = [], [str(error)]
    cases = [(name, text, robots / path, base) for name, text, path, base in ROBOTS[: 1 if quick else None]]
    if not quick and hand.source() is None:
        sentences.append("No Shadow hand: the Python package gymnasium-robotics, or mujoco, is not installed here.")
    elif not quick:
        cases.append(("Shadow", "hand of 24 axes", written(FOLDER / "shadow.urdf", hand.urdf()), "fixed"))
    cases += [(f"Chain{count}", f"{count} axes, one after another", chain(count), "fixed") for count in CHAINS if not quick]
    for name, text, path, base in cases:
        programs = [[our_program(name, path, base)], *([program, path, base] for program in pinocchio)]
        lines.append(row(name, text, measured(programs, 5 if quick else 20)))
    return lines, sentences
