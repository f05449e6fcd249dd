"""Solve the problems by Boost.Odeint in a compiled C++ program, with accelerations that SymPy solves for and numeric parameters."""

import functools
import shutil
import subprocess
from pathlib import Path

import numpy as np
import sympy

from fmu import ROOT
from numerics.space.accelerations import prefix
from numerics.work_precision.scenarios import SCENARIOS, states_of, values_of
from systems_in_sympy import system

FOLDER = ROOT / "build" / "report" / "odeint"
FLAGS = ["-O3", "-march=native", "-std=c++17"]
BUDGET = 0.5  # s in which a run is repeated; the fastest counts

PROGRAM = """#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <boost/numeric/odeint.hpp>

using namespace std;
using State = array<double, {count}>;

static void right_side(const State &x, State &rate, double time) {{
  (void)time;
{statements}
}}

int main(int, char **words) {{
  namespace odeint = boost::numeric::odeint;
  const double tolerance = atof(words[1]), budget = atof(words[2]);
  const auto now = [] {{ return chrono::duration<double>(chrono::steady_clock::now().time_since_epoch()).count(); }};
  double best = 1e300;
  State x{{}};
  for (const double begin = now(); best == 1e300 || now() - begin < budget;) {{
    x = {{{start}}};
    const double start = now();
    odeint::integrate_adaptive(odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(tolerance, tolerance), right_side, x, 0.0, {end!r}, {first!r});
    best = min(best, now() - start);
  }}
  printf("%.17g\\n", best);
  for (const double value : x) printf("%.17g\\n", value);
}}
"""


def statements(name):
    """Return C++ statements for the rates of the states, with common subexpressions."""
    definition, values = system(name), values_of(name)
    fixed = {symbol: values[symbol.name] for symbol in [*definition.inputs, *definition.parameters]}
    accelerations = definition.mass.LUsolve(sympy.Matrix([sum(terms) for terms in definition.terms]))
    states = {symbol: sympy.Symbol(f"x[{i}]") for i, symbol in enumerate([*definition.q, *definition.v])}
    rates = [expression.subs(fixed).subs(states) for expression in [*definition.v, *map(sympy.simplify, accelerations)]]
    shared, rates = sympy.cse(rates)
    lines = [f"  const double {symbol} = {sympy.cxxcode(value)};" for symbol, value in shared]
    return "\n".join([*lines, *(f"  rate[{i}] = {sympy.cxxcode(rate)};" for i, rate in enumerate(rates))])


@functools.cache
def program(name):
    """Compile the program of a problem, with the headers of Boost in Pinocchio's package; return its path."""
    if shutil.which("g++") is None:
        raise FileNotFoundError("g++")
    FOLDER.mkdir(parents=True, exist_ok=True)
    source, values, states = FOLDER / f"{name}.cpp", values_of(name), states_of(name)
    end = SCENARIOS[name][1]
    source.write_text(PROGRAM.format(count=len(states), statements=statements(name), start=", ".join(repr(float(values[s])) for s in states), end=end, first=end / 1000))
    subprocess.run(["g++", *FLAGS, f"-I{Path(prefix()) / 'include'}", source, "-o", source.with_suffix("")], check=True, capture_output=True)
    return source.with_suffix("")


def odeint(name, tolerance):
    """Solve a problem by the explicit Runge-Kutta pair of orders 7 and 8 by Fehlberg; return the states at the end only."""
    result = subprocess.run([program(name), str(tolerance), str(BUDGET)], check=True, capture_output=True, text=True, timeout=60)
    seconds, *state = map(float, result.stdout.split())
    return seconds, np.array([state])
