"""
Measure the cost of making an FMU, and print tables.

They compare lagc with SymPy's LagrangesMethod and cse, and whole FMUs, with C compiler and packing. They also compare the C of mechanisms and robots
by gcc, clang and zig, and the step of a large stiff system by each implicit method. A table shows where a measurement reaches the limit of time.
"""

import math
import multiprocessing
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from scripts.package.cross import PLATFORMS
from fmu import ROOT
from numerics.driver import step

LIMIT = 60  # s, of each measurement
BUILD = ROOT / "build" / "cost"
SYSTEMS = ROOT / "scripts" / "numerics" / "systems"
CHAINS, LATTICES = (1, 2, 4, 8, 16, 32), (100, 1000, 10000)
WHOLE = [("ChainPendulum", 8), ("ChainPendulum", 32), ("ChainPendulum", 128), ("Lattice", 100), ("Lattice", 1000), ("Arm7", None)]
STIFF, STIFF_METHODS = (10, 30, 100, 300, 1000), ("bdf", "radau", "auto")


def seconds_of(words):
    """Return the wall-clock time of a command in s, or None beyond LIMIT, when its process group is killed."""
    start = time.perf_counter()
    process = subprocess.Popen([str(word) for word in words], stdout=subprocess.DEVNULL, start_new_session=True)
    try:
        status = process.wait(LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return None
    if status != 0:
        raise subprocess.CalledProcessError(status, words)
    return time.perf_counter() - start


def in_seconds(value):
    return f"> {LIMIT} s" if value is None else f"{value:.3g} s"


def ratio(ours, theirs):
    if ours is None:
        return ""
    return f"> {LIMIT / ours:.0f}" if theirs is None else f"{theirs / ours:.0f}"


def source(name):
    folder = SYSTEMS if (SYSTEMS / name).exists() else ROOT / "fmu"
    return folder / name / "system.xml"


def lagc(name, n=None, repeats=5):
    """Return the shortest time of lagc in s, with all files written, and the number of operations; (None, None) beyond LIMIT."""
    with tempfile.TemporaryDirectory() as folder:
        words = [ROOT / "build/bin/lagc", source(name), "-o", folder, *(["-D", f"N={n}"] if n else [])]
        times = [seconds_of(words)]
        while times[0] is not None and times[0] < 1 and len(times) < repeats:
            times.append(seconds_of(words))
        if None in times:
            return None, None
        code = (Path(folder) / "system.c").read_text()
    return min(times), int(re.search(r"d state / dt; (\d+) operations", code).group(1))


def factorization(n):
    """Return the number of operations of the factorization M = L D L^T and of solving for n unknowns."""
    return 1 if n == 1 else n * (n * n - 1) // 3 + n * (n - 1) + 2 * n * (n - 1) + n


def chain_in_sympy(sp, q, t):
    m, l, g = sp.symbols("m l g")
    kinetic = potential = x = y = sp.Integer(0)
    for angle in q:
        x, y = x + l * sp.sin(angle), y - l * sp.cos(angle)
        kinetic += m * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2
        potential += m * g * y
    return kinetic, potential


def lattice_in_sympy(sp, q, t):
    m, k, a = sp.symbols("m k a")
    stretches = [right - left for left, right in zip([0, *q], [*q, 0])]
    return sum(m * x.diff(t) ** 2 / 2 for x in q), sum(k * s**2 / 2 + a * s**4 / 4 for s in stretches)


def arm_in_sympy(sp, q, t):
    m, l, J, Ja, g = sp.symbols("m l J Ja g")
    turn, spin, end = sp.eye(3), sp.zeros(3, 1), sp.zeros(3, 1)
    kinetic = potential = sp.Integer(0)
    for i, angle in enumerate(q):
        axis = 2 if i % 2 == 0 else 1
        turn = turn * (sp.rot_ccw_axis3(angle) if axis == 2 else sp.rot_ccw_axis2(angle))
        spin = spin + turn[:, axis] * angle.diff(t)
        centre, end = end + turn[:, 2] * l / 2, end + turn[:, 2] * l
        kinetic += (m * centre.diff(t).dot(centre.diff(t)) + J * spin.dot(spin) + (Ja - J) * spin.dot(turn[:, 2]) ** 2) / 2
        potential += m * g * centre[2]
    return kinetic, potential


IN_SYMPY = {"ChainPendulum": chain_in_sympy, "Lattice": lattice_in_sympy, "Arm7": arm_in_sympy}


def derive_with_sympy(name, n, queue):
    import sympy as sp
    from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

    start = time.perf_counter()
    q = dynamicsymbols(f"q1:{n + 1}")
    kinetic, potential = IN_SYMPY[name](sp, q, dynamicsymbols._t)
    method = LagrangesMethod(kinetic - potential, q)
    method.form_lagranges_equations()
    assignments, reduced = sp.cse([method.mass_matrix, method.forcing])
    operations = sum(sp.count_ops(expression) for _, expression in assignments)
    operations += sum(sp.count_ops(entry) for matrix in reduced for entry in matrix)
    queue.put((time.perf_counter() - start, operations + factorization(n)))


def sympy(name, n):
    """Return time and number of operations for SymPy, which derives M and f. The operations include a numeric factorization of a full M."""
    queue = multiprocessing.Queue()
    process = multiprocessing.Process(target=derive_with_sympy, args=(name, n, queue))
    process.start()
    process.join(LIMIT)
    if process.is_alive():
        process.kill()
        return None, None
    return queue.get()


def compare_derivation(name, counts, argument=True):
    """Print a row for each N; the exponent p is that of time ~ N^p between two rows."""
    print(f"\n{name}\n\n| N | lagc, time | exponent | lagc, operations | SymPy, time | ratio | SymPy, operations |\n|{' ---: |' * 7}")
    before, slow, theirs = None, False, (None, None)
    for n in counts:
        ours = lagc(name, n if argument else None)
        theirs = (None, None) if slow else sympy(name, n)
        slow = theirs[0] is None
        grows = before is not None and before[1] is not None and ours[0] is not None
        exponent = f"{math.log(ours[0] / before[1]) / math.log(n / before[0]):.1f}" if grows else ""
        before = n, ours[0]
        print(f"| {n} | {in_seconds(ours[0])} | {exponent} | {ours[1] or ''} | {in_seconds(theirs[0])} "
              f"| {ratio(ours[0], theirs[0])} | {theirs[1] or ''} |", flush=True)  # fmt: skip
        if ours[0] is None:
            break


def own_name(name, n, method=""):
    return f"{name}{n or ''}{method}"


def prepare_build(cases):
    """Prepare a build folder with these systems, named NAMEn or NAMEnMETHOD, and build the targets that they share."""
    for name, n, *method in cases:
        own = own_name(name, n, *method)
        folder = BUILD / "systems" / own
        folder.mkdir(parents=True, exist_ok=True)
        text = source(name).read_text().replace(f'system name="{name}"', f'system name="{own}"')
        if n:
            text = re.sub(r'(name="N" value=)"\d+"', rf'\1"{n}"', text)
        if method:
            text = re.sub(r'<solver method="\w+"', f'<solver method="{method[0]}"', text)
        (folder / "system.xml").write_text(text)
    subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, f"-DSYSTEMS={BUILD / 'systems'}", "--log-level=ERROR"],
                   check=True, stdout=subprocess.DEVNULL)  # fmt: skip
    shared = [word for target in ("lagc", "core", "fmi2", "solvers", "list_global_names") for word in ("--target", target)]
    subprocess.run(["cmake", "--build", BUILD, "--parallel", "2", *shared], check=True, stdout=subprocess.DEVNULL)


def build_fmu(name):
    """Return the time from system.xml to the archive in s; None beyond LIMIT."""
    (BUILD / "systems" / name / "system.xml").touch()
    for path in (BUILD / "fmu" / f"{name}.fmu", BUILD / "systems" / name / "system.c"):
        path.unlink(missing_ok=True)
    return seconds_of(["cmake", "--build", BUILD, "--target", f"fmu_{name}"])


def compare_whole_fmus():
    print("\nWhole FMUs, with the C compiler and packing\n\n| system | time | lagc alone | archive |\n| --- | ---: | ---: | ---: |")
    for name, n in WHOLE:
        own = own_name(name, n)
        taken, alone = build_fmu(own), lagc(name, n, 1)[0]
        size = "" if taken is None else f"{(BUILD / 'fmu' / f'{own}.fmu').stat().st_size / 1000:.0f} kB"
        print(f"| {own} | {in_seconds(taken)} | {in_seconds(alone)} | {size} |", flush=True)


def robot(name, axes):
    """Return the URDF of a robot with joints about these axes, in chains of seven from its base, with full inertia tensors."""
    at = random.Random(1).uniform
    parts, parent = [f'<robot name="{name}"><link name="base"/>'], "base"
    for i, axis in enumerate(axes):
        parent = "base" if i % 7 == 0 else f"link{i - 1}"
        a, b, c = at(0.01, 0.02), at(0.01, 0.02), at(0.01, 0.02)
        inertia = " ".join(f'{entry}="{value}"' for entry, value in zip(
            ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (b + c, a + c, a + b, *(at(-1e-3, 1e-3) for _ in range(3)))))  # fmt: skip
        parts += [
            f'<link name="link{i}"><inertial><origin xyz="{at(0, 0.1)} {at(0, 0.1)} 0.1"/><mass value="{at(1, 4)}"/><inertia {inertia}/></inertial></link>',
            f'<joint name="joint{i}" type="revolute"><parent link="{parent}"/><child link="link{i}"/><limit effort="1" velocity="1"/>',
            f'<origin xyz="{at(0, 0.1)} {at(0, 0.1)} 0.3" rpy="{at(-1, 1)} 0 0"/><axis xyz="{axis}"/></joint>']  # fmt: skip
    return "\n".join([*parts, "</robot>"])


def code_of(folder):
    """Yield the name and the system.c of mechanisms and robots; lagc writes each into a folder of its name."""
    robots = {"arm of 7 joints": 7, "humanoid of 30 joints": 30}
    inputs = {name: source(name) for name in ("StewartPlatform", "Arm7", "Bricard", "AndrewsSqueezer")}
    for name, joints in robots.items():
        inputs[name] = folder / f"{joints}.urdf"
        inputs[name].write_text(robot(f"Robot{joints}", [("0 0 1", "0 1 0", "1 0 0")[i % 3] for i in range(joints)]))
    for name, file in inputs.items():
        subprocess.run([ROOT / "build/bin/lagc", file, "-o", folder / name], check=True, capture_output=True)
        yield name, folder / name / "system.c"


def compare_compilers():
    """Print the times of compiling FMUs as one file, as the package, other platforms and rebuilt sources do."""
    print(f"\nThe C of an FMU in one file, -O2\n\n| system | C | gcc | clang |{'|'.join(f' zig, {name} ' for name in PLATFORMS)}|\n| --- |" + " ---: |" * (3 + len(PLATFORMS)))
    runtime = ROOT / "src" / "runtime"
    layer = [word for file in sorted((runtime / "fmi2").glob("*.c")) for word in ("-include", file)]
    words = ["-std=c11", "-O2", "-fPIC", "-ffp-contract=off", "-DFMU_IN_ONE_FILE", f"-I{ROOT / 'include'}", f"-I{runtime}"]
    with tempfile.TemporaryDirectory() as scratch:
        for name, system in code_of(Path(scratch)):
            here = [seconds_of([compiler, *words, "-include", system, *layer[:-2], "-c", layer[-1], "-o", system.with_suffix(".o")]) for compiler in ("gcc", "clang")]
            zig = [seconds_of([sys.executable, ROOT / "scripts/package/cross.py", "fmu", platform, system, scratch, "robot"]) for platform in PLATFORMS]
            print(f"| {name} | {system.stat().st_size / 1000:.0f} kB | {' | '.join(map(in_seconds, [*here, *zig]))} |", flush=True)


def stiff_run(n, method, end=1.0, tolerance=1e-6):
    """Return the time of making the FMU in s or None, and its run or None."""
    taken = build_fmu(own_name("StiffLattice", n, method))
    return taken, step("cost", own_name("StiffLattice", n, method), {}, end, tolerance, 1, 3, 1, LIMIT) if taken is not None else None


def compare_stiff_steps():
    """Print steps and times of each method; the exponent is that of a step's time. A method that reaches LIMIT gets no larger systems."""
    print("\nStiffLattice: 1 s at tolerance 1e-6\n\n| N | method | FMU | steps | a step | exponent | in all |\n| ---: | --- |" + " ---: |" * 5)
    before, slow = {}, set()
    for n in STIFF:
        for method in (m for m in STIFF_METHODS if m not in slow):
            taken, run = stiff_run(n, method)
            if run is None:
                slow.add(method)
                print(f"| {n} | {method} | {in_seconds(taken)} | | {'' if taken is None else in_seconds(None)} | | |", flush=True)
                continue
            microseconds = 1e6 * run.seconds / run.steps
            exponent = f"{math.log(microseconds / before[method][1]) / math.log(n / before[method][0]):.1f}" if method in before else ""
            before[method] = n, microseconds
            print(f"| {n} | {method} | {in_seconds(taken)} | {run.steps} | {microseconds:.0f} us | {exponent} | {in_seconds(run.seconds)} |", flush=True)


def main():
    compare_derivation("ChainPendulum", CHAINS)
    compare_derivation("Lattice", LATTICES)
    compare_derivation("Arm7", [7], argument=False)
    prepare_build([*WHOLE, *(("StiffLattice", n, method) for n in STIFF for method in STIFF_METHODS)])
    compare_whole_fmus()
    compare_compilers()
    compare_stiff_steps()


if __name__ == "__main__":
    main()
