/*
 * What a generated system offers the runtime. lagc writes one `const struct Lagrangian lagrangian` a system;
 * functions that a system does not need are NULL.
 *
 * State vector: coordinates q[n], velocities v[n], and last the states of first order, the work of the non-conservative forces
 * among them. All quantities are in SI units.
 */
#ifndef LAGRANGIAN_H
#define LAGRANGIAN_H

#include <stdbool.h>
#include <stddef.h>

#include "arithmetic.h"
#include "passage.h"
#include "real.h"
#include "series.h"
#include "series_limit.h"
#include "variable_type.h"

/* Where the equations are evaluated. */
struct Point {
  Real time;
  const Real *state;
  const Real *input;
  const Real *parameter;
  const Real *prepared; /* what prepare() made of the parameters */
  Real *work;           /* workspace of the generated functions, whose values do not last from call to call */
};

/* A direction of a directional derivative; or what derivatives of the state, and results, count by in a weighted sum. */
struct Seed {
  Real time;
  const Real *state;
  const Real *input;
  const Real *parameter;
  const Real *result; /* of a weighted sum alone */
  bool repeats;       /* the point is that of the call before, and nothing has touched its workspace since */
};

enum VariableKind {
  VARIABLE_TIME,
  VARIABLE_STATE,
  VARIABLE_DERIVATIVE, /* of the state with the same index */
  VARIABLE_INPUT,
  VARIABLE_PARAMETER,
  VARIABLE_MODE,      /* that the author declared; the index is that of a parameter, among which all modes stand last */
  VARIABLE_CONTACT,   /* the mode of a contact or friction, likewise */
  VARIABLE_RESULT,    /* computed when read */
  VARIABLE_STATISTIC, /* the index is an enum Statistic */
  VARIABLE_INDICATOR  /* of events; computed when read */
};

enum Statistic {
  STATISTIC_STEPS,
  STATISTIC_DERIVATIVES,
  STATISTIC_JACOBIANS,
  STATISTIC_HANDOVERS,
  STATISTIC_EVENTS,
  STATISTIC_COUNT
};

/* A ScalarVariable; its value reference is its place in the table. */
struct ScalarVariable {
  const char *name;
  enum VariableKind kind;
  enum VariableType type;
  size_t index;          /* among the variables of its kind */
  bool is_output;        /* causality is output */
  bool is_reinitialized; /* a state that events or constraints may change */
  double start, minimum, maximum;
  /*
   * Of a result that is a calculated parameter, and of a state whose start value is an expression: the parameters that
   * they follow from, for messages; NULL of all others.
   */
  const char *follows_from;
};

static inline bool is_calculated_parameter(const struct ScalarVariable *variable) {
  return variable->kind == VARIABLE_RESULT && variable->follows_from != NULL;
}

/* A state that starts with what the parameters say unless it is set itself. */
static inline bool has_following_start(const struct ScalarVariable *variable) {
  return variable->kind == VARIABLE_STATE && variable->follows_from != NULL;
}

/* One that may be read in initialization mode, and be differentiated along the knowns. */
static inline bool is_unknown(const struct ScalarVariable *variable) {
  return variable->is_output || variable->kind == VARIABLE_DERIVATIVE || variable->follows_from != NULL;
}

/* One that has values within a communication step. */
static inline bool is_intermediate(const struct ScalarVariable *variable) {
  return variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_DERIVATIVE ||
         (variable->kind == VARIABLE_RESULT && !is_calculated_parameter(variable));
}

/* Variables that follow each other in the table and are the elements 1, 2, ... of one array. */
struct ArrayVariable {
  size_t first, count;
};

/* The elements of a matrix that may differ from 0. Those of column j are in row[start[j]] to row[start[j + 1] - 1]. */
struct Sparsity {
  size_t count;
  const int *start; /* columns + 1 */
  const int *row;   /* ascending in each column */
};

/* Arithmetic operations of the generated functions, a sine and the like counted as 20, for choosing between methods. */
struct OperationCounts {
  double derivatives, jacobian;
  double series, recurrences; /* of an order of the series; the work of a recurrence grows with the order */
  double factor, solve;       /* multiplications in factors of a real matrix by lu, and in a triangle for a solution */
};

/* Operations, counted likewise: of an evaluation by the solver, of a step beside these, and of an event. */
struct StepWork {
  double evaluation, step, event;
};

/*
 * The factors L U of a matrix with a row and a column for each coordinate, of symmetric pattern. place: of each
 * coordinate in the order of elimination. By these places, row i of L has the columns column[start[i]] to
 * column[start[i + 1] - 1], ascending, the diagonal last; so have, transposed, the columns of U.
 */
struct LuPattern {
  const int *place, *start, *column;
};

/* An input that stands in constraints; those behind it are its time derivatives, as many as rates. */
struct Guide {
  size_t input, rates;
};

/*
 * What switches a system. A mode is constant between events, and stands among the parameters at the index that is given
 * here.
 */
struct BranchFacts {
  size_t mode;          /* the sign of the indicator: -1, 0 or 1 */
  const char *function; /* that has the pieces, in messages */
  const char *file;     /* in which it stands, without its folder */
  long line;            /* 0 where it is not known */
  bool is_side;         /* of an event's expression: what comes to 0 and rests there keeps it */
  bool holds_energy;    /* the state decides by it on the kinetic or potential energy, which must not jump there */
};

struct ContactFacts {
  size_t mode;       /* 1 while it is closed, else 0 */
  size_t constraint; /* which holds while it is closed */
  const char *name;
};

struct FrictionFacts {
  size_t mode;       /* the sign of the velocity while it slides, 0 while it sticks */
  size_t told;       /* the mode that is told: 0 also where others hold the velocity at 0 */
  size_t constraint; /* which holds while it sticks */
  const char *name;
  bool is_given; /* its velocity is given: it never sticks, and its mode is that of a branch */
};

/*
 * Friction in the plane of two velocities: the frictions along and across, which follow each other, have one mode: 1 while it
 * slides, 0 while it sticks, and -1 while it slides along its heading, as it does from rest on. The mode may change where it is
 * slower than the lower speed, goes back along the heading as fast, or is faster than the upper one, or aside of the heading.
 */
struct PlaneFacts {
  size_t along;      /* among the frictions */
  size_t heading[2]; /* the modes that are a unit vector */
  size_t lower,
      upper; /* modes, in units of the velocity; a negative upper one is where it goes back along the heading */
};

/* What an event sets: a state, or a mode. */
struct AssignmentFacts {
  enum VariableKind kind;
  size_t index;
};

struct EventFacts {
  enum Passage passage;
  size_t side;         /* the mode that keeps the last sign other than 0; of PASSAGE_HOLDS without meaning */
  bool is_of_contacts; /* contacts, frictions and forces decide on the condition */
  size_t first_assignment, assignment_count;
  const char *when; /* as written; every of a sample */
};

/* A sample at base + count period, by modes. */
struct SampleFacts {
  size_t event;
  size_t branch; /* turns at the next time */
  size_t base, count, period;
};

struct ContactLaws;
struct FrictionLaws;
struct TimeLaws;

struct SwitchTable {
  size_t mode_count; /* of the last parameters */
  size_t branch_count, contact_count, friction_count, event_count, assignment_count;
  size_t energy_count;  /* of energies and momenta, where branches hold them; else 0 */
  bool feels_forces;    /* a branch turns by the force of a constraint */
  bool friction_varies; /* the force of a friction does between events */
  bool has_sides;       /* branches that are sides */
  const struct BranchFacts *branches;
  const struct ContactFacts *contacts;
  const struct FrictionFacts *frictions;
  const struct EventFacts *events;
  const struct AssignmentFacts *assignments;
  const struct ContactLaws *contact_laws;   /* settlement.h; NULL without contacts */
  const struct FrictionLaws *friction_laws; /* settlement.h; NULL without frictions */
  /* Of each friction, for each contact: whether it follows from its force; NULL where none does. */
  const bool *rests_on;
  /* indicator[] as below: each changes its sign where a mode may change. acceleration as for result(). */
  void (*indicators)(const struct Point *point, const Real *acceleration, Real *indicator);
  /*
   * What the roundings of all operations may make of the indicators of branches, of the gaps and of the velocities of
   * frictions, in units of DBL_EPSILON; the point itself is taken as exact.
   */
  void (*roundings)(const struct Point *point, const Real *acceleration, Real *uncertainty);
  /*
   * Shortens limit->step to where the elementary functions in what the indicators look at hide nothing, as far before the
   * point as behind it. input and x hold Taylor coefficients about the point up to limit->order, and so does w[] in
   * watched_acceleration_count rows from watched_acceleration_row on, of the accelerations and forces; w[watched_rows] is
   * workspace. NULL where nothing can hide.
   */
  void (*watched_limit)(const struct Point *point, const Real *acceleration, const Series *input, const Series *x,
                        Series *w, struct SeriesLimit *limit);
  size_t watched_rows, watched_acceleration_row, watched_acceleration_count;
  /* What decides on the modes: value[] as below. */
  void (*switching_values)(const struct Point *point, const Real *acceleration, Real *value);
  const struct PlaneFacts *planes; /* ascending; NULL where there are none */
  size_t plane_count;
  /* The branches whose indicators are affine in time, and depend on parameters and modes beside it alone; ascending. */
  const size_t *timed;
  size_t timed_count;
  const struct TimeLaws *time_laws;  /* time_laws.h; NULL without such branches */
  const struct SampleFacts *samples; /* NULL where there are none */
  size_t sample_count;
};

/*
 * value[] of struct SwitchTable: the indicators of the branches, then their time derivatives; of each contact the gap, its first
 * and second time derivative and the restitution; of each friction the velocity, its time derivative, the stiction and the
 * force while it slides, and both against negative velocities; the conditions of the events; what they assign; the kinetic and the potential energy, and the momenta;
 * of frictions in a plane the scale of the speed; of each sample every and offset.
 */
enum { CONTACT_GAP, CONTACT_RATE, CONTACT_ACCELERATION, CONTACT_RESTITUTION, CONTACT_VALUES };
enum {
  FRICTION_VELOCITY,
  FRICTION_RATE,
  FRICTION_STICTION,
  FRICTION_FORCE,
  FRICTION_STICTION_BACK,
  FRICTION_FORCE_BACK,
  FRICTION_VALUES
};

enum { SAMPLE_EVERY, SAMPLE_OFFSET, SAMPLE_VALUES };

static inline size_t branch_rate_place(const struct SwitchTable *switches, size_t branch) {
  return switches->branch_count + branch;
}

static inline size_t contact_place(const struct SwitchTable *switches, size_t contact, size_t part) {
  return 2 * switches->branch_count + CONTACT_VALUES * contact + part;
}

static inline size_t friction_place(const struct SwitchTable *switches, size_t friction, size_t part) {
  return contact_place(switches, switches->contact_count, 0) + FRICTION_VALUES * friction + part;
}

static inline size_t condition_place(const struct SwitchTable *switches, size_t event) {
  return friction_place(switches, switches->friction_count, 0) + event;
}

static inline size_t assignment_place(const struct SwitchTable *switches, size_t assignment) {
  return condition_place(switches, switches->event_count) + assignment;
}

/* Of the kinetic energy, before the potential one and the momenta. */
static inline size_t energy_place(const struct SwitchTable *switches) {
  return assignment_place(switches, switches->assignment_count);
}

static inline size_t plane_place(const struct SwitchTable *switches, size_t plane) {
  return energy_place(switches) + switches->energy_count + plane;
}

static inline size_t sample_place(const struct SwitchTable *switches, size_t sample, size_t part) {
  return plane_place(switches, switches->plane_count) + SAMPLE_VALUES * sample + part;
}

/* indicator[] of struct SwitchTable: of the branches, the contacts and the frictions. */
static inline size_t contact_indicator(const struct SwitchTable *switches, size_t contact) {
  return switches->branch_count + contact;
}

static inline size_t friction_indicator(const struct SwitchTable *switches, size_t friction) {
  return contact_indicator(switches, switches->contact_count) + friction;
}

/* The plane of a friction along or across; plane_count for none. */
static inline size_t plane_of(const struct SwitchTable *switches, size_t friction) {
  size_t plane = 0;
  while (plane < switches->plane_count && friction - switches->planes[plane].along > 1) plane++;
  return plane;
}

static inline bool is_in_plane(const struct SwitchTable *switches, size_t friction) {
  return plane_of(switches, friction) < switches->plane_count;
}

/* The sample that turns a branch; NULL for none. */
static inline const struct SampleFacts *sample_of(const struct SwitchTable *switches, size_t branch) {
  for (size_t i = 0; i < switches->sample_count; i++)
    if (switches->samples[i].branch == branch) return &switches->samples[i];
  return NULL;
}

static inline size_t indicator_count(const struct SwitchTable *switches) {
  return switches == NULL ? 0 : friction_indicator(switches, switches->friction_count);
}

struct Lu;
struct Projection;
struct Solver;
struct EventLaws;

/*
 * The functions below that return an int return 0, or 1 + the coordinate in which the mass matrix is singular or not positive
 * definite; results are then undefined.
 */

/* How far a solver may err and go. */
struct StepFacts {
  const double *nominal; /* state_count: scales of the absolute tolerance */
  double tolerance;      /* relative, where the environment gives none */
  double max_step;       /* of the steps that a solver takes by itself, in s; INFINITY where none was given */
  long max_steps;        /* that a solver takes by itself in one communication step; 0 where none was given */
  struct StepWork work;
  struct OperationCounts operations;
  bool depends_on_time;
};

/* What methods with a Jacobian matrix take; empty for others. */
struct ImplicitTable {
  struct Sparsity pattern;
  const struct Lu *lu;         /* how the solver factors matrices (lu.h); NULL where it does not */
  struct LuPattern lu_pattern; /* where that is lu_sparse */
  /* d derivatives / d state: the elements of the pattern, in its order; NULL where directional() gives it by columns */
  int (*jacobian)(const struct Point *point, Real *values);
};

/* Taylor series of the motion and of outputs; empty without them. */
struct TaylorTable {
  size_t rows, output_rows; /* of workspace for series() and output_series() */
  /* The same as derivatives(); also fills the first coefficients in the workspace w[rows] of series(). */
  int (*start)(const struct Point *point, Real *derivative, Series *w);
  /*
   * Taylor coefficients x[state_count] of the state up to order, with those of the inputs given, the first two of the
   * state, and w as start() has left it at the point.
   */
  void (*series)(const struct Point *point, int order, const Series *input, Series *x, Series *w);
  /* Shortens a step to where the elementary functions in series() may hide nothing; NULL where there are none. */
  void (*limit)(const struct Point *point, const Series *input, const Series *x, const Series *w,
                struct SeriesLimit *limit);
  /*
   * Taylor coefficients y[results.count] up to order of the results that are outputs, from those of the inputs, and of
   * the state up to order + 1; w[output_rows] is workspace.
   */
  void (*output_series)(const struct Point *point, int order, const Series *input, const Series *x, Series *w,
                        Series *y);
};

/* Computed variables. */
struct ResultTable {
  size_t count;
  const bool *uses_acceleration; /* for each */
  /*
   * A computed variable; acceleration holds dv/dt at the point, and the constraints' forces, where it is used.
   * result_along: its derivative along seed, with the accelerations changing by acceleration_along; of outputs and
   * calculated parameters alone.
   */
  Real (*result)(const struct Point *point, const Real *acceleration, size_t result);
  Real (*result_along)(const struct Point *point, const struct Seed *seed, const Real *acceleration,
                       const Real *acceleration_along, size_t result);
};

/* What systems with constraints have, those of contacts and frictions among them; empty for others. */
struct ConstraintTable {
  size_t count, guide_count;
  const char *const *names;
  const char *const *inputs; /* the names of those that each holds, NULL for none; NULL without guides */
  const struct Guide *guides;
  const bool *coordinate_is_fixed;     /* at the start; NULL where none is */
  const struct Projection *projection; /* projection.h */
  /*
   * What result() and result_along() take: acceleration[n + m], with n coordinates and m constraints, holds the
   * accelerations and then the forces of the constraints; M a + J^T F = Q.
   */
  int (*accelerations)(const struct Point *point, Real *acceleration);
  int (*accelerations_along)(const struct Point *point, const struct Seed *seed, Real *acceleration);
  /*
   * What brings a state back to the constraints, the least in the metric of M: correction[n + 3 m] holds the changes of
   * the coordinates, how much each constraint lacks (that is, less its value), the last pivot of its row, infinite where
   * it follows from others, and the length of its row of J. seed->state holds by how much the coordinates have been moved
   * already. correct_velocities() does the same at the present coordinates, where constraints are linear in the
   * velocities.
   */
  int (*correct_positions)(const struct Point *point, const struct Seed *seed, Real *correction);
  int (*correct_velocities)(const struct Point *point, Real *correction);
  /* The same for start values, where fixed coordinates and their velocities stay; NULL where none is fixed. */
  int (*start_positions)(const struct Point *point, const struct Seed *seed, Real *correction);
  int (*start_velocities)(const struct Point *point, Real *correction);
  /*
   * What impulses of contacts and frictions do while the constraints hold: impulse[n + m] has them at the places of their
   * forces; response[2 n] holds the changes of the velocities, and then the impulses along the coordinates. A contact
   * pushes along its gap, a friction along its velocity. NULL without contacts.
   */
  int (*respond)(const struct Point *point, const Real *impulse, Real *response);
};

struct ReverseSweep;

struct Lagrangian {
  const char *name, *guid;
  size_t coordinate_count, state_count, input_count, parameter_count, prepared_count;
  size_t work_count; /* of Point.work */
  /* Of the coordinates the last ones, which are derivatives of others by values: an importer may set them at events. */
  size_t variation_count;
  size_t state_variation_count; /* the same of the states behind the velocities */
  size_t variable_count, array_count;
  const struct ScalarVariable *variables;
  const struct ArrayVariable *arrays; /* ascending; NULL where there are none */
  int output_derivative_order;        /* the highest by time that outputs have */
  /* For each coordinate: the parameters and coordinates on which its inertia depends, for messages. */
  const char *const *inertia_depends_on;
  const struct Solver *solver; /* NULL for a system without coordinates */
  struct StepFacts steps;
  struct ResultTable results;
  struct TaylorTable taylor;
  struct ImplicitTable implicit;
  struct ConstraintTable constraints;
  const struct SwitchTable *switches;       /* NULL where nothing switches */
  const struct EventLaws *event_laws;       /* event_laws.h; likewise */
  const struct ReverseSweep *reverse_sweep; /* reverse_sweep.h; NULL unless lagc was asked for --adjoint */

  /* prepared[prepared_count] from parameter[parameter_count]: whatever depends on parameters alone. */
  int (*prepare)(const Real *parameter, Real *prepared);
  /*
   * Those of state[state_count] whose start values follow from the point's parameters, and their derivatives along the
   * seed's; other elements are left as they are. NULL where there are none. Without prepared values.
   */
  void (*initial_state)(const struct Point *point, Real *state);
  void (*initial_state_along)(const struct Point *point, const struct Seed *seed, Real *state);
  /* derivative[state_count] = d state / dt */
  int (*derivatives)(const struct Point *point, Real *derivative);
  /* The derivative of derivatives() along seed. */
  int (*directional)(const struct Point *point, const struct Seed *seed, Real *derivative);
  /*
   * The gradient of the sum of the derivatives of the state times seed->state and of the outputs times seed->result, with
   * elements by each state, input and parameter, and by time. NULL unless lagc was asked for --adjoint.
   */
  int (*weighted_gradient)(const struct Point *point, const struct Seed *seed, Real *gradient);
  /* Of linear systems: d state / dt = A state + B input + c; matrix[i * (states + inputs + 1)] holds row i of A, B and c. */
  void (*linear)(const Real *parameter, const Real *prepared, Real *matrix);
};

extern const struct Lagrangian lagrangian;

#endif
