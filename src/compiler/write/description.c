#include "write/description.h"

#include <math.h>

#include "base/memory.h"
#include "write/c_text.h"
#include "write/constraint_inputs.h"
#include "write/inertia_names.h"

static void write_variables(FILE *file, const struct Interface *interface) {
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
  fputs("static const struct ScalarVariable variables[] = {\n", file);
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    fputs("    {", file);
    write_c_string(file, entry->name);
    fprintf(file, ", %s, %s, %zu, %s, ", kinds[entry->kind], types[entry->type], entry->index,
            entry->is_output ? "true" : "false");
    write_c_number(file, isnan(entry->start) ? 0.0 : entry->start);
    fputs(", ", file);
    write_c_number(file, isnan(entry->minimum) ? -INFINITY : entry->minimum);
    fputs(", ", file);
    write_c_number(file, isnan(entry->maximum) ? INFINITY : entry->maximum);
    fputs(", ", file);
    if (entry->follows_from != NULL) write_c_string(file, entry->follows_from);
    else fputs("NULL", file);
    fputs("},\n", file);
  }
  fputs("};\n\n", file);
}

/* False where there are none. */
static bool write_arrays(FILE *file, const struct Interface *interface) {
  bool has_arrays = false;
  for (size_t i = 0; i < interface->count; i++) {
    if (interface->variables[i].array_count == 0) continue;
    fprintf(file, "%s{%zu, %zu}", has_arrays ? ", " : "static const struct ArrayVariable arrays[] = {", i,
            interface->variables[i].array_count);
    has_arrays = true;
  }
  if (has_arrays) fputs("};\n\n", file);
  return has_arrays;
}

static void write_results(FILE *file, const struct Program *program) {
  size_t count = program->interface->result_count;
  if (count == 0) return;
  fputs("static const bool result_uses_acceleration[] = {", file);
  for (size_t i = 0; i < count; i++)
    fprintf(file, "%s%s", i > 0 ? ", " : "",
            graph_depends_on(program->model->graph, program->expressions->result[i], ACCELERATION) ? "true" : "false");
  fputs("};\n\n", file);
}

static void write_nominals(FILE *file, const struct Interface *interface) {
  if (interface->state_count == 0) return;
  double *nominal = allocate(interface->state_count, sizeof *nominal);
  for (size_t i = 0; i < interface->count; i++)
    if (interface->variables[i].entry.kind == VARIABLE_STATE)
      nominal[interface->variables[i].entry.index] = interface->variables[i].nominal;
  fputs("static const double nominal[] = {", file);
  for (size_t i = 0; i < interface->state_count; i++) {
    if (i > 0) fputs(", ", file);
    write_c_number(file, isnan(nominal[i]) ? 1.0 : nominal[i]);
  }
  fputs("};\n\n", file);
}

static void write_lu_pattern(FILE *file, const struct Elimination *factors, size_t coordinates) {
  size_t *place = allocate(coordinates, sizeof *place);
  for (size_t i = 0; i < coordinates; i++) place[factors->order[i]] = i;
  write_sizes(file, "int", "lu_place", place, coordinates);
  write_sizes(file, "int", "lu_start", factors->start, coordinates + 1);
  write_sizes(file, "int", "lu_column", factors->column, factors->start[coordinates]);
}

static void write_pattern(FILE *file, const struct Program *program) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  if (jacobian == NULL) return;
  write_sizes(file, "int", "jacobian_start", jacobian->start, program->interface->state_count + 1);
  write_sizes(file, "int", "jacobian_row", jacobian->row, jacobian->count);
  if (jacobian->factors != NULL) write_lu_pattern(file, jacobian->factors, program->equations->count);
  fputs("\n", file);
}

static void write_fixed(FILE *file, const struct Program *program) {
  const struct VariableList *coordinates = &program->model->coordinates;
  fputs("static const bool coordinate_is_fixed[] = {", file);
  for (size_t i = 0; i < coordinates->count; i++)
    fprintf(file, "%s%s", i > 0 ? ", " : "", coordinates->items[i].is_fixed ? "true" : "false");
  fputs("};\n\n", file);
}

static void write_constraint_names(FILE *file, const struct Program *program) {
  const struct VariableList *constraints = &program->model->constraints;
  if (constraints->count == 0) return;
  if (has_function(program, FUNCTION_START_POSITIONS)) write_fixed(file, program);
  if (has_constraint_inputs(program->model)) constraint_inputs_write(file, program->model);
  fputs("static const char *const constraint_names[] = {", file);
  for (size_t i = 0; i < constraints->count; i++) {
    if (i > 0) fputs(", ", file);
    write_c_string(file, constraints->items[i].name);
  }
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

static void write_constraints(FILE *file, const struct Program *program) {
  if (!has_function(program, FUNCTION_ACCELERATIONS)) return;
  fprintf(file,
          "    .constraints.count = %zu,\n    .constraints.names = constraint_names,\n"
          "    .constraints.projection = &projection,\n",
          program->model->constraints.count);
  if (has_constraint_inputs(program->model))
    fputs("    .constraints.inputs = constraint_inputs,\n    .constraints.guides = guides,\n"
          "    .constraints.guide_count = sizeof guides / sizeof *guides,\n",
          file);
  if (has_function(program, FUNCTION_START_POSITIONS))
    fputs("    .constraints.coordinate_is_fixed = coordinate_is_fixed,\n", file);
}

static void write_counts(FILE *file, const struct Program *program, size_t work_count) {
  const struct Interface *interface = program->interface;
  size_t scratch = program->is_table ? program->routines[FUNCTION_PREPARE]->local_count : 0;
  fprintf(file, "    .coordinate_count = %zu,\n    .state_count = %zu,\n    .input_count = %zu,\n",
          program->equations->count, interface->state_count, program->model->inputs.count);
  fprintf(file, "    .parameter_count = %zu,\n    .prepared_count = %zu,\n    .variable_count = %zu,\n",
          program->model->parameters.count + program->model->switches.mode_count, program->prepared->count + scratch,
          interface->count);
  fprintf(file, "    .work_count = %zu,\n", work_count);
}

static void write_tables(FILE *file, const struct Program *program) {
  const struct SeriesProgram *series = program->series, *output_series = program->output_series;
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  const char *lu = program->lu;
  if (program->interface->result_count > 0)
    fprintf(file, "    .results.count = %zu,\n    .results.uses_acceleration = result_uses_acceleration,\n",
            program->interface->result_count);
  if (series != NULL) fprintf(file, "    .taylor.rows = %zu,\n", series->row_count);
  if (output_series != NULL) fprintf(file, "    .taylor.output_rows = %zu,\n", output_series->row_count);
  if (jacobian != NULL)
    fprintf(file, "    .implicit.pattern = {%zu, jacobian_start, jacobian_row},\n", jacobian->count);
  if (lu != NULL) fprintf(file, "    .implicit.lu = &%s,\n", lu);
  if (lu != NULL && jacobian->factors != NULL)
    fputs("    .implicit.lu_pattern = {lu_place, lu_start, lu_column},\n", file);
  write_constraints(file, program);
  if (program->equations->switching != NULL)
    fputs("    .switches = &switches,\n    .event_laws = &event_laws,\n", file);
  write_fields(file, program, IN_LAGRANGIAN, IN_CONSTRAINTS);
}

static void write_operations(FILE *file, const struct OperationCounts *counts) {
  fprintf(file, "    .steps.operations = {%.0f, %.0f, %.0f, %.0f, %.0f, %.0f},\n", counts->derivatives,
          counts->jacobian, counts->series, counts->recurrences, counts->factor, counts->solve);
}

static void write_lagrangian(FILE *file, const struct Program *program, size_t work_count, bool has_arrays) {
  const struct Interface *interface = program->interface;
  const char *solver = program->solver, *lu = program->lu;
  if (solver != NULL) fprintf(file, "extern const struct Solver solver_%s;\n\n", solver);
  if (lu != NULL) fprintf(file, "extern const struct Lu %s;\n\n", lu);
  fprintf(file, "const struct Lagrangian lagrangian = {\n    .name = \"%s\",\n    .guid = GUID,\n",
          program->model->name);
  write_counts(file, program, work_count);
  fputs("    .variables = variables,\n", file);
  if (has_arrays) fputs("    .arrays = arrays,\n    .array_count = sizeof arrays / sizeof *arrays,\n", file);
  if (solver != NULL)
    fprintf(file,
            "    .steps.nominal = nominal,\n    .inertia_depends_on = inertia_depends_on,\n    .solver = &solver_%s,\n",
            solver);
  fputs("    .steps.tolerance = ", file);
  write_c_number(file, interface_tolerance(program->model));
  fputs(",\n    .steps.max_step = ", file);
  write_c_number(file, isnan(program->model->solver.max_step) ? INFINITY : program->model->solver.max_step);
  fprintf(file,
          ",\n    .steps.max_steps = %ld,\n    .steps.depends_on_time = %s,\n    .output_derivative_order = %d,\n",
          interface_max_steps(program->model), interface->depends_on_time ? "true" : "false",
          interface->output_derivative_order);
  write_tables(file, program);
  if (solver != NULL)
    fprintf(file, "    .steps.work = {%.0f, %.0f, %.0f},\n", program->work.evaluation, program->work.step,
            program->work.event);
  if (program->equations->method != NULL && program->equations->method->hands_over)
    write_operations(file, &program->operations);
  fputs("};\n", file);
}

void description_write(FILE *file, const struct Program *program, size_t work_count) {
  write_variables(file, program->interface);
  bool has_arrays = write_arrays(file, program->interface);
  write_results(file, program);
  inertia_names_write(file, program);
  write_constraint_names(file, program);
  write_nominals(file, program->interface);
  write_pattern(file, program);
  write_lagrangian(file, program, work_count, has_arrays);
}
