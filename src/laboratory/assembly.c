/*
 * Assembles a system in memory: encodes the functions as instruction tables, and fills struct Lagrangian with
 * metadata and with the interpreter's functions. Sets the parts of the runtime that the linker selects in an FMU.
 * Nothing is freed, as a process has one system.
 */
#include "assembly.h"

#include <math.h>
#include <string.h>

#include "algebra/functions.h"
#include "base/memory.h"
#include "bounded_functions.h"
#include "nonsmooth/rests/resting_velocities.h"
#include "nonsmooth/resolution.h"
#include "instance/event_laws.h"
#include "instance/projection.h"
#include "instance/solver.h"
#include "instance/time_laws.h"
#include "interpreter.h"
#include "nonsymmetric.h"
#include "program/metadata/block_metadata.h"
#include "program/metadata/metadata.h"
#include "program/metadata/switch_metadata.h"
#include "random_numbers.h"
#include "saddle.h"
#include "support/lu.h"
#include "time_steps/time_steps.h"

extern const struct Solver solver_taylor, solver_radau, solver_auto, solver_exact;
extern const struct ContactLaws contact_laws;
extern const struct FrictionLaws friction_laws, plane_friction_laws;
extern const struct SlidingLaws sliding_laws;
extern const struct ConePath cone_path;

static const struct {
  const char *name;
  const struct Solver *solver;
} solvers[] = {{"taylor", &solver_taylor}, {"radau", &solver_radau}, {"auto", &solver_auto}, {"exact", &solver_exact}};

/* Returns the solver; NULL for those of SUNDIALS. */
static const struct Solver *solver_named(const char *name) {
  for (size_t i = 0; i < sizeof solvers / sizeof *solvers; i++)
    if (strcmp(solvers[i].name, name) == 0) return solvers[i].solver;
  return NULL;
}

static const int32_t *code_of(const struct Encoding *encoding, const struct IrFunction *ir) {
  struct WordList words = {0};
  if (ir == NULL) return NULL;
  encode(encoding, ir, &words);
  return words.items;
}

static struct Limits limits_in(const struct Encoding *encoding, const struct SeriesProgram *series) {
  struct Limits limits = {.checks = allocate(series->limit.count, sizeof *limits.checks), .count = series->limit.count};
  for (size_t i = 0; i < limits.count; i++) limits.checks[i] = encoded_check(encoding, &series->limit.items[i]);
  return limits;
}

static void add_series(const struct Encoding *encoding, enum FunctionName first, enum FunctionName order,
                       const struct SeriesProgram *series) {
  if (series == NULL) return;
  interpreter.code[first] = code_of(encoding, series->start);
  interpreter.order[order] = code_of(encoding, series->order);
}

typedef double FunctionOfOne(double);
typedef double FunctionOfTwo(double, double);

/* The functions that generated code calls, by their names in C: all of algebra/functions.c. */
#define OF_ONE(function)                                                                                               \
  { #function, function, NULL }
#define OF_TWO(function)                                                                                               \
  { #function, NULL, function }
static const struct LibraryFunction {
  const char *name;
  FunctionOfOne *of_one;
  FunctionOfTwo *of_two;
} library[] = {OF_ONE(sin),
               OF_ONE(cos),
               OF_ONE(tan),
               OF_ONE(asin),
               OF_ONE(acos),
               OF_ONE(atan),
               OF_ONE(sinh),
               OF_ONE(cosh),
               OF_ONE(tanh),
               OF_ONE(asinh),
               OF_ONE(exp),
               OF_ONE(acosh),
               OF_ONE(atanh),
               OF_ONE(fabs),
               OF_ONE(log),
               OF_ONE(floor),
               OF_ONE(logistic),
               OF_ONE(softplus),
               OF_ONE(sech),
               OF_ONE(log_cosh),
               OF_ONE(capped_exp),
               OF_ONE(capped_exp_slope),
               OF_TWO(pow),
               OF_TWO(atan2),
               OF_TWO(fmin),
               OF_TWO(fmax),
               OF_TWO(random_uniform),
               OF_TWO(random_gauss)};

/* Returns the function of this name, which exists. */
static const struct LibraryFunction *function_named(const char *name) {
  const struct LibraryFunction *function = library;
  while (strcmp(function->name, name) != 0) function++;
  return function;
}

static const struct BlockTable *blocks_of(const struct Program *program) {
  struct BlockTable *tables = allocate(program->blocks.count, sizeof *tables);
  for (size_t i = 0; i < program->blocks.count; i++) {
    const struct LoopedBlock *looped = &program->blocks.items[i];
    const struct InertiaBlock *block = looped->block;
    struct BlockTable *table = &tables[i];
    *table = (struct BlockTable){.count = block->count,
                                 .first_mass = looped->first_mass,
                                 .first_right_side = looped->first_right_side,
                                 .coordinate = block_numbers_of(block, program->model).items};
    if (!block_is_full(block)) {
      table->start = block->start;
      table->column = looped->columns;
    }
    if (block->force_count > 0) {
      table->factor = nonsymmetric_factor;
      table->solve_nonsymmetric = nonsymmetric_solve;
    } else if (block->constraint_count > 0) {
      table->factor = saddle_factor;
      table->solve = saddle_solve;
    }
    if (table->factor != NULL) table->least_forces = saddle_least_forces;
  }
  return tables;
}

static void add_shared_tables(const struct Encoding *encoding) {
  const struct Program *program = encoding->program;
  double *numbers = allocate(encoding->numbers.count, sizeof *numbers);
  FunctionOfOne **of_one = allocate(OPERATION_COUNT, sizeof *of_one);
  FunctionOfTwo **of_two = allocate(OPERATION_COUNT, sizeof *of_two);
  for (size_t i = 0; i < encoding->numbers.count; i++)
    numbers[i] = graph_value(program->model->graph, encoding->numbers.nodes[i]);
  for (enum Operation function = 0; function < OPERATION_COUNT; function++) {
    size_t slot = encoding->function[function];
    if (slot > 0 && operation_arity(function) == 1) of_one[slot - 1] = function_named(function_in_c(function))->of_one;
    if (slot > 0 && operation_arity(function) == 2) of_two[slot - 1] = function_named(function_in_c(function))->of_two;
  }
  interpreter.tables = (struct InstructionTables){numbers,
                                                  of_one,
                                                  of_two,
                                                  blocks_of(program),
                                                  encoding->local_count,
                                                  program->blocks.mass_count,
                                                  program->blocks.right_side_count};
}

static void add_results(const struct Encoding *encoding) {
  const struct Program *program = encoding->program;
  const struct ResultGroups alone = groups_of_one(program->interface->result_count);
  interpreter.results = encode_all(encoding, program->result, &program->groups);
  interpreter.results_along = encode_all(encoding, program->result_along, &alone);
  interpreter.values = allocate(interpreter.results.largest_slot + 1, sizeof(double));
}

static void fill_interpreter(const struct Encoding *encoding) {
  const struct Program *program = encoding->program;
  interpreter.coordinate_count = program->equations->count;
  interpreter.parameter_constants_count = program->parameter_constants->count;
  for (enum FunctionName i = 0; i < IR_FUNCTION_COUNT; i++)
    interpreter.code[i] = code_of(encoding, program->ir_functions[i]);
  add_series(encoding, FUNCTION_START, FUNCTION_SERIES, program->series);
  add_series(encoding, FUNCTION_OUTPUT_SERIES, FUNCTION_OUTPUT_SERIES, program->output_series);
  add_series(encoding, FUNCTION_WATCHED_LIMIT, FUNCTION_WATCHED_LIMIT, program->watched_series);
  if (program->series != NULL) {
    interpreter.mass_row = program->series->mass_row;
    interpreter.limits = limits_in(encoding, program->series);
  }
  if (program->watched_series != NULL) interpreter.watched_limits = limits_in(encoding, program->watched_series);
  add_shared_tables(encoding);
  add_results(encoding);
}

static struct SwitchTable *switches_of(const struct Program *program) {
  if (program->equations->switching == NULL) return NULL;
  struct SwitchTable *switches = allocate(1, sizeof *switches);
  *switches = switch_metadata_of(program);
  if (switches->contact_count > 0) switches->contact_laws = &contact_laws;
  if (switches->friction_count > 0)
    switches->friction_laws = switches_need_cone_path(switches) ? &plane_friction_laws : &friction_laws;
  if (switches_need_cone_path(switches)) switches->cone_path = &cone_path;
  if (switches->rests_on != NULL) switches->sliding_laws = &sliding_laws;
  if (switches->contact_count > 1) switches->step_over_events = step_over_events;
  if (switches->resting_count > 0) switches->find_resting = resting_find;
  if (switches->timed_count > 0) switches->time_laws = &time_laws;
  return switches;
}

const char *assemble(const struct Program *program, const char *guid) {
  const struct Solver *solver = program->solver != NULL ? solver_named(program->solver) : NULL;
  if (program->solver != NULL && solver == NULL) return program->equations->method->name;
  struct Encoding *encoding = encoding_create(program);
  struct Lagrangian *system = allocate(1, sizeof *system);
  struct SwitchTable *switches = switches_of(program);
  *system = metadata_of(program, encoding_work_count(encoding));
  system->guid = guid;
  system->solver = solver;
  system->switches = switches;
  system->event_laws = switches != NULL ? &event_laws : NULL;
  system->constraints.projection = has_function(program, FUNCTION_ACCELERATIONS) ? &projection : NULL;
  if (program->lu != NULL) system->implicit.lu = strcmp(program->lu, "lu_sparse") == 0 ? &lu_sparse : &lu_dense;
  set_functions(system, switches, program);
  fill_interpreter(encoding);
  system_in_memory = system;
  return NULL;
}
