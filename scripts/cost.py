"""Time of derivation and operations of the right side for ChainPendulum: lagc beside SymPy's LagrangesMethod with cse."""

import multiprocessing
import re
import subprocess
import tempfile
import time
from pathlib import Path

SYMPY_LIMIT = 60  # seconds
COUNTS = (1, 2, 4, 8, 16, 32)


def factorization(n):
    """Operations of factoring M = L D L^T and solving for n unknowns; a division for one."""
    return 1 if n == 1 else n * (n * n - 1) // 3 + n * (n - 1) + 2 * n * (n - 1) + n


def lagc(n):
    """(seconds, operations): the best of five runs, writing of all files included."""
    times = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(5):
            start = time.perf_counter()
            subprocess.run(
                ["build/bin/lagc", "fmu/ChainPendulum/system.xml", "-o", folder, "-D", f"N={n}"], check=True
            )
            times.append(time.perf_counter() - start)
        code = (Path(folder) / "system.c").read_text()
    return min(times), int(re.search(r"d state / dt; (\d+) operations", code).group(1))


def derive_with_sympy(n, queue):
    import sympy as sp
    from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

    start = time.perf_counter()
    m, l, g, t = *sp.symbols("m l g"), dynamicsymbols._t
    q = dynamicsymbols(f"q1:{n + 1}")
    kinetic = potential = x = y = sp.Integer(0)
    for angle in q:
        x, y = x + l * sp.sin(angle), y - l * sp.cos(angle)
        kinetic += m * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2
        potential += m * g * y
    method = LagrangesMethod(kinetic - potential, q)
    method.form_lagranges_equations()
    assignments, reduced = sp.cse([method.mass_matrix, method.forcing])
    operations = sum(sp.count_ops(expression) for _, expression in assignments)
    operations += sum(sp.count_ops(entry) for matrix in reduced for entry in matrix)
    queue.put((time.perf_counter() - start, operations + factorization(n)))


def sympy(n):
    """The same for SymPy, or None where it takes longer than the limit. M and f by SymPy, M factored numerically."""
    queue = multiprocessing.Queue()
    process = multiprocessing.Process(target=derive_with_sympy, args=(n, queue))
    process.start()
    process.join(SYMPY_LIMIT)
    if process.is_alive():
        process.kill()
        return None
    return queue.get()


def main():
    print("| N | lagc, time | lagc, operations | SymPy, time | SymPy, operations |")
    print("| ---: | ---: | ---: | ---: | ---: |")
    slow = False
    for n in COUNTS:
        ours, theirs = lagc(n), None if slow else sympy(n)
        slow = theirs is None
        other = ("> 60 s", "") if slow else (f"{theirs[0]:.2g} s", theirs[1])
        print(f"| {n} | {ours[0]:.3f} s | {ours[1]} | {other[0]} | {other[1]} |", flush=True)


if __name__ == "__main__":
    main()
