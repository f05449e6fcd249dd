#include "write/description.h"

#include "program/metadata/metadata.h"
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

static void write_variables(FILE *file, const struct Lagrangian *metadata) {
  fputs("static const struct ScalarVariable variables[] = {\n", file);
  for (size_t i = 0; i < metadata->variable_count; i++) write_variable(file, &metadata->variables[i]);
  fputs("};\n\n", file);
}

static void write_arrays(FILE *file, const struct Lagrangian *metadata) {
  if (metadata->array_count == 0) return;
  fputs("static const struct ArrayVariable arrays[] = {", file);
  for (size_t i = 0; i < metadata->array_count; i++)
    fprintf(file, "%s{%zu, %zu}", i > 0 ? ", " : "", metadata->arrays[i].first, metadata->arrays[i].count);
  fputs("};\n\n", file);
}

static void write_truths(FILE *file, const char *name, const bool *truths, size_t count) {
  fprintf(file, "static const bool %s[] = {", name);
  for (size_t i = 0; i < count; i++) fprintf(file, "%s%s", i > 0 ? ", " : "", name_of(truths[i]));
  fputs("};\n\n", file);
}

static void write_nominals(FILE *file, const struct Lagrangian *metadata) {
  if (metadata->state_count == 0) return;
  fputs("static const double nominal[] = {", file);
  for (size_t i = 0; i < metadata->state_count; i++) {
    if (i > 0) fputs(", ", file);
    write_c_number(file, metadata->steps.nominal[i]);
  }
  fputs("};\n\n", file);
}

static void write_patterns(FILE *file, const struct Lagrangian *metadata) {
  const struct Sparsity *pattern = &metadata->implicit.pattern;
  const struct LuPattern *lu = &metadata->implicit.lu_pattern;
  size_t n = metadata->state_count - metadata->coordinate_count;
  if (pattern->start == NULL) return;
  write_whole_numbers(file, "jacobian_start", pattern->start, metadata->state_count + 1);
  write_whole_numbers(file, "jacobian_row", pattern->row, pattern->count);
  if (lu->slot != NULL) {
    write_whole_numbers(file, "lu_slot", lu->slot, n);
    write_whole_numbers(file, "lu_start", lu->start, n + 1);
    write_whole_numbers(file, "lu_column", lu->column, (size_t)lu->start[n]);
  }
  fputs("\n", file);
}

static void write_prescribed_inputs(FILE *file, const struct ConstraintTable *metadata) {
  fputs("static const char *const constraint_inputs[] = {", file);
  for (size_t i = 0; i < metadata->count; i++) {
    write_text(file, metadata->inputs[i]);
    fputs(", ", file);
  }
  fputs("};\n\nstatic const struct PrescribedInput prescribed_inputs[] = {", file);
  for (size_t i = 0; i < metadata->prescribed_input_count; i++)
    fprintf(file, "{%zu, %zu}, ", metadata->prescribed_inputs[i].input, metadata->prescribed_inputs[i].rates);
  fputs("};\n\n", file);
}

static void write_constraint_names(FILE *file, const struct Lagrangian *system) {
  const struct ConstraintTable *metadata = &system->constraints;
  if (metadata->count == 0) return;
  if (metadata->coordinate_is_fixed != NULL)
    write_truths(file, "coordinate_is_fixed", metadata->coordinate_is_fixed, system->coordinate_count);
  if (metadata->inputs != NULL) write_prescribed_inputs(file, metadata);
  fputs("static const char *const constraint_names[] = {", file);
  for (size_t i = 0; i < metadata->count; i++) {
    if (i > 0) fputs(", ", file);
    write_c_string(file, metadata->names[i]);
  }
  fputs("};\n\n", file);
}

static void write_inertia_names(FILE *file, const struct Lagrangian *metadata) {
  if (metadata->coordinate_count == 0) return;
  fputs("static const char *const inertia_depends_on[] = {\n", file);
  for (size_t i = 0; i < metadata->coordinate_count; i++)
    fprintf(file, "    \"%s\",\n", metadata->inertia_depends_on[i]);
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

static void write_constraints(FILE *file, const struct Program *program, const struct ConstraintTable *metadata) {
  if (!has_function(program, FUNCTION_ACCELERATIONS)) return;
  fprintf(file,
          "    .constraints.count = %zu,\n    .constraints.names = constraint_names,\n"
          "    .constraints.projection = &projection,\n",
          metadata->count);
  if (metadata->inputs != NULL)
    fputs("    .constraints.inputs = constraint_inputs,\n    .constraints.prescribed_inputs = prescribed_inputs,\n"
          "    .constraints.prescribed_input_count = sizeof prescribed_inputs / sizeof *prescribed_inputs,\n",
          file);
  if (metadata->coordinate_is_fixed != NULL)
    fputs("    .constraints.coordinate_is_fixed = coordinate_is_fixed,\n", file);
}

static void write_counts(FILE *file, const struct Lagrangian *metadata) {
  fprintf(file, "    .coordinate_count = %zu,\n    .state_count = %zu,\n    .input_count = %zu,\n",
          metadata->coordinate_count, metadata->state_count, metadata->input_count);
  fprintf(file, "    .parameter_count = %zu,\n    .parameter_constants_count = %zu,\n    .variable_count = %zu,\n",
          metadata->parameter_count, metadata->parameter_constants_count, metadata->variable_count);
  fprintf(file, "    .work_count = %zu,\n", metadata->work_count);
  if (metadata->sensitivity_count > 0) fprintf(file, "    .sensitivity_count = %zu,\n", metadata->sensitivity_count);
  if (metadata->state_sensitivity_count > 0)
    fprintf(file, "    .state_sensitivity_count = %zu,\n", metadata->state_sensitivity_count);
}

static void write_tables(FILE *file, const struct Program *program, const struct Lagrangian *metadata) {
  if (metadata->results.count > 0)
    fprintf(file, "    .results.count = %zu,\n    .results.uses_acceleration = result_uses_acceleration,\n",
            metadata->results.count);
  if (program->series != NULL) fprintf(file, "    .taylor.rows = %zu,\n", metadata->taylor.rows);
  if (program->output_series != NULL) fprintf(file, "    .taylor.output_rows = %zu,\n", metadata->taylor.output_rows);
  if (metadata->implicit.pattern.start != NULL)
    fprintf(file, "    .implicit.pattern = {%zu, jacobian_start, jacobian_row},\n", metadata->implicit.pattern.count);
  if (program->lu != NULL) fprintf(file, "    .implicit.lu = &%s,\n", program->lu);
  if (metadata->implicit.lu_pattern.slot != NULL)
    fputs("    .implicit.lu_pattern = {lu_slot, lu_start, lu_column},\n", file);
  write_constraints(file, program, &metadata->constraints);
  if (program->equations->switching != NULL)
    fputs("    .switches = &switches,\n    .event_laws = &event_laws,\n", file);
  if (program->expressions->weighted_gradient != NULL) fputs("    .reverse_sweep = &reverse_sweep,\n", file);
  write_fields(file, program, IN_LAGRANGIAN, IN_CONSTRAINTS);
}

static void write_operations(FILE *file, const struct OperationCounts *counts) {
  fprintf(file, "    .steps.operations = {%.0f, %.0f, %.0f, %.0f, %.0f, %.0f},\n", counts->derivatives,
          counts->jacobian, counts->series, counts->recurrences, counts->factor, counts->solve);
}

static void write_steps(FILE *file, const struct StepMetadata *metadata) {
  fputs("    .steps.tolerance = ", file);
  write_c_number(file, metadata->tolerance);
  fputs(",\n    .steps.max_step = ", file);
  write_c_number(file, metadata->max_step);
  fprintf(file, ",\n    .steps.max_steps = %ld,\n    .steps.depends_on_time = %s,\n", metadata->max_steps,
          name_of(metadata->depends_on_time));
}

static void write_lagrangian(FILE *file, const struct Program *program, const struct Lagrangian *metadata) {
  const char *solver = program->solver, *lu = program->lu;
  if (solver != NULL) fprintf(file, "extern const struct Solver solver_%s;\n\n", solver);
  if (lu != NULL) fprintf(file, "extern const struct Lu %s;\n\n", lu);
  if (program->expressions->weighted_gradient != NULL)
    fputs("extern const struct ReverseSweep reverse_sweep;\n\n", file);
  fprintf(file, "const struct Lagrangian lagrangian = {\n    .name = \"%s\",\n    .guid = GUID,\n", metadata->name);
  write_counts(file, metadata);
  fputs("    .variables = variables,\n", file);
  if (metadata->array_count > 0)
    fputs("    .arrays = arrays,\n    .array_count = sizeof arrays / sizeof *arrays,\n", file);
  if (metadata->following_count > 0)
    fputs("    .following = following,\n    .following_count = sizeof following / sizeof *following,\n", file);
  if (solver != NULL)
    fprintf(file, "    .steps.nominal = nominal,\n%s    .solver = &solver_%s,\n",
            metadata->coordinate_count > 0 ? "    .inertia_depends_on = inertia_depends_on,\n" : "", solver);
  write_steps(file, &metadata->steps);
  fprintf(file, "    .output_derivative_order = %d,\n", metadata->output_derivative_order);
  write_tables(file, program, metadata);
  if (solver != NULL)
    fprintf(file, "    .steps.work = {%.0f, %.0f, %.0f},\n", metadata->steps.work.evaluation, metadata->steps.work.step,
            metadata->steps.work.event);
  if (program->equations->method != NULL && program->equations->method->series == ALL_TERMS)
    write_operations(file, &metadata->steps.operations);
  fputs("};\n", file);
}

void description_write(FILE *file, const struct Program *program, size_t work_count) {
  struct Lagrangian metadata = metadata_of(program, work_count);
  write_variables(file, &metadata);
  write_arrays(file, &metadata);
  if (metadata.following_count > 0)
    write_sizes(file, "size_t", "following", metadata.following, metadata.following_count);
  if (metadata.results.count > 0)
    write_truths(file, "result_uses_acceleration", metadata.results.uses_acceleration, metadata.results.count);
  write_inertia_names(file, &metadata);
  write_constraint_names(file, &metadata);
  write_nominals(file, &metadata);
  write_patterns(file, &metadata);
  write_lagrangian(file, program, &metadata);
}
