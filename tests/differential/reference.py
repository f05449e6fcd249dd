"""Motions in long doubles: SymPy's equations as C, integrated by reference.c, twice with different orders and step limits."""

import ctypes
import functools
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import sympy as sp
from sympy.codegen.ast import float80, real
from sympy.printing.c import C99CodePrinter

from .system import course

REAL = ctypes.c_longdouble
INPUT_COEFFICIENTS = 4
STATES, GUARDS = 20, 400  # as in reference.c
EVALUATIONS = 4_000_000  # limit for one trajectory
OUTCOMES = ["", "the reference takes too many steps", "the motion leaves the domain of a function"]

PRELUDE = """
#include <math.h>
#define Sign(x) ((real)(((x) > 0) - ((x) < 0)))
#define Absolute(x) fabsl(x)
#define Less(a, b) ((real)((a) < (b)))
#define Minimum(a, b) fminl(a, b)
#define Maximum(a, b) fmaxl(a, b)
#define Raised(a, b) powl(a, b)
typedef long double real;

static void solve(int n, real m[], real x[]) {
  for (int k = 0; k < n; k++) {
    int pivot = k;
    for (int i = k + 1; i < n; i++)
      if (fabsl(m[i * n + k]) > fabsl(m[pivot * n + k])) pivot = i;
    for (int j = 0; j < n; j++) { real t = m[k * n + j]; m[k * n + j] = m[pivot * n + j]; m[pivot * n + j] = t; }
    real t = x[k]; x[k] = x[pivot]; x[pivot] = t;
    for (int i = k + 1; i < n; i++) {
      real factor = m[i * n + k] / m[k * n + k];
      for (int j = k; j < n; j++) m[i * n + j] -= factor * m[k * n + j];
      x[i] -= factor * x[k];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    for (int j = k + 1; j < n; j++) x[k] -= m[k * n + j] * x[j];
    x[k] /= m[k * n + k];
  }
}
"""  # fmt: skip

# Distance by an operand g over which a function bends; where exp and tanh are negligible, the distance back.
SCALES = {
    "exp": "g < -60 ? fmaxl(1, (-60 - g) / 2) : 1",
    "tanh": "fabsl(g) > 25 ? fmaxl(1, (fabsl(g) - 25) / 2) : 1",
    "atan": "fmaxl(1, fabsl(g) / 2)", "asinh": "fmaxl(1, fabsl(g) / 2)", "atan2": "fmaxl(0.1L, fabsl(g) / 2)",
    "asin": "fmaxl(1 - fabsl(g), 1e-4L)", "acos": "fmaxl(1 - fabsl(g), 1e-4L)", "atanh": "fmaxl(1 - fabsl(g), 1e-4L)",
    "acosh": "fmaxl(g - 1, 1e-4L)", "log": "fmaxl(fabsl(g), 1e-12L)", "sqrt": "fmaxl(fabsl(g), 1e-12L)",
    "abs": "fmaxl(fabsl(g), 1e-3L)", "sign": "fmaxl(fabsl(g), 1e-3L)", "min": "fmaxl(fabsl(g), 1e-3L)",
    "max": "fmaxl(fabsl(g), 1e-3L)", "/": "fmaxl(fabsl(g), 1e-12L)",
}  # fmt: skip


class Undecided(Exception):
    """The reference is not known accurately enough."""


def guards_of(derivation):
    """(operand in SymPy, C expression of its scale) for every function in the system."""
    guards = {}
    for tree in derivation.system.expressions():
        for node in tree.nodes():
            for operand, scale in guards_of_node(derivation, node):
                if sp.sympify(operand).free_symbols:
                    guards[operand, scale.replace("1e-3L", f"{derivation.system.switches.finest!r}L")] = None
    return list(guards)[:GUARDS]


def guards_of_node(derivation, node):
    operands = [derivation.convert(operand) for operand in node.operands]
    tables = {table.name: table for table in derivation.system.tables}
    if node.operation in tables and derivation.system.switches:
        return [(operands[0] - x, SCALES["min"]) for x in tables[node.operation].x]
    match node.operation:
        case "number" | "name" | "+" | "-" | "*" | "negative" | "der" | "if" | "and" | "or" | "not" | "integral":
            return []
        case "/":
            return [(operands[1], SCALES["/"])]
        case "^" | "pow":
            return guards_of_power(*operands)
        case "min" | "max" | "<" | ">":
            return [(operands[0] - operands[1], SCALES["min"])]
    return [(operand, SCALES.get(node.operation, "1")) for operand in operands]


def guards_of_power(base, exponent):
    exponent = sp.sympify(exponent)
    if exponent.is_Integer and exponent > 0:
        return [(base, f"fmaxl(fabsl(g), 0.3L) * {min(1.0, 4.0 / float(exponent))}L")]
    if exponent.is_number and exponent != 0:
        return [(base, f"fmaxl(fabsl(g), 1e-9L) * {min(1.0, 4.0 / abs(float(exponent)))}L")]
    return [(base, "fmaxl(fabsl(g), 1e-9L)"), (exponent, "1")]


@functools.cache
def integrator():
    folder = tempfile.mkdtemp(prefix="reference")
    library = Path(folder) / "reference.so"
    compile_c(Path(__file__).with_name("reference.c"), library, "-O2")
    return ctypes.CDLL(str(library))


def compile_c(source, library, optimization):
    words = ["gcc", optimization, "-std=gnu11", "-D_GNU_SOURCE", "-w", "-shared", "-fPIC", source, "-o", library, "-lm"]
    subprocess.run(list(map(str, words)), check=True)


def declarations(derivation):
    """Declarations of the names in an expression, from the time t, the state y and the constants k."""
    mechanics, system = derivation.mechanics, derivation.system
    lines = ["real time_ = t;"]
    for i, s in enumerate([*mechanics.q, *mechanics.v]):
        lines.append(f"real {s} = y[{i}];")
    for i, p in enumerate(system.parameters):
        lines.append(f"real {p} = k[{i}];")
    base = len(system.parameters)
    lines.append(f"real s = t - k[{base + INPUT_COEFFICIENTS * len(system.inputs)}];")
    for i, u in enumerate(system.inputs):
        k = [f"k[{base + INPUT_COEFFICIENTS * i + order}]" for order in range(INPUT_COEFFICIENTS)]
        lines.append(f"real {u} = {k[0]} + s * ({k[1]} + s * ({k[2]} + s * {k[3]}));")
    first_mode = base + INPUT_COEFFICIENTS * len(system.inputs) + 1
    return [*lines, *(f"real {mode} = k[{first_mode + i}];" for i, mode in enumerate(system.modes))]


def in_c(expressions):
    """Statements for common subexpressions, and the text of each expression."""
    printer = C99CodePrinter({"type_aliases": {real: float80}, "user_functions": {
        name: name for name in ("Sign", "Absolute", "Less", "Minimum", "Maximum", "Raised")}})  # fmt: skip
    parts, results = sp.cse([sp.sympify(e).subs(sp.Symbol("time"), sp.Symbol("time_")) for e in expressions],
                            symbols=sp.numbered_symbols("c"), optimizations=None)  # fmt: skip
    statements = [f"real {symbol} = {printer.doprint(part)};" for symbol, part in parts]
    return statements, [printer.doprint(result) for result in results]


def right_side_in_c(derivation):
    mechanics, guards = derivation.mechanics, guards_of(derivation)
    n, size = len(mechanics.q), len(mechanics.terms)
    system = derivation.system
    lines = [
        PRELUDE,
        "void right(real t, const real *y, const real *k, real *d, real *operand, real *scale) {",
        *declarations(derivation),
    ]
    power = (
        [derivation.prescribed_power + sum(force * v for force, v, c in zip(mechanics.Q, mechanics.v, system.coordinates) if c.rate is None)] if system.work else []
    )
    flat = [
        *mechanics.mass,
        *(sp.sympify(sum(terms)) for terms in mechanics.terms),
        *power,
        *(operand for operand, _ in guards),
    ]
    statements, texts = in_c(flat)
    lines += statements
    first = size * size + size
    lines.append(f"real m[] = {{{', '.join(texts[: size * size])}}}, x[] = {{{', '.join(texts[size * size : first])}}};")
    lines.append(f"solve({size}, m, x);")
    lines.append(f"for (int i = 0; i < {n}; i++) {{ d[i] = y[{n} + i]; d[{n} + i] = x[i]; }}")
    if system.work:
        lines.append(f"d[{2 * n}] = {texts[first]};")
    for i, (text, (_, scale)) in enumerate(zip(texts[first + len(power) :], guards)):
        lines.append(f"{{ real g = {text}; operand[{i}] = g; scale[{i}] = {scale}; }}")
    return "\n".join([*lines, "}", ""]), len(guards)


def samples_in_c(derivation):
    """A function that computes the values of all samples in turn."""
    statements, texts = in_c([derivation.convert(value) for sample in derivation.system.samples for value in sample.values.values()])
    lines = ["void sampled(real t, const real *y, const real *k, real *value) {", *declarations(derivation), *statements]
    return "\n".join([*lines, *(f"value[{i}] = {text};" for i, text in enumerate(texts)), "}", ""])


class Reference:
    """Motion of one system under its plan."""

    def __init__(self, derivation, folder):
        self.system = derivation.system
        code, self.guards = right_side_in_c(derivation)
        source = Path(folder) / "right.c"
        source.write_text(code + samples_in_c(derivation))
        compile_c(source, source.with_suffix(".so"), "-O1")
        compiled = ctypes.CDLL(str(source.with_suffix(".so")))
        self.right, self.sampled = compiled.right, compiled.sampled
        self.states = len(self.system.states)
        assert self.states <= STATES

    def trajectory(self, columns, tolerance, fraction, kick=None):
        """
        States at the communication points as doubles. kick(values) returns perturbations of the state, applied at the start and at at least
        twelve times of the run. Raises Undecided.
        """
        system, plan = self.system, self.system.plan
        modes = dict(system.modes)
        state = (REAL * self.states)(*system.start)
        step, evaluations = REAL(plan.length / 1000), ctypes.c_long(0)
        rows, parts = [system.start], max(1, 12 // len(plan.actions))
        kicked = max(1, len(plan.actions) // 100)  # one of this number of communication steps has kicks
        for number, communication in enumerate(course(system)):
            constants = self._constants(communication, modes)
            if number == 0:
                self._sample(communication.time, state, constants, modes)
            for moment, end in self._parts(communication, parts):
                if kick is not None and number % kicked == 0:
                    for j, change in enumerate(kick([float(x) for x in state])):
                        state[j] = float(state[j]) + change
                outcome = integrator().integrate(
                    self.right, self.states, self.guards, columns, ctypes.c_double(tolerance), ctypes.c_double(fraction),
                    ctypes.c_double(plan.length / 40), ctypes.c_double(moment), ctypes.c_double(end), state, constants,
                    ctypes.byref(step), ctypes.byref(evaluations), ctypes.c_long(EVALUATIONS),
                )  # fmt: skip
                if outcome != 0:
                    raise Undecided(OUTCOMES[outcome])
                self._sample(end, state, constants, modes)
            rows.append([float(x) for x in state])
        return np.array(rows)

    def _parts(self, communication, count):
        """Parts of a communication step, which end at samples. Those at its end up to rounding happen there."""
        begin, end = communication.time, communication.end
        times = {time for sample in self.system.samples for time in sample.times(end)}
        inner = {time for time in times if begin < time < end and not is_at(time, begin) and not is_at(time, end)}
        points = sorted({*divided(begin, end, count), *inner})
        return zip(points, points[1:])

    def _sample(self, time, state, constants, modes):
        """Set the modes of the samples at a time, all from the old values, also in the constants."""
        samples = self.system.samples
        values = (REAL * (1 + sum(len(sample.values) for sample in samples)))()
        self.sampled(REAL(time), state, constants, values)
        names = [(sample, mode) for sample in samples for mode in sample.values]
        for (sample, mode), value in zip(names, values):
            if any(is_at(time, one) for one in sample.times(time)):
                modes[mode] = value
        for i, value in enumerate(modes.values()):
            constants[len(constants) - len(modes) + i] = value

    @staticmethod
    def _constants(step, modes={}):
        values = list(step.parameters.values())
        for coefficients in step.inputs.values():
            values += [*coefficients, *[0.0] * (INPUT_COEFFICIENTS - len(coefficients))]
        values += [step.time, *modes.values()]
        return (REAL * len(values))(*values)


def divided(start, end, count):
    """Return the ends of equal parts of an interval."""
    return [start + (end - start) * i / count for i in range(count)] + [end]


def is_at(time, other):
    """Return True if two times are equal up to rounding."""
    return abs(time - other) <= 1e-13 * max(1.0, abs(time))
