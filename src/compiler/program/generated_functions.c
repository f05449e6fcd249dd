#include "program/generated_functions.h"

#include "base/memory.h"
#include "program/builders.h"
#include "program/program.h"

static struct IrFunction *build_prepare(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  struct NodeList targets = {0};
  const struct Inertia *inertia = program->equations->inertia;
  append_nodes(&targets, generator->parameter_constants->nodes, generator->parameter_constants->count);
  for (size_t i = 0; i < inertia->pivot_count; i++) {
    const struct Pivot *pivot = &inertia->pivots[i];
    if (pivot_is_parameter_constants(generator->graph, pivot))
      append_nodes(&targets, (const Node[]){pivot->value, pivot->diagonal, pivot->scale}, 3);
  }
  generator_compute(generator, targets.nodes, targets.count, true);
  for (size_t i = 0; i < inertia->pivot_count; i++)
    if (pivot_is_parameter_constants(generator->graph, &inertia->pivots[i]))
      append_pivot_check(generator, &inertia->pivots[i]);
  for (size_t i = 0; i < generator->parameter_constants->count; i++)
    generator_copy(generator, target_slot(i), generator->parameter_constants->nodes[i]);
  return ir;
}

static struct IrFunction *build_derivatives(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  size_t n = program->equations->count;
  append_accelerations(generator, program->equations, &program->blocks, false);
  const struct NodeList *rates = &program->equations->rates;
  define_unknowns(generator, program->equations, &program->blocks, program->expressions->unknowns);
  generator_compute(generator, rates->nodes, rates->count, false);
  for (size_t i = 0; i < n; i++) ir_copy(generator->ir, target_slot(i), slot_at(SPACE_STATE, n + i));
  for (size_t i = 0; i < rates->count; i++) generator_copy(generator, target_slot(2 * n + i), rates->nodes[i]);
  return ir;
}

/* Appends the accelerations if some node depends on them; otherwise only the factors of the blocks. */
static void append_needed_accelerations(const struct Program *program, struct CodeGenerator *generator,
                                        const Node *nodes, size_t count) {
  bool needed = false;
  for (size_t i = 0; i < count && !needed; i++) needed = graph_depends_on(generator->graph, nodes[i], ACCELERATION);
  if (needed) append_accelerations(generator, program->equations, &program->blocks, true);
  else append_factors(generator, &program->blocks);
}

/* The location of each row of K in the blocks that are factored at run time. */
struct BlockRows {
  size_t *number;
  Slot *right_side;
  size_t *solved; /* of each block: 1 + the column of the Jacobian whose solution its right side holds; 0 for none */
};

static struct BlockRows block_rows_create(const struct LoopedBlocks *blocks, size_t count) {
  struct BlockRows rows = {allocate(count, sizeof(size_t)), allocate(count, sizeof(Slot)),
                           allocate(blocks->count, sizeof(size_t))};
  for (size_t b = 0; b < blocks->count; b++) {
    const struct LoopedBlock *looped = &blocks->items[b];
    for (size_t i = 0; i < looped->block->count; i++) {
      rows.number[looped->block->coordinates[i]] = b + 1;
      rows.right_side[looped->block->coordinates[i]] = slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i);
    }
  }
  return rows;
}

/*
 * Appends the directional derivatives of the first count accelerations and constraint forces along the seed, to the
 * targets from first on. further: nodes that are computed afterwards and may depend on accelerations.
 */
static void append_along(const struct Program *program, struct CodeGenerator *generator, size_t first, size_t count,
                         const Node *further, size_t further_count) {
  const struct Equations *equations = program->equations;
  const Node *along = program->expressions->along;
  size_t row_total = equations->explicit_form ? equations->count : row_count(equations);
  struct NodeList needed = {0};
  for (size_t i = 0; i < row_total; i++)
    if (i < count || (!equations->explicit_form && is_looped(equations, i))) append_node(&needed, along[i]);
  struct NodeList all = {0};
  append_nodes(&all, needed.nodes, needed.count);
  append_nodes(&all, further, further_count);
  append_needed_accelerations(program, generator, all.nodes, all.count);
  generator_compute(generator, needed.nodes, needed.count, false);
  struct BlockRows rows = block_rows_create(&program->blocks, row_total);
  for (size_t b = 0; b < program->blocks.count; b++) append_solution(generator, &program->blocks, b, along);
  for (size_t i = 0; i < count; i++)
    ir_copy(generator->ir, target_slot(first + i),
            rows.number[i] > 0 ? rows.right_side[i] : generator_slot(generator, along[i]));
}

static struct IrFunction *build_directional(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  const struct Expressions *expressions = program->expressions;
  size_t n = program->equations->count;
  size_t rates = program->equations->rates.count;
  append_along(program, generator, n, n, expressions->rates_along, rates);
  define_solutions(generator, &program->blocks, expressions->unknowns_along);
  generator_compute(generator, expressions->rates_along, rates, false);
  for (size_t i = 0; i < n; i++) ir_copy(generator->ir, target_slot(i), slot_at(SPACE_SEED_STATE, n + i));
  for (size_t i = 0; i < rates; i++) generator_copy(generator, target_slot(2 * n + i), expressions->rates_along[i]);
  return ir;
}

/* Solves for the multipliers of the blocks that are factored at run time; their symbols then name the solutions. */
static void append_multipliers(const struct Program *program, struct CodeGenerator *generator) {
  const struct WeightedGradient *gradient = program->expressions->weighted_gradient;
  for (size_t b = 0; b < program->blocks.count; b++) {
    const struct LoopedBlock *looped = &program->blocks.items[b];
    const struct InertiaBlock *block = looped->block;
    for (size_t i = 0; i < block->count; i++)
      generator_compute(generator, &gradient->right_side[block->coordinates[i]], 1, false);
    append_solution(generator, &program->blocks, b, gradient->right_side);
    for (size_t i = 0; i < block->count; i++)
      generator_define(generator, gradient->multiplier[block->coordinates[i]],
                       slot_at(SPACE_RIGHT_SIDE, looped->first_right_side + i));
  }
}

static struct IrFunction *build_weighted_gradient(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  const struct WeightedGradient *gradient = program->expressions->weighted_gradient;
  append_needed_accelerations(program, generator, gradient->elements, gradient->count);
  append_multipliers(program, generator);
  generator_compute(generator, gradient->elements, gradient->count, false);
  for (size_t i = 0; i < gradient->count; i++) generator_copy(generator, target_slot(i), gradient->elements[i]);
  return ir;
}

/*
 * Appends a column of the Jacobian: copies its right sides, solves each block once, and copies the solutions. A column
 * has right sides for all rows of a block or for none.
 */
static void append_jacobian_column(const struct Program *program, struct CodeGenerator *generator, size_t column,
                                   struct BlockRows *rows) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  size_t n = program->equations->count, first = jacobian->start[column], end = jacobian->start[column + 1];
  for (size_t e = first; e < end; e++) {
    size_t row = jacobian->row[e];
    bool in_block = row >= n && row < 2 * n && rows->number[row - n] > 0;
    generator_copy(generator, in_block ? rows->right_side[row - n] : target_slot(e), jacobian->value[e]);
  }
  for (size_t e = first; e < end; e++) {
    size_t row = jacobian->row[e], number = row >= n && row < 2 * n ? rows->number[row - n] : 0;
    if (number == 0) continue;
    if (rows->solved[number - 1] != column + 1) ir_append(generator->ir, SOLVE, (Slot)(number - 1), 0, 0, 0);
    rows->solved[number - 1] = column + 1;
    ir_copy(generator->ir, target_slot(e), rows->right_side[row - n]);
  }
}

/* Copies the right sides of the constraints in this column; *next runs through the list, which is sorted by columns. */
static void append_constraint_right_sides(const struct Program *program, struct CodeGenerator *generator, size_t column,
                                          const struct BlockRows *rows, size_t *next) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  for (; *next < jacobian->right_side_count && jacobian->right_sides[*next].column == column; (*next)++) {
    const struct ConstraintRightSide *right_side = &jacobian->right_sides[*next];
    generator_copy(generator, rows->right_side[program->equations->count + right_side->constraint], right_side->value);
  }
}

static struct IrFunction *build_jacobian(const struct Program *program, struct CodeGenerator *generator) {
  const struct JacobianExpressions *jacobian = program->expressions->jacobian;
  struct IrFunction *ir = generator_begin(generator);
  struct BlockRows rows = block_rows_create(&program->blocks, row_count(program->equations));
  struct NodeList targets = {0};
  size_t next_right_side = 0;
  append_nodes(&targets, jacobian->value, jacobian->count);
  for (size_t i = 0; i < jacobian->right_side_count; i++) append_node(&targets, jacobian->right_sides[i].value);
  append_needed_accelerations(program, generator, targets.nodes, targets.count);
  generator_compute(generator, targets.nodes, targets.count, false);
  for (size_t column = 0; column < program->interface->state_count; column++) {
    append_constraint_right_sides(program, generator, column, &rows, &next_right_side);
    append_jacobian_column(program, generator, column, &rows);
  }
  return ir;
}

/* Builds linear(): row i holds row i of A, row i of B, and c_i. */
static struct IrFunction *build_linear(const struct Program *program, struct CodeGenerator *generator) {
  const struct LinearSystem *linear = program->expressions->linear;
  struct IrFunction *ir = generator_begin(generator);
  size_t states = linear->states, inputs = linear->inputs, columns = states + inputs + 1;
  for (size_t i = 0; i < states; i++) {
    for (size_t j = 0; j < states; j++)
      generator_copy(generator, target_slot(i * columns + j), linear->a[i * states + j]);
    for (size_t j = 0; j < inputs; j++)
      generator_copy(generator, target_slot(i * columns + states + j), linear->b[i * inputs + j]);
    generator_copy(generator, target_slot(i * columns + states + inputs), linear->c[i]);
  }
  return ir;
}

/* Builds start values or their directional derivatives. Uses no parameter constants, as prepare() may fail. */
static struct IrFunction *build_starts(const struct Program *program, struct CodeGenerator *generator,
                                       const Node *nodes) {
  struct IrFunction *ir = generator_begin(generator);
  size_t count = program->expressions->initial.count;
  generator_compute(generator, nodes, count, true);
  for (size_t i = 0; i < count; i++) generator_copy(generator, target_slot(i), nodes[i]);
  return ir;
}

static struct IrFunction *build_initial_state(const struct Program *program, struct CodeGenerator *generator) {
  return build_starts(program, generator, program->expressions->initial.nodes);
}

static struct IrFunction *build_initial_state_along(const struct Program *program, struct CodeGenerator *generator) {
  return build_starts(program, generator, program->expressions->initial_along);
}

static struct IrFunction *build_accelerations(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  append_accelerations(generator, program->equations, &program->blocks, true);
  for (size_t i = 0; i < row_count(program->equations); i++)
    ir_copy(generator->ir, target_slot(i), slot_at(SPACE_ACCELERATION, i));
  return ir;
}

static struct IrFunction *build_accelerations_along(const struct Program *program, struct CodeGenerator *generator) {
  struct IrFunction *ir = generator_begin(generator);
  append_along(program, generator, 0, row_count(program->equations), NULL, 0);
  if (program->blocks.count > 0) append_least_forces_along(program, generator);
  return ir;
}

struct IrFunction *ir_of_targets(struct CodeGenerator *generator, const Node *nodes, size_t count) {
  struct IrFunction *ir = generator_begin(generator);
  generator_compute(generator, nodes, count, false);
  for (size_t i = 0; i < count; i++) generator_copy(generator, target_slot(i), nodes[i]);
  return ir;
}

/* Define functions: one builds the instruction list of nodes, the other is true if a program needs a function. */
#define TARGETS(function, nodes, count)                                                                                \
  static struct IrFunction *function(const struct Program *program, struct CodeGenerator *generator) {                 \
    return ir_of_targets(generator, nodes, count);                                                                     \
  }
#define NEEDED(function, condition)                                                                                    \
  static bool function(const struct Program *program) {                                                                \
    return condition;                                                                                                  \
  }
TARGETS(build_indicators, program->equations->switching->indicators, program->equations->switching->indicator_count)
TARGETS(build_rounding_bounds, program->equations->switching->rounding_bounds,
        program->equations->switching->indicator_count)
TARGETS(build_switching_values, program->equations->switching->values, program->equations->switching->value_count)
TARGETS(build_resting_sums, program->equations->switching->resting_sums,
        program->equations->switching->resting_sum_count)
TARGETS(build_ball_distances, program->equations->switching->ball_distances, program->model->switches.ball_count)
NEEDED(starts_follow, program->expressions->initial.count > 0)
NEEDED(moves, program->interface->state_count > 0)
NEEDED(has_weighted_gradient, program->expressions->weighted_gradient != NULL)
NEEDED(has_jacobian, program->expressions->jacobian != NULL && program->expressions->jacobian->value != NULL)
NEEDED(is_exact, program->expressions->linear != NULL)
NEEDED(is_constrained, program->equations->constraints->count > 0)
NEEDED(has_contacts, program->model->switches.contact_count > 0)
NEEDED(is_fixed_at_start, is_constrained(program) && has_fixed_coordinates(program->model))
NEEDED(switches, program->equations->switching != NULL)
NEEDED(has_series, program->series != NULL)
NEEDED(has_limit, program->series != NULL && program->series->limit.count > 0)
NEEDED(has_output_series, program->output_series != NULL)
NEEDED(has_resting_sums, switches(program) && program->equations->switching->resting_sum_count > 0)
NEEDED(has_balls, switches(program) && program->model->switches.ball_count > 0)
NEEDED(has_watched_limit, program->watched_series != NULL)
NEEDED(has_results, program->interface->result_count > 0)

const struct GeneratedFunction generated_functions[FUNCTION_COUNT] = {
    [FUNCTION_PREPARE] = {"Constants that depend on parameters alone", "prepare",
                          "const Real *p, Real *parameter_constants", "parameter_constants", RETURNS_STATUS,
                          IN_WORKSPACE, IN_LAGRANGIAN, NULL, build_prepare},
    [FUNCTION_INITIAL_STATE] = {"Start values that follow from parameters", "initial_state",
                                "const struct Point *point, Real *value", "value", RETURNS_NOTHING, IN_WORKSPACE,
                                IN_LAGRANGIAN, starts_follow, build_initial_state},
    [FUNCTION_INITIAL_STATE_ALONG] = {"Directional derivatives of these start values", "initial_state_along",
                                      "const struct Point *point, const struct Seed *seed, Real *value", "value",
                                      RETURNS_NOTHING, IN_WORKSPACE, IN_LAGRANGIAN, starts_follow,
                                      build_initial_state_along},
    [FUNCTION_DERIVATIVES] = {"d state / dt", "derivatives", "const struct Point *point, Real *derivative",
                              "derivative", RETURNS_STATUS, IN_TARGET, IN_LAGRANGIAN, moves, build_derivatives},
    [FUNCTION_DIRECTIONAL] = {"Directional derivative of d state / dt", "directional",
                              "const struct Point *point, const struct Seed *seed, Real *derivative", "derivative",
                              RETURNS_STATUS, IN_WORKSPACE, IN_LAGRANGIAN, moves, build_directional},
    [FUNCTION_WEIGHTED_GRADIENT] = {"Gradient of a weighted sum of the derivatives and outputs", "weighted_gradient",
                                    "const struct Point *point, const struct Seed *seed, Real *gradient", "gradient",
                                    RETURNS_STATUS, IN_WORKSPACE, IN_LAGRANGIAN, has_weighted_gradient,
                                    build_weighted_gradient},
    [FUNCTION_JACOBIAN] = {"Jacobian matrix", "jacobian", "const struct Point *point, Real *values", "values",
                           RETURNS_STATUS, IN_WORKSPACE, IN_IMPLICIT, has_jacobian, build_jacobian},
    [FUNCTION_LINEAR] = {"A, B and c of d state / dt = A state + B input + c", "linear",
                         "const Real *p, const Real *c, Real *matrix", "matrix", RETURNS_NOTHING, IN_WORKSPACE,
                         IN_LAGRANGIAN, is_exact, build_linear},
    [FUNCTION_ACCELERATIONS] = {"Accelerations and constraint forces", "accelerations",
                                "const struct Point *point, Real *acceleration", "acceleration", RETURNS_STATUS,
                                IN_WORKSPACE, IN_CONSTRAINTS, is_constrained, build_accelerations},
    [FUNCTION_ACCELERATIONS_ALONG] = {"Directional derivatives of these accelerations and forces",
                                      "accelerations_along",
                                      "const struct Point *point, const struct Seed *seed, Real *acceleration",
                                      "acceleration", RETURNS_STATUS, IN_WORKSPACE, IN_CONSTRAINTS, is_constrained,
                                      build_accelerations_along},
    [FUNCTION_CORRECT_POSITIONS] = {"Projection of the coordinates onto the constraints", "correct_positions",
                                    "const struct Point *point, const struct Seed *seed, Real *correction",
                                    "correction", RETURNS_STATUS, IN_WORKSPACE, IN_CONSTRAINTS, is_constrained,
                                    build_correct_positions},
    [FUNCTION_CORRECT_VELOCITIES] = {"Projection of the velocities onto the constraints", "correct_velocities",
                                     "const struct Point *point, Real *correction", "correction", RETURNS_STATUS,
                                     IN_WORKSPACE, IN_CONSTRAINTS, is_constrained, build_correct_velocities},
    [FUNCTION_RESPOND] = {"Response of the velocities to impulses of contacts and frictions", "respond",
                          "const struct Point *point, bool repeats, const Real *da, Real *response", "response",
                          RETURNS_STATUS, IN_WORKSPACE, IN_CONSTRAINTS, has_contacts, build_responses},
    [FUNCTION_START_POSITIONS] = {"Projection of start coordinates, some of which are fixed", "start_positions",
                                  "const struct Point *point, const struct Seed *seed, Real *correction", "correction",
                                  RETURNS_STATUS, IN_WORKSPACE, IN_CONSTRAINTS, is_fixed_at_start,
                                  build_start_positions},
    [FUNCTION_START_VELOCITIES] = {"Projection of start velocities, some of which are fixed", "start_velocities",
                                   "const struct Point *point, Real *correction", "correction", RETURNS_STATUS,
                                   IN_WORKSPACE, IN_CONSTRAINTS, is_fixed_at_start, build_start_velocities},
    [FUNCTION_INDICATORS] = {"Event indicators", "indicators",
                             "const struct Point *point, const Real *a, Real *indicator", "indicator", RETURNS_NOTHING,
                             IN_ARGUMENT, IN_SWITCHES, switches, build_indicators},
    [FUNCTION_ROUNDING_BOUNDS] = {"Rounding error bounds of the event indicators", "rounding_bounds",
                                  "const struct Point *point, const Real *a, Real *uncertainty", "uncertainty",
                                  RETURNS_NOTHING, IN_ARGUMENT, IN_SWITCHES, switches, build_rounding_bounds},
    [FUNCTION_SWITCHING_VALUES] = {"Values that determine the modes", "switching_values",
                                   "const struct Point *point, const Real *a, Real *value", "value", RETURNS_NOTHING,
                                   IN_ARGUMENT, IN_SWITCHES, switches, build_switching_values},
    [FUNCTION_RESTING_SUMS] = {"Sums of velocities that may rest", "resting_sums",
                               "const struct Point *point, const Real *a, Real *sum", "sum", RETURNS_NOTHING,
                               IN_ARGUMENT, IN_SWITCHES, has_resting_sums, build_resting_sums},
    [FUNCTION_BALL_DISTANCES] = {"Distances of balls from the shapes that they touch", "ball_distances",
                                 "const struct Point *point, const Real *a, Real *distance", "distance",
                                 RETURNS_NOTHING, IN_ARGUMENT, IN_SWITCHES, has_balls, build_ball_distances},
    [FUNCTION_START] = {"d state / dt, and the first coefficients of all series", "start",
                        "const struct Point *point, Real *derivative, Series *restrict w", "derivative", RETURNS_STATUS,
                        IN_TARGET, IN_TAYLOR, has_series, NULL},
    [FUNCTION_SERIES] =
        {"Taylor coefficients of the state up to an order", "series",
         "const struct Point *point, int order, const Series *restrict input, Series *restrict x, Series *restrict w",
         NULL, RETURNS_NOTHING, IN_WORKSPACE, IN_TAYLOR, has_series, NULL},
    [FUNCTION_LIMIT] =
        {"Limits a step to where the series are reliable", "limit",
         "const struct Point *point, const Series *restrict input, const Series *restrict x, const Series *restrict w, "
         "struct SeriesLimit *limit",
         NULL, RETURNS_NOTHING, IN_WORKSPACE, IN_TAYLOR, has_limit, NULL},
    [FUNCTION_OUTPUT_SERIES] = {"Taylor coefficients of the outputs up to an order", "output_series",
                                "const struct Point *point, int order, const Series *restrict input, const Series "
                                "*restrict x, Series *restrict w, Series *restrict y",
                                NULL, RETURNS_NOTHING, IN_WORKSPACE, IN_TAYLOR, has_output_series, NULL},
    [FUNCTION_WATCHED_LIMIT] =
        {"Limits a search interval to where the series of the event indicators are reliable", "watched_limit",
         "const struct Point *point, const Real *a, const Series *restrict input, const Series *restrict x, Series "
         "*restrict w, struct SeriesLimit *limit",
         NULL, RETURNS_NOTHING, IN_ARGUMENT, IN_SWITCHES, has_watched_limit, NULL},
    [FUNCTION_RESULT] = {"A computed variable", "result", "const struct Point *point, const Real *a", NULL,
                         RETURNS_VALUE, IN_ARGUMENT, IN_RESULTS, has_results, NULL},
    [FUNCTION_RESULTS] = {"Computed variables of one object", "results",
                          "const struct Point *point, const Real *a, Real *value", "value", RETURNS_NOTHING,
                          IN_ARGUMENT, IN_RESULTS, has_results, NULL},
    [FUNCTION_RESULT_ALONG] = {"Directional derivative of an output", "result_along",
                               "const struct Point *point, const struct Seed *seed, const Real *a, const Real *da",
                               NULL, RETURNS_VALUE, IN_ARGUMENT, IN_RESULTS, has_results, NULL},
};

bool has_function(const struct Program *program, enum FunctionName name) {
  const struct GeneratedFunction *function = &generated_functions[name];
  return function->is_needed == NULL || function->is_needed(program);
}
