#include "write/description.h"

#include "program/metadata/metadata.h"
#include "write/c_text.h"

const char *const variable_kind_names[] = {[VARIABLE_TIME] = "VARIABLE_TIME",
                                           [VARIABLE_STATE] = "VARIABLE_STATE",
                                           [VARIABLE_DERIVATIVE] = "VARIABLE_DERIVATIVE",
                                           [VARIABLE_INPUT] = "VARIABLE_INPUT",
                                           [VARIABLE_PARAMETER] = "VARIABLE_PARAMETER",
                                           [VARIABLE_MODE] = "VARIABLE_MODE",
                                           [VARIABLE_CONTACT] = "VARIABLE_CONTACT",
                                           [VARIABLE_RESULT] = "VARIABLE_RESULT",
                                           [VARIABLE_STATISTIC] = "VARIABLE_STATISTIC",
                                           [VARIABLE_INDICATOR] = "VARIABLE_INDICATOR"};
static const char *const types[] = {
    [TYPE_REAL] = "TYPE_REAL", [TYPE_INTEGER] = "TYPE_INTEGER", [TYPE_BOOLEAN] = "TYPE_BOOLEAN"};

static const struct ElementType variables = STRUCT_TYPE(
                                    ScalarVariable, FIELD(ScalarVariable, name),
                                    NAMED_FIELD(ScalarVariable, kind, variable_kind_names),
                                    NAMED_FIELD(ScalarVariable, type, types), FIELD(ScalarVariable, index),
                                    FIELD(ScalarVariable, is_output), FIELD(ScalarVariable, is_reinitialized),
                                    FIELD(ScalarVariable, start), FIELD(ScalarVariable, minimum),
                                    FIELD(ScalarVariable, maximum), FIELD(ScalarVariable, follows_from)),
                                arrays = STRUCT_TYPE(ArrayVariable, FIELD(ArrayVariable, first),
                                                     FIELD(ArrayVariable, count)),
                                prescribed_inputs = STRUCT_TYPE(PrescribedInput, FIELD(PrescribedInput, input),
                                                                FIELD(PrescribedInput, rates));

/* All fields but functions, patterns, the GUID and parts of the runtime. */
static const struct ElementType lagrangian_fields = STRUCT_TYPE(
    Lagrangian, FIELD(Lagrangian, name), FIELD(Lagrangian, coordinate_count), FIELD(Lagrangian, state_count),
    FIELD(Lagrangian, input_count), FIELD(Lagrangian, parameter_count), FIELD(Lagrangian, parameter_constants_count),
    FIELD(Lagrangian, work_count), FIELD(Lagrangian, sensitivity_count), FIELD(Lagrangian, state_sensitivity_count),
    FIELD(Lagrangian, variable_count), ARRAY_FIELD(Lagrangian, variables, variable_count, "variables", variables),
    FIELD(Lagrangian, array_count), ARRAY_FIELD(Lagrangian, arrays, array_count, "arrays", arrays),
    FIELD(Lagrangian, following_count), ARRAY_FIELD(Lagrangian, following, following_count, "following", size_elements),
    FIELD(Lagrangian, output_derivative_order),
    ARRAY_FIELD(Lagrangian, inertia_depends_on, coordinate_count, "inertia_depends_on", text_elements),
    ARRAY_FIELD(Lagrangian, steps.nominal, state_count, "nominal", number_elements), FIELD(Lagrangian, steps.tolerance),
    FIELD(Lagrangian, steps.max_step), FIELD(Lagrangian, steps.max_steps), FIELD(Lagrangian, steps.work.evaluation),
    FIELD(Lagrangian, steps.work.step), FIELD(Lagrangian, steps.work.event),
    FIELD(Lagrangian, steps.operations.derivatives), FIELD(Lagrangian, steps.operations.jacobian),
    FIELD(Lagrangian, steps.operations.series), FIELD(Lagrangian, steps.operations.recurrences),
    FIELD(Lagrangian, steps.operations.factor), FIELD(Lagrangian, steps.operations.solve),
    FIELD(Lagrangian, steps.depends_on_time), FIELD(Lagrangian, results.count),
    ARRAY_FIELD(Lagrangian, results.uses_acceleration, results.count, "result_uses_acceleration", truth_elements),
    FIELD(Lagrangian, taylor.rows), FIELD(Lagrangian, taylor.output_rows), FIELD(Lagrangian, constraints.count),
    ARRAY_FIELD(Lagrangian, constraints.names, constraints.count, "constraint_names", text_elements),
    ARRAY_FIELD(Lagrangian, constraints.inputs, constraints.count, "constraint_inputs", text_elements),
    FIELD(Lagrangian, constraints.prescribed_input_count),
    ARRAY_FIELD(Lagrangian, constraints.prescribed_inputs, constraints.prescribed_input_count, "prescribed_inputs",
                prescribed_inputs),
    ARRAY_FIELD(Lagrangian, constraints.coordinate_is_fixed, coordinate_count, "coordinate_is_fixed", truth_elements));

static void write_patterns(FILE *file, const struct Lagrangian *metadata) {
  const struct Sparsity *pattern = &metadata->implicit.pattern;
  const struct LuPattern *lu = &metadata->implicit.lu_pattern;
  size_t n = metadata->state_count - metadata->coordinate_count;
  if (pattern->start == NULL) return;
  write_array(file, "jacobian_start", &int_elements, pattern->start, metadata->state_count + 1);
  write_array(file, "jacobian_row", &int_elements, pattern->row, pattern->count);
  if (lu->slot != NULL) {
    write_array(file, "lu_slot", &int_elements, lu->slot, n);
    write_array(file, "lu_start", &int_elements, lu->start, n + 1);
    write_array(file, "lu_column", &int_elements, lu->column, (size_t)lu->start[n]);
  }
  fputs("\n", file);
}

void write_functions_of(FILE *file, const struct Program *program, enum FunctionGroup first, enum FunctionGroup last) {
  static const char *const groups[] = {
      [IN_LAGRANGIAN] = "",        [IN_RESULTS] = "results.",         [IN_TAYLOR] = "taylor.",
      [IN_IMPLICIT] = "implicit.", [IN_CONSTRAINTS] = "constraints.", [IN_SWITCHES] = ""};
  for (enum FunctionName i = 0; i < FIELD_COUNT; i++) {
    const struct GeneratedFunction *function = &generated_functions[i];
    if (function->group >= first && function->group <= last && has_function(program, i))
      fprintf(file, "    .%s%s = %s,\n", groups[function->group], function->name, function->name);
  }
}

static void write_parts(FILE *file, const struct Program *program, const struct ImplicitTable *implicit) {
  if (program->solver != NULL) fprintf(file, "    .solver = &solver_%s,\n", program->solver);
  if (implicit->pattern.start != NULL)
    fprintf(file, "    .implicit.pattern = {%zu, jacobian_start, jacobian_row},\n", implicit->pattern.count);
  if (program->lu != NULL) fprintf(file, "    .implicit.lu = &%s,\n", program->lu);
  if (implicit->lu_pattern.slot != NULL) fputs("    .implicit.lu_pattern = {lu_slot, lu_start, lu_column},\n", file);
  if (has_function(program, FUNCTION_ACCELERATIONS)) fputs("    .constraints.projection = &projection,\n", file);
  if (program->equations->switching != NULL)
    fputs("    .switches = &switches,\n    .event_laws = &event_laws,\n", file);
  if (has_function(program, FUNCTION_WEIGHTED_GRADIENT)) fputs("    .reverse_sweep = &reverse_sweep,\n", file);
}

void description_write(FILE *file, const struct Program *program, size_t work_count) {
  struct Lagrangian metadata = metadata_of(program, work_count);
  write_arrays(file, &lagrangian_fields, &metadata);
  write_patterns(file, &metadata);
  if (program->solver != NULL) fprintf(file, "extern const struct Solver solver_%s;\n\n", program->solver);
  if (program->lu != NULL) fprintf(file, "extern const struct Lu %s;\n\n", program->lu);
  if (has_function(program, FUNCTION_WEIGHTED_GRADIENT))
    fputs("extern const struct ReverseSweep reverse_sweep;\n\n", file);
  fputs("const struct Lagrangian lagrangian = {\n    .guid = GUID,\n", file);
  write_fields(file, &lagrangian_fields, &metadata);
  write_parts(file, program, &metadata.implicit);
  write_functions_of(file, program, IN_LAGRANGIAN, IN_CONSTRAINTS);
  fputs("};\n", file);
}
