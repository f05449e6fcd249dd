#include "program/program.h"

#include <stdlib.h>

#include "base/memory.h"
#include "program/corrections.h"
#include "program/least_forces.h"

/*
 * A C compiler takes more than proportionally long for long functions: for so many instructions a second or two, where a
 * table takes a fraction of one. The derivatives and the series of the motion may be as long by themselves: as statements,
 * they take a fifth and three quarters of the time.
 */
enum { STATEMENT_LIMIT = 6000, SERIES_STATEMENT_LIMIT = 8000, DERIVATIVES_STATEMENT_LIMIT = 20000 };

static Place target(size_t index) {
  return place_in(SPACE_TARGET, index);
}

static void copy_place(struct Values *values, Place to, Place from) {
  routine_append(values->routine, COPY, to, from, 0, 0);
}

static struct Routine *prepare_routine(struct Values *values, const struct Equations *equations) {
  struct Routine *routine = values_begin(values);
  struct NodeList targets = {0};
  const struct Inertia *inertia = equations->inertia;
  append_nodes(&targets, values->prepared->nodes, values->prepared->count);
  for (size_t i = 0; i < inertia->pivot_count; i++) {
    const struct Pivot *pivot = &inertia->pivots[i];
    if (pivot_is_prepared(values->graph, pivot))
      append_nodes(&targets, (const Node[]){pivot->value, pivot->diagonal, pivot->scale}, 3);
  }
  values_compute(values, targets.nodes, targets.count, true);
  for (size_t i = 0; i < inertia->pivot_count; i++)
    if (pivot_is_prepared(values->graph, &inertia->pivots[i])) append_pivot_check(values, &inertia->pivots[i]);
  for (size_t i = 0; i < values->prepared->count; i++) values_copy(values, target(i), values->prepared->nodes[i]);
  free(targets.nodes);
  return routine;
}

static struct Routine *derivatives_routine(const struct Program *program, struct Values *values) {
  struct Routine *routine = values_begin(values);
  size_t n = program->equations->count;
  append_accelerations(values, program->equations, &program->blocks, false);
  if (program->equations->has_work) values_compute(values, &program->equations->power, 1, false);
  for (size_t i = 0; i < n; i++) copy_place(values, target(i), place_in(SPACE_STATE, n + i));
  if (program->equations->has_work) values_copy(values, target(2 * n), program->equations->power);
  return routine;
}

/* Where differentiated equations hold accelerations, or blocks must be factored. */
static void append_needed_accelerations(const struct Program *program, struct Values *values, const Node *nodes,
                                        size_t count) {
  bool needed = false;
  for (size_t i = 0; i < count && !needed; i++) needed = graph_depends_on(values->graph, nodes[i], ACCELERATION);
  if (needed) append_accelerations(values, program->equations, &program->blocks, true);
  else append_factors(values, &program->blocks);
}

/* Where the rows of K stand in large blocks: 1 + the block's number, 0 for none, and the place of the right side. */
struct BlockRows {
  size_t *number;
  Place *side;
  size_t *solved; /* of each block: 1 + the column of the Jacobian that its right side holds the solution for */
};

static struct BlockRows block_rows_create(const struct LoopedBlocks *blocks, size_t count) {
  struct BlockRows rows = {allocate(count, sizeof(size_t)), allocate(count, sizeof(Place)),
                           allocate(blocks->count, sizeof(size_t))};
  for (size_t b = 0; b < blocks->count; b++) {
    const struct LoopedBlock *looped = &blocks->items[b];
    for (size_t i = 0; i < looped->block->count; i++) {
      rows.number[looped->block->coordinates[i]] = b + 1;
      rows.side[looped->block->coordinates[i]] = place_in(SPACE_SIDE, looped->first_side + i);
    }
  }
  return rows;
}

static void block_rows_free(struct BlockRows *rows) {
  free(rows->number);
  free(rows->side);
  free(rows->solved);
}

/*
 * The accelerations along the direction of the seed, and of the forces of constraints as many as count reaches, to the
 * targets from first on.
 */
static void append_along(const struct Program *program, struct Values *values, size_t first, size_t count) {
  const struct Equations *equations = program->equations;
  const Node *along = program->expressions->along;
  size_t row_total = equations->explicit_form ? equations->count : row_count(equations);
  append_needed_accelerations(program, values, along, row_total);
  values_compute(values, along, row_total, false);
  struct BlockRows rows = block_rows_create(&program->blocks, row_total);
  for (size_t b = 0; b < program->blocks.count; b++) {
    const struct InertiaBlock *block = program->blocks.items[b].block;
    Node *right_side = allocate(block->count, sizeof *right_side);
    for (size_t i = 0; i < block->count; i++) right_side[i] = along[block->coordinates[i]];
    append_solution(values, &program->blocks, b, right_side);
    free(right_side);
  }
  for (size_t i = 0; i < count; i++)
    copy_place(values, target(first + i), rows.number[i] > 0 ? rows.side[i] : values_place(values, along[i]));
  block_rows_free(&rows);
}

static struct Routine *directional_routine(const struct Program *program, struct Values *values) {
  struct Routine *routine = values_begin(values);
  const struct Expressions *expressions = program->expressions;
  size_t n = program->equations->count;
  append_along(program, values, n, n);
  if (expressions->equations->has_work) values_compute(values, &expressions->power_along, 1, false);
  for (size_t i = 0; i < n; i++) copy_place(values, target(i), place_in(SPACE_SEED_STATE, n + i));
  if (expressions->equations->has_work) values_copy(values, target(2 * n), expressions->power_along);
  return routine;
}

/* First the right sides of large blocks, of which a column has all rows or none; then their solutions. */
static void append_jacobian_column(const struct Program *program, struct Values *values, size_t column,
                                   struct BlockRows *rows) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  size_t n = program->equations->count, first = jacobian->start[column], end = jacobian->start[column + 1];
  for (size_t e = first; e < end; e++) {
    size_t row = jacobian->row[e];
    bool in_block = row >= n && row < 2 * n && rows->number[row - n] > 0;
    values_copy(values, in_block ? rows->side[row - n] : target(e), jacobian->value[e]);
  }
  for (size_t e = first; e < end; e++) {
    size_t row = jacobian->row[e], number = row >= n && row < 2 * n ? rows->number[row - n] : 0;
    if (number == 0) continue;
    if (rows->solved[number - 1] != column + 1) routine_append(values->routine, SOLVE, (Place)(number - 1), 0, 0, 0);
    rows->solved[number - 1] = column + 1;
    copy_place(values, target(e), rows->side[row - n]);
  }
}

/* The right sides of constraints stand by columns. */
static void append_constraint_sides(const struct Program *program, struct Values *values, size_t column,
                                    const struct BlockRows *rows, size_t *next) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  for (; *next < jacobian->side_count && jacobian->sides[*next].column == column; (*next)++) {
    const struct ConstraintSide *side = &jacobian->sides[*next];
    values_copy(values, rows->side[program->equations->count + side->constraint], side->value);
  }
}

static struct Routine *jacobian_routine(const struct Program *program, struct Values *values) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  struct Routine *routine = values_begin(values);
  struct BlockRows rows = block_rows_create(&program->blocks, row_count(program->equations));
  struct NodeList targets = {0};
  size_t next_side = 0;
  append_nodes(&targets, jacobian->value, jacobian->count);
  for (size_t i = 0; i < jacobian->side_count; i++) append_node(&targets, jacobian->sides[i].value);
  append_needed_accelerations(program, values, targets.nodes, targets.count);
  values_compute(values, targets.nodes, targets.count, false);
  free(targets.nodes);
  for (size_t column = 0; column < program->interface->state_count; column++) {
    append_constraint_sides(program, values, column, &rows, &next_side);
    append_jacobian_column(program, values, column, &rows);
  }
  block_rows_free(&rows);
  return routine;
}

/* Rows of A, B and c. */
static struct Routine *linear_routine(const struct LinearSystem *linear, struct Values *values) {
  struct Routine *routine = values_begin(values);
  size_t states = linear->states, inputs = linear->inputs, columns = states + inputs + 1;
  for (size_t i = 0; i < states; i++) {
    for (size_t j = 0; j < states; j++) values_copy(values, target(i * columns + j), linear->a[i * states + j]);
    for (size_t j = 0; j < inputs; j++)
      values_copy(values, target(i * columns + states + j), linear->b[i * inputs + j]);
    values_copy(values, target(i * columns + states + inputs), linear->c[i]);
  }
  return routine;
}

/* Of the start values that follow, or of their derivatives. Without prepared values, which may not exist. */
static struct Routine *initial_routine(const struct Program *program, struct Values *values, const Node *nodes) {
  const struct Interface *interface = program->interface;
  struct Routine *routine = values_begin(values);
  size_t count = 2 * program->equations->count;
  values_compute(values, nodes, count, true);
  for (size_t i = 0; i < count; i++)
    if (has_following_start(&interface->variables[interface_find(interface, VARIABLE_STATE, i)].entry))
      values_copy(values, target(i), nodes[i]);
  return routine;
}

static void create_initial(struct Program *program, struct Values *values) {
  const struct Expressions *expressions = program->expressions;
  bool any = false;
  for (size_t i = 0; i < 2 * program->equations->count; i++) any |= expressions->initial[i] != ZERO;
  if (!any) return;
  program->initial = initial_routine(program, values, expressions->initial);
  program->initial_along = initial_routine(program, values, expressions->initial_along);
}

static struct Routine *accelerations_routine(const struct Program *program, struct Values *values) {
  struct Routine *routine = values_begin(values);
  append_accelerations(values, program->equations, &program->blocks, true);
  for (size_t i = 0; i < row_count(program->equations); i++)
    copy_place(values, target(i), place_in(SPACE_ACCELERATION, i));
  return routine;
}

static struct Routine *accelerations_along_routine(const struct Program *program, struct Values *values) {
  struct Routine *routine = values_begin(values);
  append_along(program, values, 0, row_count(program->equations));
  if (program->blocks.count > 0) append_least_forces_along(program, values);
  return routine;
}

static struct Routine *result_routine(struct Values *values, const Node *nodes, size_t count) {
  struct Routine *routine = values_begin(values);
  values_compute(values, nodes, count, false);
  for (size_t i = 0; i < count; i++) values_copy(values, target(i), nodes[i]);
  return routine;
}

static void create_results(struct Program *program, struct Values *values) {
  const struct Interface *interface = program->interface;
  program->result = allocate(interface->result_count, sizeof(struct Routine *));
  program->result_along = allocate(interface->result_count, sizeof(struct Routine *));
  program->leader = allocate(interface->result_count, sizeof(size_t));
  for (size_t i = 0; i < interface->count; i++) {
    const struct ScalarVariable *entry = &interface->variables[i].entry;
    if (entry->kind != VARIABLE_RESULT) continue;
    size_t index = entry->index, count = 1;
    bool is_leader = !interface->variables[i].is_continued;
    program->leader[index] = is_leader ? index : program->leader[index - 1];
    while (i + count < interface->count && interface->variables[i + count].is_continued) count++;
    if (is_leader) program->result[index] = result_routine(values, &program->expressions->result[index], count);
    if (is_unknown(entry))
      program->result_along[index] = result_routine(values, &program->expressions->result_along[index], 1);
  }
}

static void create_switching(struct Program *program, struct Values *values) {
  const struct SwitchingExpressions *switching = program->interface->switching;
  if (switching == NULL) return;
  program->indicators = result_routine(values, switching->indicators, switching->indicator_count);
  program->switching_values = result_routine(values, switching->values, switching->value_count);
}

/* The methods of SUNDIALS need the series for its limits alone. */
static void create_series(struct Program *program, struct Values *values) {
  const struct Expressions *expressions = program->expressions;
  if (expressions->series != NULL) program->series = series_program_of_motion(expressions, &program->blocks, values);
  if (program->series != NULL && program->interface->method->series != ALL_TERMS && program->series->limit.count == 0) {
    series_program_free(program->series);
    program->series = NULL;
  }
  if (expressions->output_series != NULL) program->output_series = series_program_of_outputs(expressions, values);
  if (expressions->watched_series != NULL) program->watched_series = series_program_of_watched(expressions, values);
}

static size_t count_of(const struct Routine *routine) {
  return routine != NULL ? routine->count : 0;
}

size_t instruction_count(const struct Program *program) {
  size_t count = count_of(program->prepare) + count_of(program->derivatives) + count_of(program->directional) +
                 count_of(program->jacobian) + count_of(program->accelerations) +
                 count_of(program->accelerations_along) + count_of(program->correct_positions) +
                 count_of(program->correct_velocities) + count_of(program->responses) +
                 count_of(program->start_positions) + count_of(program->start_velocities) + count_of(program->initial) +
                 count_of(program->initial_along) + count_of(program->indicators) + count_of(program->switching_values);
  for (size_t i = 0; i < program->interface->result_count; i++)
    count += count_of(program->result[i]) + count_of(program->result_along[i]);
  const struct SeriesProgram *const series[] = {program->series, program->output_series, program->watched_series};
  for (int i = 0; i < 3; i++)
    if (series[i] != NULL) count += count_of(series[i]->start) + count_of(series[i]->order);
  return count;
}

static void choose_form(struct Program *program, enum CodeForm form) {
  const struct SeriesProgram *series = program->series;
  size_t length = series != NULL ? count_of(series->start) + count_of(series->order) : 0;
  program->is_table = form == TABLES || (form == BY_SIZE && instruction_count(program) > STATEMENT_LIMIT);
  program->series_is_table = form == TABLES || (program->is_table && length > SERIES_STATEMENT_LIMIT);
  program->derivatives_are_table =
      form == TABLES || (program->is_table && count_of(program->derivatives) > DERIVATIVES_STATEMENT_LIMIT);
}

struct Program *program_create(const struct Expressions *expressions, enum CodeForm form) {
  struct Program *program = allocate(1, sizeof *program);
  *program = (struct Program){.model = expressions->model,
                              .equations = expressions->equations,
                              .interface = expressions->interface,
                              .expressions = expressions};
  struct NodeList targets = expressions_targets(expressions);
  program->prepared = prepared_create(expressions->model->graph, targets);
  free(targets.nodes);
  program->blocks = looped_blocks_of(expressions->equations);
  struct Values *values = values_create(expressions->model->graph, program->prepared, expressions->equations->count);
  program->prepare = prepare_routine(values, expressions->equations);
  if (expressions->equations->count > 0) {
    program->derivatives = derivatives_routine(program, values);
    program->directional = directional_routine(program, values);
  }
  if (expressions->jacobian != NULL) program->jacobian = jacobian_routine(program, values);
  if (expressions->equations->constraints->count > 0) {
    program->accelerations = accelerations_routine(program, values);
    program->accelerations_along = accelerations_along_routine(program, values);
    program->correct_positions = correct_positions_routine(program, values, false);
    program->correct_velocities = correct_velocities_routine(program, values, false);
  }
  if (program->model->switches.contact_count > 0) program->responses = responses_routine(program, values);
  if (expressions->equations->constraints->count > 0 && has_fixed_coordinates(program->model)) {
    program->start_positions = correct_positions_routine(program, values, true);
    program->start_velocities = correct_velocities_routine(program, values, true);
  }
  if (expressions->linear != NULL) program->linear = linear_routine(expressions->linear, values);
  create_initial(program, values);
  create_results(program, values);
  create_switching(program, values);
  create_series(program, values);
  values_free(values);
  choose_form(program, form);
  return program;
}

void program_free(struct Program *program) {
  if (program == NULL) return;
  routine_free(program->prepare);
  routine_free(program->derivatives);
  routine_free(program->directional);
  routine_free(program->jacobian);
  routine_free(program->linear);
  routine_free(program->indicators);
  routine_free(program->switching_values);
  routine_free(program->initial);
  routine_free(program->initial_along);
  routine_free(program->accelerations);
  routine_free(program->accelerations_along);
  routine_free(program->correct_positions);
  routine_free(program->correct_velocities);
  routine_free(program->responses);
  routine_free(program->start_positions);
  routine_free(program->start_velocities);
  for (size_t i = 0; i < program->interface->result_count; i++) {
    routine_free(program->result[i]);
    routine_free(program->result_along[i]);
  }
  free(program->result);
  free(program->leader);
  free(program->result_along);
  series_program_free(program->series);
  series_program_free(program->output_series);
  series_program_free(program->watched_series);
  prepared_free(program->prepared);
  free(program->blocks.items);
  free(program);
}
