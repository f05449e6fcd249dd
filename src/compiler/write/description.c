#include "write/description.h"

#include "program/facts/facts.h"
#include "write/c_text.h"

static const char *name_of(bool truth) {
  return truth ? "true" : "false";
}

static void write_text(FILE *file, const char *text) {
  if (text != NULL) write_c_string(file, text);
  else fputs("NULL", file);
}

static void write_variable(FILE *file, const struct ScalarVariable *variable) {
  static const char *const kinds[] = {
      [VARIABLE_TIME] = "VARIABLE_TIME",
      [VARIABLE_STATE] = "VARIABLE_STATE",
      [VARIABLE_DERIVATIVE] = "VARIABLE_DERIVATIVE",
      [VARIABLE_INPUT] = "VARIABLE_INPUT",
      [VARIABLE_PARAMETER] = "VARIABLE_PARAMETER",
      [VARIABLE_MODE] = "VARIABLE_MODE",
      [VARIABLE_CONTACT] = "VARIABLE_CONTACT",
      [VARIABLE_RESULT] = "VARIABLE_RESULT",
      [VARIABLE_STATISTIC] = "VARIABLE_STATISTIC",
      [VARIABLE_INDICATOR] = "VARIABLE_INDICATOR",
  };
  static const char *const types[] = {
      [TYPE_REAL] = "TYPE_REAL", [TYPE_INTEGER] = "TYPE_INTEGER", [TYPE_BOOLEAN] = "TYPE_BOOLEAN"};
  fputs("    {", file);
  write_c_string(file, variable->name);
  fprintf(file, ", %s, %s, %zu, %s, %s, ", kinds[variable->kind], types[variable->type], variable->index,
          name_of(variable->is_output), name_of(variable->is_reinitialized));
  const double numbers[] = {variable->start, variable->minimum, variable->maximum};
  for (int i = 0; i < 3; i++) {
    write_c_number(file, numbers[i]);
    fputs(", ", file);
  }
  write_text(file, variable->follows_from);
  fputs("},\n", file);
}

static void write_variables(FILE *file, const struct Lagrangian *facts) {
  fputs("static const struct ScalarVariable variables[] = {\n", file);
  for (size_t i = 0; i < facts->variable_count; i++) write_variable(file, &facts->variables[i]);
  fputs("};\n\n", file);
}

static void write_arrays(FILE *file, const struct Lagrangian *facts) {
  if (facts->array_count == 0) return;
  fputs("static const struct ArrayVariable arrays[] = {", file);
  for (size_t i = 0; i < facts->array_count; i++)
    fprintf(file, "%s{%zu, %zu}", i > 0 ? ", " : "", facts->arrays[i].first, facts->arrays[i].count);
  fputs("};\n\n", file);
}

static void write_truths(FILE *file, const char *name, const bool *truths, size_t count) {
  fprintf(file, "static const bool %s[] = {", name);
  for (size_t i = 0; i < count; i++) fprintf(file, "%s%s", i > 0 ? ", " : "", name_of(truths[i]));
  fputs("};\n\n", file);
}

static void write_nominals(FILE *file, const struct Lagrangian *facts) {
  if (facts->state_count == 0) return;
  fputs("static const double nominal[] = {", file);
  for (size_t i = 0; i < facts->state_count; i++) {
    if (i > 0) fputs(", ", file);
    write_c_number(file, facts->steps.nominal[i]);
  }
  fputs("};\n\n", file);
}

static void write_patterns(FILE *file, const struct Lagrangian *facts) {
  const struct Sparsity *pattern = &facts->implicit.pattern;
  const struct LuPattern *lu = &facts->implicit.lu_pattern;
  size_t n = facts->state_count - facts->coordinate_count;
  if (pattern->start == NULL) return;
  write_whole_numbers(file, "jacobian_start", pattern->start, facts->state_count + 1);
  write_whole_numbers(file, "jacobian_row", pattern->row, pattern->count);
  if (lu->place != NULL) {
    write_whole_numbers(file, "lu_place", lu->place, n);
    write_whole_numbers(file, "lu_start", lu->start, n + 1);
    write_whole_numbers(file, "lu_column", lu->column, (size_t)lu->start[n]);
  }
  fputs("\n", file);
}

static void write_guides(FILE *file, const struct ConstraintTable *facts) {
  fputs("static const char *const constraint_inputs[] = {", file);
  for (size_t i = 0; i < facts->count; i++) {
    write_text(file, facts->inputs[i]);
    fputs(", ", file);
  }
  fputs("};\n\nstatic const struct Guide guides[] = {", file);
  for (size_t i = 0; i < facts->guide_count; i++)
    fprintf(file, "{%zu, %zu}, ", facts->guides[i].input, facts->guides[i].rates);
  fputs("};\n\n", file);
}

static void write_constraint_names(FILE *file, const struct Lagrangian *system) {
  const struct ConstraintTable *facts = &system->constraints;
  if (facts->count == 0) return;
  if (facts->coordinate_is_fixed != NULL)
    write_truths(file, "coordinate_is_fixed", facts->coordinate_is_fixed, system->coordinate_count);
  if (facts->inputs != NULL) write_guides(file, facts);
  fputs("static const char *const constraint_names[] = {", file);
  for (size_t i = 0; i < facts->count; i++) {
    if (i > 0) fputs(", ", file);
    write_c_string(file, facts->names[i]);
  }
  fputs("};\n\n", file);
}

static void write_inertia_names(FILE *file, const struct Lagrangian *facts) {
  if (facts->coordinate_count == 0) return;
  fputs("static const char *const inertia_depends_on[] = {\n", file);
  for (size_t i = 0; i < facts->coordinate_count; i++) fprintf(file, "    \"%s\",\n", facts->inertia_depends_on[i]);
  fputs("};\n\n", file);
}

void write_fields(FILE *file, const struct Program *program, enum FunctionGroup first, enum FunctionGroup last) {
  static const char *const groups[] = {
      [IN_LAGRANGIAN] = "",        [IN_RESULTS] = "results.",         [IN_TAYLOR] = "taylor.",
      [IN_IMPLICIT] = "implicit.", [IN_CONSTRAINTS] = "constraints.", [IN_SWITCHES] = ""};
  for (enum FunctionName i = 0; i < FIELD_COUNT; i++) {
    const struct GeneratedFunction *function = &generated_functions[i];
    if (function->group >= first && function->group <= last && has_function(program, i))
      fprintf(file, "    .%s%s = %s,\n", groups[function->group], function->name, function->name);
  }
}

static void write_constraints(FILE *file, const struct Program *program, const struct ConstraintTable *facts) {
  if (!has_function(program, FUNCTION_ACCELERATIONS)) return;
  fprintf(file,
          "    .constraints.count = %zu,\n    .constraints.names = constraint_names,\n"
          "    .constraints.projection = &projection,\n",
          facts->count);
  if (facts->inputs != NULL)
    fputs("    .constraints.inputs = constraint_inputs,\n    .constraints.guides = guides,\n"
          "    .constraints.guide_count = sizeof guides / sizeof *guides,\n",
          file);
  if (facts->coordinate_is_fixed != NULL) fputs("    .constraints.coordinate_is_fixed = coordinate_is_fixed,\n", file);
}

static void write_counts(FILE *file, const struct Lagrangian *facts) {
  fprintf(file, "    .coordinate_count = %zu,\n    .state_count = %zu,\n    .input_count = %zu,\n",
          facts->coordinate_count, facts->state_count, facts->input_count);
  fprintf(file, "    .parameter_count = %zu,\n    .prepared_count = %zu,\n    .variable_count = %zu,\n",
          facts->parameter_count, facts->prepared_count, facts->variable_count);
  fprintf(file, "    .work_count = %zu,\n", facts->work_count);
  if (facts->variation_count > 0) fprintf(file, "    .variation_count = %zu,\n", facts->variation_count);
  if (facts->state_variation_count > 0)
    fprintf(file, "    .state_variation_count = %zu,\n", facts->state_variation_count);
}

static void write_tables(FILE *file, const struct Program *program, const struct Lagrangian *facts) {
  if (facts->results.count > 0)
    fprintf(file, "    .results.count = %zu,\n    .results.uses_acceleration = result_uses_acceleration,\n",
            facts->results.count);
  if (program->series != NULL) fprintf(file, "    .taylor.rows = %zu,\n", facts->taylor.rows);
  if (program->output_series != NULL) fprintf(file, "    .taylor.output_rows = %zu,\n", facts->taylor.output_rows);
  if (facts->implicit.pattern.start != NULL)
    fprintf(file, "    .implicit.pattern = {%zu, jacobian_start, jacobian_row},\n", facts->implicit.pattern.count);
  if (program->lu != NULL) fprintf(file, "    .implicit.lu = &%s,\n", program->lu);
  if (facts->implicit.lu_pattern.place != NULL)
    fputs("    .implicit.lu_pattern = {lu_place, lu_start, lu_column},\n", file);
  write_constraints(file, program, &facts->constraints);
  if (program->equations->switching != NULL)
    fputs("    .switches = &switches,\n    .event_laws = &event_laws,\n", file);
  if (program->expressions->weighted_gradient != NULL) fputs("    .reverse_sweep = &reverse_sweep,\n", file);
  write_fields(file, program, IN_LAGRANGIAN, IN_CONSTRAINTS);
}

static void write_operations(FILE *file, const struct OperationCounts *counts) {
  fprintf(file, "    .steps.operations = {%.0f, %.0f, %.0f, %.0f, %.0f, %.0f},\n", counts->derivatives,
          counts->jacobian, counts->series, counts->recurrences, counts->factor, counts->solve);
}

static void write_steps(FILE *file, const struct StepFacts *facts) {
  fputs("    .steps.tolerance = ", file);
  write_c_number(file, facts->tolerance);
  fputs(",\n    .steps.max_step = ", file);
  write_c_number(file, facts->max_step);
  fprintf(file, ",\n    .steps.max_steps = %ld,\n    .steps.depends_on_time = %s,\n", facts->max_steps,
          name_of(facts->depends_on_time));
}

static void write_lagrangian(FILE *file, const struct Program *program, const struct Lagrangian *facts) {
  const char *solver = program->solver, *lu = program->lu;
  if (solver != NULL) fprintf(file, "extern const struct Solver solver_%s;\n\n", solver);
  if (lu != NULL) fprintf(file, "extern const struct Lu %s;\n\n", lu);
  if (program->expressions->weighted_gradient != NULL)
    fputs("extern const struct ReverseSweep reverse_sweep;\n\n", file);
  fprintf(file, "const struct Lagrangian lagrangian = {\n    .name = \"%s\",\n    .guid = GUID,\n", facts->name);
  write_counts(file, facts);
  fputs("    .variables = variables,\n", file);
  if (facts->array_count > 0)
    fputs("    .arrays = arrays,\n    .array_count = sizeof arrays / sizeof *arrays,\n", file);
  if (solver != NULL)
    fprintf(file, "    .steps.nominal = nominal,\n%s    .solver = &solver_%s,\n",
            facts->coordinate_count > 0 ? "    .inertia_depends_on = inertia_depends_on,\n" : "", solver);
  write_steps(file, &facts->steps);
  fprintf(file, "    .output_derivative_order = %d,\n", facts->output_derivative_order);
  write_tables(file, program, facts);
  if (solver != NULL)
    fprintf(file, "    .steps.work = {%.0f, %.0f, %.0f},\n", facts->steps.work.evaluation, facts->steps.work.step,
            facts->steps.work.event);
  if (program->equations->method != NULL && program->equations->method->series == ALL_TERMS)
    write_operations(file, &facts->steps.operations);
  fputs("};\n", file);
}

void description_write(FILE *file, const struct Program *program, size_t work_count) {
  struct Lagrangian facts = facts_of(program, work_count);
  write_variables(file, &facts);
  write_arrays(file, &facts);
  if (facts.results.count > 0)
    write_truths(file, "result_uses_acceleration", facts.results.uses_acceleration, facts.results.count);
  write_inertia_names(file, &facts);
  write_constraint_names(file, &facts);
  write_nominals(file, &facts);
  write_patterns(file, &facts);
  write_lagrangian(file, program, &facts);
}
