/*
 * The cost model counts additions, multiplications, divisions and roots as 1 and calls of elementary functions as 20.
 * Counts, unlike measured times, are the same on every machine, so that the runtime's choices are reproducible. An
 * order of a series costs its operations plus, for each recurrence, a number of terms that grows with the order.
 */
#include "program/costs.h"

#include <math.h>

#include "program/codegen/regions.h"

/* Returns the operations of an instruction list; 0 for NULL. */
static double operations_of(const struct IrFunction *ir) {
  /* an elementary function takes the time of about 20 additions */
  enum { OPERATIONS_OF_CALL = 20 };
  if (ir == NULL) return 0.0;
  double count = (double)ir->operation_count;
  for (size_t i = 0; i < ir->count; i++)
    if (ir->instructions[i].opcode == CALL || ir->instructions[i].opcode == CALL_OF_TWO)
      count += OPERATIONS_OF_CALL - 1;
  return count;
}

/*
 * Returns the share of a block's operations that take place. Hardly more constraints than coordinates hold at a time;
 * others are idle, as those of open contacts.
 */
static double active_share(const struct InertiaBlock *block) {
  double coordinates = (double)(block->count - block->constraint_count);
  return block->constraint_count > 0 ? fmin(1.0, coordinates / (double)block->constraint_count) : 1.0;
}

/* Returns the operations that take place. A table skips most of its regions, such as shapes that touch nothing. */
static double expected_operations(const struct Program *program, const struct IrFunction *ir, bool is_table) {
  const double skipped_share = 0.75;
  if (ir == NULL || ir->count == 0) return 0.0;
  double factors = 0.0, active = 0.0;
  for (size_t i = 0; i < ir->count; i++) {
    if (ir->instructions[i].opcode != FACTOR) continue;
    const struct InertiaBlock *block = program->blocks.items[ir->instructions[i].result].block;
    factors += (double)block_operations(block);
    active += active_share(block) * (double)block_operations(block);
  }
  double skipped = is_table ? skipped_share * (double)regions_length(ir) / (double)ir->count : 0.0;
  return (operations_of(ir) - factors) * (1.0 - skipped) + active;
}

/*
 * Returns the operations of a Jacobian, by elements or by directional derivatives with these operations; 0 without one.
 */
static double operations_of_jacobian(const struct Program *program, double direction) {
  if (program->expressions->jacobian == NULL || program->expressions->jacobian->value != NULL)
    return operations_of(program->ir_functions[FUNCTION_JACOBIAN]);
  return (double)program->interface->state_count * direction;
}

/*
 * Sums the elements of the rows of L, diagonals included, and the squares of these row lengths. The sums count the
 * multiplications of a triangular solution, and of a factorization.
 */
static void count_factors(const struct Program *program, double *elements, double *squares) {
  const struct Elimination *factors = program->expressions->jacobian->factors;
  *elements = *squares = 0.0;
  for (size_t i = 0; i < program->equations->count; i++) {
    double row = factors != NULL ? (double)(factors->start[i + 1] - factors->start[i]) : (double)i + 1.0;
    *elements += row;
    *squares += row * row;
  }
}

struct OperationCounts operation_counts_of(const struct Program *program) {
  double elements = 0.0, squares = 0.0;
  double direction = operations_of(program->ir_functions[FUNCTION_DIRECTIONAL]);
  if (program->expressions->jacobian != NULL) count_factors(program, &elements, &squares);
  return (struct OperationCounts){.derivatives = operations_of(program->ir_functions[FUNCTION_DERIVATIVES]),
                                  .jacobian = operations_of_jacobian(program, direction),
                                  .series = operations_of(program->series->order),
                                  .recurrences = (double)program->series->recurrences,
                                  .factor = squares,
                                  .solve = elements};
}

/* Typical at medium tolerances: order of series, stages of Radau IIA, evaluations for each Jacobian. */
enum { ORDER = 12, STAGES = 5, EVALUATIONS_PER_JACOBIAN = 100 };

/* Returns the work of one evaluation by a Runge-Kutta or implicit method, with its share of linear algebra. */
static double work_of_evaluation(const struct Program *program) {
  double work =
      250.0 + expected_operations(program, program->ir_functions[FUNCTION_DERIVATIVES], program->derivatives_are_table);
  if (program->expressions->jacobian == NULL) return work;
  double elements, squares, systems = 4.0 * STAGES - 2.0;
  count_factors(program, &elements, &squares);
  double direction =
      expected_operations(program, program->ir_functions[FUNCTION_DIRECTIONAL], program->directional_is_table);
  return work + 5.0 * STAGES * (double)program->interface->state_count + systems / STAGES * elements +
         (operations_of_jacobian(program, direction) + systems * squares) / EVALUATIONS_PER_JACOBIAN;
}

static double work_of_series(const struct Program *program) {
  double states = (double)program->interface->state_count, recurrences = (double)program->series->recurrences;
  double derivatives =
      expected_operations(program, program->ir_functions[FUNCTION_DERIVATIVES], program->derivatives_are_table);
  double order = expected_operations(program, program->series->order, program->series_is_table);
  return 380.0 + 4.0 * derivatives + ORDER * (0.5 * order + 1.5 * states + 0.45 * ORDER * recurrences);
}

/*
 * Estimates the work that counts against the limit of a communication step. A step costs, beyond its evaluation,
 * the rest of the series and CORRECTIONS Newton steps of the projection onto the constraints. The search for events
 * costs SEARCHES evaluations of the indicators, with LOOK more operations each. EVENT is the fixed part of an
 * event. The constants were fitted, like those of auto.c, to measured times of the systems in fmu/.
 */
struct StepWork step_work_of(const struct Program *program) {
  enum { CORRECTIONS = 10, SEARCHES = 40, LOOK = 100, EVENT = 20000 };
  bool has_series = program->equations->method->series == ALL_TERMS && program->series != NULL;
  double share = program->ir_functions[FUNCTION_CORRECT_VELOCITIES] != NULL ? 2.0 : 1.0;
  double evaluation = share * work_of_evaluation(program);
  double step =
      250.0 + CORRECTIONS * (expected_operations(program, program->ir_functions[FUNCTION_CORRECT_POSITIONS], false) +
                             expected_operations(program, program->ir_functions[FUNCTION_CORRECT_VELOCITIES], false));
  if (has_series) step += fmax(0.0, share * work_of_series(program) - evaluation);
  if (program->ir_functions[FUNCTION_INDICATORS] != NULL)
    step += SEARCHES * (LOOK + operations_of(program->ir_functions[FUNCTION_INDICATORS]) +
                        2.0 * ORDER * (double)program->interface->state_count);
  double event = EVENT + 4.0 * evaluation + operations_of(program->ir_functions[FUNCTION_SWITCHING_VALUES]);
  return (struct StepWork){rint(evaluation), rint(step), rint(event)};
}
