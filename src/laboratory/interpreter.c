/*
 * Each function binds the spaces of its table to arrays in a frame and runs the table
 * (src/runtime/support/instructions.c). The interpreter decodes an opcode once for a run of equal instructions.
 */
#include "interpreter.h"

#include <math.h>

const struct Lagrangian *system_in_memory;
struct Interpreter interpreter;

static struct Frame frame_of(const struct Point *point, const struct Seed *seed, double *target) {
  struct Frame frame = instructions_frame(&interpreter.tables, point);
  if (seed != NULL) instructions_seed(&frame, seed);
  frame.base[SPACE_TARGET] = target;
  return frame;
}

/* Runs a function that fills a target. */
static int fill(enum FunctionName name, const struct Point *point, const struct Seed *seed, double *target) {
  struct Frame frame = frame_of(point, seed, target);
  return instructions_run(&frame, interpreter.code[name]);
}

/* Define functions that only run their table: at a point, along a seed too, or with given accelerations. */
#define AT_POINT(function, name)                                                                                       \
  static int function(const struct Point *point, double *target) {                                                     \
    return fill(name, point, NULL, target);                                                                            \
  }
#define ALONG_SEED(function, name)                                                                                     \
  static int function(const struct Point *point, const struct Seed *seed, double *target) {                            \
    return fill(name, point, seed, target);                                                                            \
  }
#define WITH_ACCELERATIONS(function, name)                                                                             \
  static void function(const struct Point *point, const double *acceleration, double *target) {                        \
    struct Frame frame = frame_of(point, NULL, target);                                                                \
    frame.base[SPACE_ACCELERATION] = (double *)acceleration;                                                           \
    instructions_run(&frame, interpreter.code[name]);                                                                  \
  }
AT_POINT(jacobian, FUNCTION_JACOBIAN)
AT_POINT(accelerations, FUNCTION_ACCELERATIONS)
AT_POINT(correct_velocities, FUNCTION_CORRECT_VELOCITIES)
AT_POINT(start_velocities, FUNCTION_START_VELOCITIES)
ALONG_SEED(directional, FUNCTION_DIRECTIONAL)
ALONG_SEED(accelerations_along, FUNCTION_ACCELERATIONS_ALONG)
ALONG_SEED(correct_positions, FUNCTION_CORRECT_POSITIONS)
ALONG_SEED(start_positions, FUNCTION_START_POSITIONS)
WITH_ACCELERATIONS(indicators, FUNCTION_INDICATORS)
WITH_ACCELERATIONS(rounding_bounds, FUNCTION_ROUNDING_BOUNDS)
WITH_ACCELERATIONS(switching_values, FUNCTION_SWITCHING_VALUES)
WITH_ACCELERATIONS(resting_sums, FUNCTION_RESTING_SUMS)
WITH_ACCELERATIONS(ball_distances, FUNCTION_BALL_DISTANCES)

static int prepare(const double *parameter, double *parameter_constants) {
  const struct Point point = {.parameter = parameter};
  struct Frame frame = frame_of(&point, NULL, parameter_constants);
  frame.base[SPACE_LOCAL] = parameter_constants + interpreter.parameter_constants_count;
  return instructions_run(&frame, interpreter.code[FUNCTION_PREPARE]);
}

static void initial_state(const struct Point *point, double *value) {
  fill(FUNCTION_INITIAL_STATE, point, NULL, value);
}

static void initial_state_along(const struct Point *point, const struct Seed *seed, double *value) {
  fill(FUNCTION_INITIAL_STATE_ALONG, point, seed, value);
}

static int derivatives(const struct Point *point, double *derivative) {
  struct Frame frame = frame_of(point, NULL, derivative);
  frame.base[SPACE_ACCELERATION] = derivative + interpreter.coordinate_count;
  return instructions_run(&frame, interpreter.code[FUNCTION_DERIVATIVES]);
}

static void linear(const double *parameter, const double *parameter_constants, double *matrix) {
  const struct Point point = {.parameter = parameter, .parameter_constants = parameter_constants};
  fill(FUNCTION_LINEAR, &point, NULL, matrix);
}

static int respond(const struct Point *point, bool repeats, const double *impulse, double *response) {
  (void)repeats;
  struct Frame frame = frame_of(point, NULL, response);
  frame.base[SPACE_SEED_ACCELERATION] = (double *)impulse;
  return instructions_run(&frame, interpreter.code[FUNCTION_RESPOND]);
}

/* Binds the spaces of series, which are arrays of numbers for the interpreter. */
static void set_rows(struct Frame *frame, const double *time, const void *input, const void *x, const void *w) {
  frame->base[SPACE_TIME_ROW] = (double *)time;
  frame->base[SPACE_ROW] = (double *)w;
  frame->base[SPACE_STATE_ROW] = (double *)x;
  frame->base[SPACE_INPUT_ROW] = (double *)input;
}

static int start(const struct Point *point, double *derivative, Series *w) {
  struct Frame frame = frame_of(point, NULL, derivative);
  frame.base[SPACE_ACCELERATION] = derivative + interpreter.coordinate_count;
  frame.base[SPACE_ROW] = *w;
  frame.base[SPACE_MASS] = w[interpreter.mass_row];
  return instructions_run(&frame, interpreter.code[FUNCTION_START]);
}

static void series(const struct Point *point, int order, const Series *input, Series *x, Series *w) {
  const Series time = {point->time, 1.0};
  struct Frame frame = frame_of(point, NULL, NULL);
  set_rows(&frame, time, input, x, w);
  frame.base[SPACE_MASS] = w[interpreter.mass_row];
  for (int k = 1; k < order && k + 1 < SERIES_LENGTH; k++)
    instructions_run_order(&frame, interpreter.order[FUNCTION_SERIES], k);
}

static void limit(const struct Point *point, const Series *input, const Series *x, const Series *w,
                  struct SeriesLimit *shortened) {
  const Series time = {point->time, 1.0};
  struct Frame frame = frame_of(point, NULL, NULL);
  set_rows(&frame, time, input, x, w);
  instructions_limit(&frame, interpreter.limits.checks, interpreter.limits.count, shortened);
}

static void watched_limit(const struct Point *point, const double *acceleration, const Series *input, const Series *x,
                          Series *w, struct SeriesLimit *shortened) {
  const Series time = {point->time, 1.0};
  struct Frame frame = frame_of(point, NULL, NULL);
  frame.base[SPACE_ACCELERATION] = (double *)acceleration;
  set_rows(&frame, time, input, x, w);
  instructions_run(&frame, interpreter.code[FUNCTION_WATCHED_LIMIT]);
  for (int k = 1; k <= shortened->order; k++)
    instructions_run_order(&frame, interpreter.order[FUNCTION_WATCHED_LIMIT], k);
  instructions_limit(&frame, interpreter.watched_limits.checks, interpreter.watched_limits.count, shortened);
}

static void output_series(const struct Point *point, int order, const Series *input, const Series *x, Series *w,
                          Series *y) {
  const Series time = {point->time, 1.0};
  struct Frame frame = frame_of(point, NULL, NULL);
  set_rows(&frame, time, input, x, w);
  frame.base[SPACE_TARGET_ROW] = *y;
  instructions_run(&frame, interpreter.code[FUNCTION_OUTPUT_SERIES]);
  for (int k = 1; k <= order && k + 1 < SERIES_LENGTH; k++)
    instructions_run_order(&frame, interpreter.order[FUNCTION_OUTPUT_SERIES], k);
}

/* Runs the table of a result and returns its value; NAN without a table. */
static double value_of(const struct IrTables *tables, struct Frame *frame, size_t result) {
  double *value = &interpreter.values[tables->slot[result]];
  *value = NAN;
  frame->base[SPACE_TARGET] = interpreter.values;
  instructions_run(frame, tables->words.items + tables->start[result]);
  return *value;
}

static double result(const struct Point *point, const double *acceleration, size_t number) {
  struct Frame frame = frame_of(point, NULL, NULL);
  frame.base[SPACE_ACCELERATION] = (double *)acceleration;
  return value_of(&interpreter.results, &frame, number);
}

static double result_along(const struct Point *point, const struct Seed *seed, const double *acceleration,
                           const double *acceleration_along, size_t number) {
  struct Frame frame = frame_of(point, seed, NULL);
  frame.base[SPACE_ACCELERATION] = (double *)acceleration;
  frame.base[SPACE_SEED_ACCELERATION] = (double *)acceleration_along;
  return value_of(&interpreter.results_along, &frame, number);
}

/* Sets a field, to NULL if the system does not need the function. */
#define SET(field, name, function) (field) = has_function(program, name) ? (function) : NULL

static void set_constraint_functions(struct ConstraintTable *constraints, const struct Program *program) {
  SET(constraints->accelerations, FUNCTION_ACCELERATIONS, accelerations);
  SET(constraints->accelerations_along, FUNCTION_ACCELERATIONS_ALONG, accelerations_along);
  SET(constraints->correct_positions, FUNCTION_CORRECT_POSITIONS, correct_positions);
  SET(constraints->correct_velocities, FUNCTION_CORRECT_VELOCITIES, correct_velocities);
  SET(constraints->start_positions, FUNCTION_START_POSITIONS, start_positions);
  SET(constraints->start_velocities, FUNCTION_START_VELOCITIES, start_velocities);
  SET(constraints->respond, FUNCTION_RESPOND, respond);
}

void set_functions(struct Lagrangian *system, struct SwitchTable *switches, const struct Program *program) {
  SET(system->prepare, FUNCTION_PREPARE, prepare);
  SET(system->initial_state, FUNCTION_INITIAL_STATE, initial_state);
  SET(system->initial_state_along, FUNCTION_INITIAL_STATE_ALONG, initial_state_along);
  SET(system->derivatives, FUNCTION_DERIVATIVES, derivatives);
  SET(system->directional, FUNCTION_DIRECTIONAL, directional);
  SET(system->linear, FUNCTION_LINEAR, linear);
  SET(system->implicit.jacobian, FUNCTION_JACOBIAN, jacobian);
  SET(system->taylor.start, FUNCTION_START, start);
  SET(system->taylor.series, FUNCTION_SERIES, series);
  SET(system->taylor.limit, FUNCTION_LIMIT, limit);
  SET(system->taylor.output_series, FUNCTION_OUTPUT_SERIES, output_series);
  SET(system->results.result, FUNCTION_RESULT, result);
  SET(system->results.result_along, FUNCTION_RESULT_ALONG, result_along);
  set_constraint_functions(&system->constraints, program);
  if (switches == NULL) return;
  SET(switches->indicators, FUNCTION_INDICATORS, indicators);
  SET(switches->rounding_bounds, FUNCTION_ROUNDING_BOUNDS, rounding_bounds);
  SET(switches->switching_values, FUNCTION_SWITCHING_VALUES, switching_values);
  SET(switches->resting_sums, FUNCTION_RESTING_SUMS, resting_sums);
  SET(switches->ball_distances, FUNCTION_BALL_DISTANCES, ball_distances);
  SET(switches->watched_limit, FUNCTION_WATCHED_LIMIT, watched_limit);
}
