#include "program/metadata/metadata.h"

#include <math.h>

#include "algebra/cone.h"
#include "base/memory.h"
#include "interface/symbol_names.h"

static double value_or(double value, double otherwise) {
  return isnan(value) ? otherwise : value;
}

static const struct ScalarVariable *variables_of(const struct Interface *interface) {
  struct ScalarVariable *variables = allocate(interface->count, sizeof *variables);
  for (size_t i = 0; i < interface->count; i++) {
    variables[i] = interface->variables[i].entry;
    variables[i].start = value_or(variables[i].start, 0.0);
    variables[i].minimum = value_or(variables[i].minimum, -INFINITY);
    variables[i].maximum = value_or(variables[i].maximum, INFINITY);
  }
  return variables;
}

static void add_arrays(struct Lagrangian *metadata, const struct Interface *interface) {
  struct ArrayVariable *arrays = allocate(interface->count, sizeof *arrays);
  for (size_t i = 0; i < interface->count; i++)
    if (interface->variables[i].array_count > 0)
      arrays[metadata->array_count++] = (struct ArrayVariable){i, interface->variables[i].array_count};
  if (metadata->array_count > 0) metadata->arrays = arrays;
}

static void add_following(struct Lagrangian *metadata, const struct Interface *interface) {
  size_t *following = allocate(interface->count, sizeof *following);
  for (size_t i = 0; i < interface->count; i++)
    if (has_following_start(&interface->variables[i].entry)) following[metadata->following_count++] = i;
  if (metadata->following_count > 0) metadata->following = following;
}

static const bool *uses_of_acceleration(const struct Program *program, size_t count) {
  bool *uses = allocate(count, sizeof *uses);
  for (size_t i = 0; i < count; i++)
    uses[i] = graph_depends_on(program->model->graph, program->expressions->result[i], ACCELERATION);
  return uses;
}

static const double *nominals_of(const struct Interface *interface) {
  double *nominal = allocate(interface->state_count, sizeof *nominal);
  for (size_t i = 0; i < interface->count; i++)
    if (interface->variables[i].entry.kind == VARIABLE_STATE)
      nominal[interface->variables[i].entry.index] = value_or(interface->variables[i].nominal, 1.0);
  return nominal;
}

static const int *whole_numbers(const size_t *sizes, size_t count) {
  int *numbers = allocate(count, sizeof *numbers);
  for (size_t i = 0; i < count; i++) numbers[i] = (int)sizes[i];
  return numbers;
}

static struct LuPattern lu_pattern_of(const struct Elimination *factors, size_t rows) {
  int *slot = allocate(rows, sizeof *slot);
  for (size_t i = 0; i < rows; i++) slot[factors->order[i]] = (int)i;
  return (struct LuPattern){slot, whole_numbers(factors->start, rows + 1),
                            whole_numbers(factors->column, factors->start[rows])};
}

static struct ImplicitTable implicit_metadata_of(const struct Program *program) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  struct ImplicitTable metadata = {0};
  if (jacobian == NULL) return metadata;
  metadata.pattern =
      (struct Sparsity){jacobian->count, whole_numbers(jacobian->start, program->interface->state_count + 1),
                        whole_numbers(jacobian->row, jacobian->count)};
  if (program->lu != NULL && jacobian->factors != NULL)
    metadata.lu_pattern = lu_pattern_of(jacobian->factors, program->equations->count + program->equations->rates.count);
  return metadata;
}

static struct StepMetadata step_metadata_of(const struct Program *program) {
  const struct Model *model = program->model;
  return (struct StepMetadata){.nominal = nominals_of(program->interface),
                               .tolerance = interface_tolerance(model),
                               .max_step = value_or(model->solver.max_step, INFINITY),
                               .max_steps = interface_max_steps(model),
                               .work = program->work,
                               .operations = program->operations,
                               .depends_on_time = program->interface->depends_on_time};
}

/* Names a block's dependences. The pivot of a row depends on the rows eliminated up to it. */
static void name_block(const struct Graph *graph, const struct InertiaBlock *block, size_t coordinates,
                       const char **texts) {
  struct SymbolNames names = {0};
  for (size_t i = 0; i < block->count && block->tree == NULL; i++) {
    if (block->coordinates[i] >= coordinates) continue;
    symbol_names_add(&names, graph, block->mass + block->start[i], block->start[i + 1] - block->start[i]);
    texts[block->coordinates[i]] = symbol_names_text(&names, graph);
  }
}

/* Names dependences in kinematic trees. The articulated inertia of a link depends on the links outward of it. */
static void name_pivots_of_trees(const struct Graph *graph, const struct Inertia *inertia, const char **texts) {
  const struct Pivot **pivots = allocate(inertia->pivot_count, sizeof(struct Pivot *));
  Node *values = allocate(inertia->pivot_count, sizeof *values);
  size_t count = 0;
  for (size_t i = 0; i < inertia->pivot_count; i++) {
    if (inertia_block_of(inertia, inertia->pivots[i].coordinate)->tree == NULL) continue;
    values[count] = inertia->pivots[i].value;
    pivots[count++] = &inertia->pivots[i];
  }
  struct SymbolNames *names = allocate(count, sizeof *names);
  symbol_names_add_each(names, graph, values, count);
  for (size_t i = 0; i < count; i++) texts[pivots[i]->coordinate] = symbol_names_text(&names[i], graph);
}

/* Returns inertia_depends_on of struct Lagrangian; NULL without coordinates. */
static const char *const *inertia_names_of(const struct Program *program) {
  const struct Inertia *inertia = program->equations->inertia;
  size_t n = program->equations->count;
  if (n == 0) return NULL;
  const char **texts = allocate(n, sizeof *texts);
  for (size_t b = 0; b < inertia->block_count; b++) name_block(program->model->graph, &inertia->blocks[b], n, texts);
  name_pivots_of_trees(program->model->graph, inertia, texts);
  return texts;
}

/*
 * Marks the inputs that the constraint contains, directly or by their derivatives. Returns their names, NULL for none.
 */
static char *mark_inputs(const struct Model *model, Node constraint, bool *is_prescribed_input) {
  const struct Graph *graph = model->graph;
  struct Cone *cone = graph->cone;
  char *names = NULL;
  cone_collect(cone, graph, &constraint, 1);
  for (size_t i = 0; i < model->inputs.count; i++) {
    if (!cone_has(cone, model->inputs.items[i].node)) continue;
    size_t input = i;
    while (is_input_rate(model, input)) input--;
    is_prescribed_input[input] = true;
    char *before = names;
    names =
        format_text("%s%s%s", before != NULL ? before : "", before != NULL ? ", " : "", model->inputs.items[i].name);
  }
  return names;
}

static bool has_inputs(const struct Model *model) {
  bool has = false;
  for (size_t j = 0; j < model->constraints.count; j++)
    has |= graph_depends_on(model->graph, model->constraints.items[j].node, INPUT);
  return has;
}

static void add_inputs(struct ConstraintTable *metadata, const struct Model *model) {
  bool *is_prescribed_input = allocate(model->inputs.count, sizeof *is_prescribed_input);
  const char **inputs = allocate(model->constraints.count, sizeof *inputs);
  struct PrescribedInput *prescribed_inputs = allocate(model->inputs.count, sizeof *prescribed_inputs);
  for (size_t j = 0; j < model->constraints.count; j++)
    inputs[j] = mark_inputs(model, model->constraints.items[j].node, is_prescribed_input);
  for (size_t i = 0; i < model->inputs.count; i++)
    if (is_prescribed_input[i])
      prescribed_inputs[metadata->prescribed_input_count++] = (struct PrescribedInput){i, input_rate_count(model, i)};
  metadata->inputs = inputs;
  metadata->prescribed_inputs = prescribed_inputs;
}

static const bool *fixed_coordinates(const struct VariableList *coordinates) {
  bool *is_fixed = allocate(coordinates->count, sizeof *is_fixed);
  for (size_t i = 0; i < coordinates->count; i++) is_fixed[i] = coordinates->items[i].is_fixed;
  return is_fixed;
}

/* Returns the table without its functions; empty without constraints. */
static struct ConstraintTable constraint_metadata_of(const struct Program *program) {
  const struct Model *model = program->model;
  struct ConstraintTable metadata = {.count = model->constraints.count};
  if (metadata.count == 0) return metadata;
  const char **names = allocate(metadata.count, sizeof *names);
  for (size_t i = 0; i < metadata.count; i++) names[i] = model->constraints.items[i].name;
  metadata.names = names;
  if (has_inputs(model)) add_inputs(&metadata, model);
  if (has_function(program, FUNCTION_START_POSITIONS))
    metadata.coordinate_is_fixed = fixed_coordinates(&model->coordinates);
  return metadata;
}

struct Lagrangian metadata_of(const struct Program *program, size_t work_count) {
  const struct Interface *interface = program->interface;
  const struct SeriesProgram *series = program->series, *output_series = program->output_series;
  size_t scratch = program->is_table ? program->ir_functions[FUNCTION_PREPARE]->local_count : 0;
  struct Lagrangian metadata = {
      .name = program->model->name,
      .coordinate_count = program->equations->count,
      .state_count = interface->state_count,
      .input_count = program->model->inputs.count,
      .parameter_count = program->model->parameters.count + program->model->switches.mode_count,
      .parameter_constants_count = program->parameter_constants->count + scratch,
      .work_count = work_count,
      .sensitivity_count = program->model->sensitivity_count,
      .state_sensitivity_count = program->model->state_sensitivity_count,
      .variable_count = interface->count,
      .variables = variables_of(interface),
      .output_derivative_order = interface->output_derivative_order,
      .inertia_depends_on = inertia_names_of(program),
      .steps = step_metadata_of(program),
      .results = {.count = interface->result_count,
                  .uses_acceleration = uses_of_acceleration(program, interface->result_count)},
      .taylor = {.rows = series != NULL ? series->row_count : 0,
                 .output_rows = output_series != NULL ? output_series->row_count : 0},
      .implicit = implicit_metadata_of(program),
      .constraints = constraint_metadata_of(program)};
  add_arrays(&metadata, interface);
  add_following(&metadata, interface);
  return metadata;
}
