"""Small faults, each with the cheapest test that sees it: (file, what stands there once, what is planted, the test)."""

PENDULUM = "SimplePendulum and not Linear"
LINEAR = "SimplePendulumLinear"


def ctest(name):
    """A unit test of tests/compiler."""
    return "ctest", name


def pytest(module, keyword, *systems):
    """Tests in Python that need the compiler and the FMUs of these systems."""
    return "pytest", module, keyword, *systems


FAULTS = [
    # runtime
    ("src/runtime/snapshot.c", "instance->prepared_is_stale = instance->solver_is_stale = true;", "instance->solver_is_stale = true;",
     pytest("test_state", f"restored_parameters and {PENDULUM}")),
    ("src/runtime/values.c", "if (variable->kind == VARIABLE_PARAMETER) instance->prepared_is_stale = true;", "",
     pytest("test_state", f"restored_parameters and {PENDULUM}")),
    ("src/runtime/values.c", "  *target = value;\n  instance->situation->changed = 1;", "  *target = value;",
     pytest("test_state", f"parameter_counts and {PENDULUM}")),
    ("src/runtime/values.c", "value < variable->minimum || value > variable->maximum", "value > variable->maximum",
     pytest("test_bad_values", "test_values_outside_their_range")),
    ("src/runtime/steps.c", "fabs(time - situation->time) > rounding", "fabs(time - situation->time) > 0.5 * size",
     pytest("test_fmi_rules", "steps_end_where_they_say and DampedPendulum")),
    ("src/runtime/steps.c", "if (time + size <= time)", "if (time + size < time)", pytest("test_fmi_rules", "too_short_for_the_time and DampedPendulum")),
    ("src/runtime/steps.c", "situation->last_step = (struct Span){step->start, step->start};", "situation->last_step.end = step->start;",
     pytest("test_fmi_rules", f"on_the_closed_form and {PENDULUM}")),
    ("src/runtime/log.c", "  instance->situation->mode = MODE_ERROR;\n", "", pytest("test_life_cycle", "")),
    ("src/runtime/fmi2/fmi2_life_cycle.c", "[FUNCTION_TERMINATE] = {FOR_BOTH, EXCHANGE | STEPS}", "[FUNCTION_TERMINATE] = {FOR_BOTH, ALL}",
     pytest("test_life_cycle", "")),
    # solvers
    ("src/runtime/solvers/exact.c", " && memcmp(exact->parameter, instance->parameter, bytes) == 0", "",
     pytest("test_state", f"restored_parameters and {LINEAR}")),
    ("src/runtime/solvers/exact.c", "(identity[i] + identity[j]) * sum[i * n + j]", "identity[i] * sum[i * n + j]",
     pytest("test_state", f"restored_parameters and {LINEAR}")),
    ("src/runtime/solvers/taylor.c", "taylor->x[i][0] = instance->state[i];", "taylor->x[i][0] += 0.0;",
     pytest("test_fmi_rules", f"on_the_closed_form and {PENDULUM}")),
    ("src/runtime/solvers/taylor.c", "  taylor->saved->reach = 0.0;\n  taylor->is_measured = false;", "  taylor->is_measured = false;",
     pytest("test_state", f"parameter_counts and {PENDULUM}")),
    # compiler
    ("src/compiler/mechanics/linearize.c", "change_of(expansion, slopes.values[i], 0.5)", "change_of(expansion, slopes.values[i], 1.0)",
     pytest("test_derivation", f"energies and {LINEAR}")),
    ("src/compiler/algebra/units.c", '{"Pa", {[KILOGRAM] = 1, [METRE] = -1, [SECOND] = -2}}', '{"Pa", {[KILOGRAM] = 1, [METRE] = 1, [SECOND] = -2}}',
     ctest("test_units")),
    ("src/compiler/algebra/units.c", "fabs(first.exponent[i] - second.exponent[i]) > 1e-9", "fabs(first.exponent[i] - second.exponent[i]) > 1.5",
     pytest("test_bad_systems", "test_errors or unit")),
    ("src/compiler/algebra/simplify.c", "bool is_even = fmod(exponent, 2.0) == 0.0;", "bool is_even = true;", ctest("test_simplify")),
]
