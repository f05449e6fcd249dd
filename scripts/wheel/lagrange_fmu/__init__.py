"""
Energies and forces of a mechanical system become an FMU.

    path = lagrange_fmu.build("pendulum.xml")
    motion = lagrange_fmu.simulate(path, {"theta": 1})

What goes wrong is a Problem, whose text names the thing and the remedy; what is a likely mistake in a system is a warning.
"""

from importlib.metadata import version

from .building import build, check, new
from .problem import Problem

__version__ = version("lagrange-fmu")
__all__ = ["Problem", "build", "check", "from_sympy", "new", "run", "simulate"]


def simulate(system, start_values=None, **options):
    """
    The motion of an FMU, or of a system, which is built first: time and all outputs as a structured NumPy array. Start values
    are of coordinates, velocities, inputs and parameters by name; options are those of fmpy.simulate_fmu, such as stop_time.
    """
    from .running import motion_of

    return motion_of(system, start_values, **options).outputs


def run(system, start_values=None, folder="."):
    """Simulates likewise, and leaves NAME.fmu, NAME.csv, NAME.png and NAME.html in the folder; the path of each by its kind."""
    from .running import run

    return run(system, start_values, folder)


def from_sympy(method, path, parameters, **options):
    """Writes the system of a LagrangesMethod of sympy.physics.mechanics: see lagrange_fmu.sympy_system.from_sympy."""
    from .sympy_system import from_sympy

    return from_sympy(method, path, parameters, **options)
