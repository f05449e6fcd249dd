"""Comparisons of many runs at once (src/ensemble) with single runs of the FMU."""

import fmpy
import numpy as np
from fmpy import read_model_description

from fmu import ROOT, archive
from scripts.library.ensembles import Ensemble, lanes_here, source_of
from scripts.commands.sweep import compile_ensemble

HERE = lanes_here(ROOT / "build" / "libsweep_runs.so")  # lanes of this processor
NUMBERS = [lanes for lanes in (2, 4, 8) if lanes <= HERE]  # numbers of lanes that it supports


def ensemble(name, varied, recorded, times, lanes=HERE, tolerance=1e-10):
    reference = {v.name: v.valueReference for v in read_model_description(archive(name)).modelVariables}
    library = compile_ensemble(source_of(archive(name)), lanes)
    return Ensemble(library, [reference[v] for v in varied], [reference[v] for v in recorded], times, tolerance)


def states(name):
    return [unknown.variable.derivative.name for unknown in read_model_description(archive(name)).derivatives]


def starts(ranges, count, seed=1):
    generator = np.random.default_rng(seed)
    return np.array([generator.uniform(*span, count) for span in ranges.values()]).T


def alone(name, start_values, recorded, stop, steps=1, tolerance=1e-10):
    """Values of the variables `recorded` after each communication step, by the FMU."""
    result = fmpy.simulate_fmu(str(archive(name)), start_values=start_values, stop_time=stop, output_interval=stop / steps, output=recorded, relative_tolerance=tolerance)
    return [list(row)[1:] for row in result]


def assert_as_alone(name, ranges, stop, count, tolerance):
    """Check the states and energies of `count` runs at three times against those of the FMU in ten communication steps."""
    recorded = [*states(name), "kineticEnergy", "totalEnergy"]
    rows = starts(ranges, count)
    values, needs_fmu = ensemble(name, ranges, recorded, [0, 0.3 * stop, stop]).run(rows)
    assert not needs_fmu.any()
    for row, value in zip(rows, values):
        expected = alone(name, dict(zip(ranges, row)), recorded, stop, 10)
        for k, result in zip((0, 3, 10), value):
            np.testing.assert_allclose(result, expected[k], rtol=tolerance, atol=tolerance)


def assert_same_bits(name, ranges, stop):
    """Check that a run has the same bits whatever its lane, the number of lanes, and the other runs beside it."""
    rows, recorded = starts(ranges, 50), [*states(name), "totalEnergy"]
    values, _ = ensemble(name, ranges, recorded, [0, stop]).run(rows)
    for lanes in NUMBERS:
        one = ensemble(name, ranges, recorded, [0, stop], lanes)
        np.testing.assert_array_equal(one.run(rows)[0], values)
        order = np.random.default_rng(2).permutation(len(rows))[:37]
        np.testing.assert_array_equal(one.run(rows[order])[0], values[order])
        np.testing.assert_array_equal(one.run(rows[7:8])[0], values[7:8])
