/*
 * The interface between a generated system and the runtime. lagc writes one `const struct Lagrangian lagrangian` for
 * each system; functions that a system does not need are NULL.
 *
 * State vector: coordinates q[n], velocities v[n], then the states of first order, among them the work of the
 * nonconservative forces. All quantities are in SI units.
 */
#ifndef LAGRANGIAN_H
#define LAGRANGIAN_H

#include <stdbool.h>
#include <stddef.h>

#include "arithmetic.h"
#include "passage.h"
#include "real.h"
#include "resting.h"
#include "series.h"
#include "series_limit.h"
#include "variable_type.h"

/* A point at which the equations are evaluated. */
struct Point {
  Real time;
  const Real *state;
  const Real *input;
  const Real *parameter;
  const Real *parameter_constants; /* constants that depend only on parameters, computed by prepare() */
  Real *work;                      /* workspace of the generated functions; its values are lost at the next call */
};

/*
 * Direction of a directional derivative; or, for a gradient, the weights of the state's derivatives and of the results.
 */
struct Seed {
  Real time;
  const Real *state;
  const Real *input;
  const Real *parameter;
  const Real *result; /* weights of results; only for gradients */
  bool repeats;       /* the point equals that of the previous call, and its workspace has not changed since */
};

/* Kinds of variables. The table of variables has them in this order; time comes last if nothing depends on it. */
enum VariableKind {
  VARIABLE_TIME,
  VARIABLE_STATE,
  VARIABLE_DERIVATIVE, /* of the state with the same index */
  VARIABLE_INPUT,
  VARIABLE_PARAMETER,
  VARIABLE_MODE,      /* declared by the author; its index is among the parameters, of which the modes are the last */
  VARIABLE_CONTACT,   /* mode of a contact or friction, with an index as of VARIABLE_MODE */
  VARIABLE_RESULT,    /* computed when read */
  VARIABLE_STATISTIC, /* the index is an enum Statistic */
  VARIABLE_INDICATOR  /* of events; computed when read */
};

/*
 * Counters since the start: steps of the solver, evaluations of the derivatives and of the Jacobian, handovers between
 * methods, and events. The last one, of evaluations in event resolutions, is not reported.
 */
enum Statistic {
  STATISTIC_STEPS,
  STATISTIC_DERIVATIVES,
  STATISTIC_JACOBIANS,
  STATISTIC_HANDOVERS,
  STATISTIC_EVENTS,
  STATISTIC_ROUNDS,
  STATISTIC_COUNT
};

/* A ScalarVariable of modelDescription.xml. Its value reference is its index in the table. */
struct ScalarVariable {
  const char *name;
  enum VariableKind kind;
  enum VariableType type;
  size_t index;          /* among the variables of its kind */
  bool is_output;        /* causality is output */
  bool is_reinitialized; /* a state that events or constraints may change */
  double start, minimum, maximum;
  /*
   * For messages: the parameters on which a calculated parameter depends, or on which the start value of a state or
   * mode depends. NULL for all other variables.
   */
  const char *follows_from;
};

/* True if the variable is a parameter that is calculated from others, see follows_from. */
static inline bool is_calculated_parameter(const struct ScalarVariable *variable) {
  return variable->kind == VARIABLE_RESULT && variable->follows_from != NULL;
}

/* True for a state or mode with a start value that depends on parameters; setting the variable overrides it. */
static inline bool has_following_start(const struct ScalarVariable *variable) {
  return (variable->kind == VARIABLE_STATE || variable->kind == VARIABLE_MODE) && variable->follows_from != NULL;
}

/* True for a variable that may be read in initialization mode, and be an unknown of directional derivatives. */
static inline bool is_unknown(const struct ScalarVariable *variable) {
  return variable->is_output || variable->kind == VARIABLE_DERIVATIVE ||
         (variable->follows_from != NULL && variable->kind != VARIABLE_MODE);
}

/* True for a variable that has values within a communication step. */
static inline bool is_intermediate(const struct ScalarVariable *variable) {
  return variable->kind == VARIABLE_INPUT || variable->kind == VARIABLE_STATE ||
         variable->kind == VARIABLE_DERIVATIVE ||
         (variable->kind == VARIABLE_RESULT && !is_calculated_parameter(variable));
}

/* Consecutive variables of the table that are the elements 1, 2, ... of one array. */
struct ArrayVariable {
  size_t first, count;
};

/* Sparsity pattern by columns. Column j may differ from 0 in the rows row[start[j]] to row[start[j + 1] - 1]. */
struct Sparsity {
  size_t count;
  const int *start; /* columns + 1 */
  const int *row;   /* ascending in each column */
};

/* Arithmetic operations of the generated functions, for the choice of a method. A sine and the like count as 20. */
struct OperationCounts {
  double derivatives, jacobian;
  double series, recurrences; /* per order; the cost of recurrences also grows with the order */
  double factor, solve;       /* multiplications of a factorization by lu, and of a triangular solution */
};

/* Operations, counted likewise: of an evaluation by the solver, of the rest of a step, and of an event. */
struct StepWork {
  double evaluation, step, event;
};

/*
 * Pattern of the factors L U of a matrix of symmetric pattern, with a row and a column for each coordinate. slot[]
 * maps a coordinate to its position in the order of elimination. By position, row i of L has the columns
 * column[start[i]] to column[start[i + 1] - 1], ascending, the diagonal last. The columns of U have the transposed
 * pattern.
 */
struct LuPattern {
  const int *slot, *start, *column;
};

/* A prescribed input: it occurs in constraints. The next `rates` inputs are its time derivatives. */
struct PrescribedInput {
  size_t input, rates;
};

/*
 * Metadata of what switches a system. A mode is constant between events; it is the parameter with the index given here.
 */
struct BranchMetadata {
  size_t mode;          /* sign of the indicator: -1, 0 or 1 */
  const char *function; /* name of the piecewise function, for messages */
  const char *file;     /* the file of the expression, without its folder */
  long line;            /* 0 if unknown */
  bool is_last_sign;    /* of an event's expression: at 0 the mode keeps its last nonzero sign */
  bool holds_energy;    /* the state determines it, and energies depend on it: they must not jump there */
  bool is_of_forces;    /* it occurs in forces and outputs alone, see branches_pass_kink() */
};

/* A contact: the indices of its mode among the parameters, and of its constraint. */
struct ContactMetadata {
  size_t mode;       /* 1 while it is closed, else 0 */
  size_t constraint; /* active while the contact is closed */
  size_t carried;    /* the force beside that of the constraint, in N; `mode` if the contact has none */
  const char *name;
  bool restitution_is_constant; /* during a simulation */
};

/* Dry friction along a velocity: the indices of its modes among the parameters, and of its constraint. */
struct FrictionMetadata {
  size_t mode;       /* sign of the velocity while it slides, 0 while it sticks */
  size_t reported;   /* the reported mode: also 0 while other constraints keep the velocity at 0 */
  size_t share;      /* along a line: the share of its sliding force beside that of its mode or constraint; else mode */
  size_t constraint; /* active while it sticks */
  const char *name;
  bool is_given;         /* its velocity is prescribed: it never sticks, and its mode is that of a branch */
  bool has_static_limit; /* its force is the stiction while it is reported as 0, and its mode is not */
};

/* Modes of a friction in a plane; the law while it has them, and what may end them. */
enum PlaneMode {
  PLANE_IS_FREE = -3, /* no force, as its contacts are open; only an event of these ends it */
  PLANE_CARRIES = -2, /* a constant share of its kinetic force; others constrain its velocity, until it moves */
  PLANE_IMPENDS = -1, /* the onset of slip: kinetic force against the slip direction, until the velocity leaves it */
  PLANE_STICKS = 0,   /* the forces of its constraints and a constant share, until they reach the stiction */
  PLANE_SLIDES = 1,   /* kinetic force against the velocity, until the speed falls to lower */
  PLANE_CREEPS = 2    /* the same at a small speed, until this falls to lower or rises to upper */
};

/* Coulomb friction in the plane of two velocities. Two consecutive frictions, "along" and "across", share one mode. */
struct PlaneMetadata {
  size_t along;             /* index of the friction along; the one across follows */
  size_t slip_direction[2]; /* modes that hold the slip direction, or the share of the kinetic force against it */
  size_t lower, upper;      /* modes that hold speeds; upper <= 0 is a bound on the velocity along the slip direction */
};

/* A velocity that is exactly 0 at rest in all that uses it. */
struct RestingMetadata {
  enum RestingKind kind;
  size_t mode;  /* enum RestingMode */
  size_t index; /* of the coordinate, or in resting_sums */
};

/* An assignment of an event, to a state or a mode. */
struct AssignmentMetadata {
  enum VariableKind kind;
  size_t index;
};

/* An <event> or <sample>. Its assignments are consecutive in struct SwitchTable, and take effect together. */
struct EventMetadata {
  enum Passage passage;
  size_t last_sign;    /* the mode that keeps the last nonzero sign; unused with PASSAGE_HOLDS */
  bool is_of_contacts; /* its condition depends on contacts, frictions or constraint forces */
  size_t first_assignment, assignment_count;
  const char *when; /* the condition as written; for a sample, its period */
};

/* Sampling times base + count period, whose parts are modes. */
struct SampleMetadata {
  size_t event;
  size_t branch; /* its indicator crosses 0 at the next sampling time */
  size_t base, count, period;
};

struct ContactLaws;
struct FrictionLaws;
struct Instance;
struct SlidingLaws;
struct Resolution;
struct TimeLaws;

/*
 * The switching elements of a system. Order of indicators: branches, contacts, frictions. The modes are the last
 * mode_count parameters, and change at events only.
 */
struct SwitchTable {
  size_t mode_count; /* number of modes, which are the last parameters */
  size_t branch_count, contact_count, friction_count, event_count, assignment_count;
  size_t energy_count;  /* energies and momenta in value[]; 0 unless a branch has holds_energy */
  bool feels_forces;    /* a branch depends on a constraint force */
  bool friction_varies; /* a friction force varies between events */
  bool has_last_signs;  /* some branches have is_last_sign */
  size_t importer;      /* index of the mode that is 1 in model exchange, else 0; parameter_count for none */
  const struct BranchMetadata *branches;
  const struct ContactMetadata *contacts;
  const struct FrictionMetadata *frictions;
  const struct EventMetadata *events;
  const struct AssignmentMetadata *assignments;
  const struct ContactLaws *contact_laws;   /* resolution.h; NULL without contacts */
  const struct FrictionLaws *friction_laws; /* resolution.h; NULL without frictions */
  const struct SlidingLaws *sliding_laws;   /* resolution.h; NULL if no friction follows from contacts */
  const struct ConePath *cone_path;         /* cones.h; NULL if no friction follows from contacts or is in a plane */
  /* Moves the state on whatever events of contacts happen (time_steps.h); NULL with fewer than two contacts. */
  bool (*step_over_events)(struct Instance *instance, double until, double end, double *share, double *time,
                           double *longest);
  /* [friction * contact_count + contact]: true if the friction depends on the contact force; NULL if none does. */
  const bool *rests_on;
  /* Computes indicator[] as below: a sign change may change a mode. acceleration as for result(). */
  void (*indicators)(const struct Point *point, const Real *acceleration, Real *indicator);
  /*
   * Bounds the rounding errors of the indicators of branches, of the gaps, and of the velocities of frictions, in units
   * of DBL_EPSILON. Counts the rounding of each operation; the point itself counts as exact.
   */
  void (*rounding_bounds)(const struct Point *point, const Real *acceleration, Real *uncertainty);
  /*
   * Reduces limit->step by the elementary functions in the indicators, before and after the point; see series_limit.h.
   * input and x hold Taylor coefficients about the point up to limit->order. So do watched_acceleration_count rows of w
   * from watched_acceleration_row on, of the accelerations and constraint forces; the rest of w[watched_rows] is
   * workspace. NULL if no function limits it.
   */
  void (*watched_limit)(const struct Point *point, const Real *acceleration, const Series *input, const Series *x,
                        Series *w, struct SeriesLimit *limit);
  size_t watched_rows, watched_acceleration_row, watched_acceleration_count;
  /* Computes value[] as below, on which the choice of modes depends. */
  void (*switching_values)(const struct Point *point, const Real *acceleration, Real *value);
  const struct PlaneMetadata *planes; /* ascending; NULL if there are none */
  size_t plane_count;
  const struct RestingMetadata *resting; /* NULL if there are none */
  size_t resting_count;
  /* Computes the sums of velocities of RESTING_SUM; NULL without any. */
  void (*resting_sums)(const struct Point *point, const Real *acceleration, Real *sum);
  void (*find_resting)(struct Resolution *resolution); /* resting_velocities.h; NULL without such velocities */
  /*
   * Computes the distances of the centres of ball_count balls from the shapes that they touch, and of the axes of
   * capsules, relative to their radii. ball_names: of their compliant contacts, for messages. NULL without any.
   */
  void (*ball_distances)(const struct Point *point, const Real *acceleration, Real *distance);
  const char *const *ball_names;
  size_t ball_count;
  /*
   * Branches whose indicators depend only on time, parameters and modes: affine_count that are affine in time, others.
   */
  const size_t *timed;
  size_t timed_count, affine_count;
  const struct TimeLaws *time_laws;     /* time_laws.h; NULL without such branches */
  const struct SampleMetadata *samples; /* NULL if there are none */
  size_t sample_count;
};

/*
 * Layout of value[] of struct SwitchTable. It begins with the indicators of the branches and their time
 * derivatives. For each contact and each friction it has the values of the enums below. The conditions of the
 * events and the assigned values follow, then the kinetic energy, the potential energy and the momenta. Last come
 * the scale of the speed for each friction in a plane, and period and offset for each sample. FRICTION_STICTION and
 * FRICTION_FORCE are the largest static and the kinetic friction force; ..._BACK are those against negative
 * velocities.
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

/* Values of each sample in value[]: its period and its first time, in s. */
enum { SAMPLE_EVERY, SAMPLE_OFFSET, SAMPLE_VALUES };

static inline size_t branch_rate_slot(const struct SwitchTable *switches, size_t branch) {
  return switches->branch_count + branch;
}

static inline size_t contact_slot(const struct SwitchTable *switches, size_t contact, size_t part) {
  return 2 * switches->branch_count + CONTACT_VALUES * contact + part;
}

static inline size_t friction_slot(const struct SwitchTable *switches, size_t friction, size_t part) {
  return contact_slot(switches, switches->contact_count, 0) + FRICTION_VALUES * friction + part;
}

static inline size_t condition_slot(const struct SwitchTable *switches, size_t event) {
  return friction_slot(switches, switches->friction_count, 0) + event;
}

static inline size_t assignment_slot(const struct SwitchTable *switches, size_t assignment) {
  return condition_slot(switches, switches->event_count) + assignment;
}

/* Returns the index of the kinetic energy; the potential energy and the momenta follow. */
static inline size_t energy_slot(const struct SwitchTable *switches) {
  return assignment_slot(switches, switches->assignment_count);
}

static inline size_t plane_slot(const struct SwitchTable *switches, size_t plane) {
  return energy_slot(switches) + switches->energy_count + plane;
}

static inline size_t sample_slot(const struct SwitchTable *switches, size_t sample, size_t part) {
  return plane_slot(switches, switches->plane_count) + SAMPLE_VALUES * sample + part;
}

/* Return indices in indicator[] of struct SwitchTable: branches, contacts, frictions. */
static inline size_t contact_indicator(const struct SwitchTable *switches, size_t contact) {
  return switches->branch_count + contact;
}

static inline size_t friction_indicator(const struct SwitchTable *switches, size_t friction) {
  return contact_indicator(switches, switches->contact_count) + friction;
}

/* Returns the plane of a friction along or across; plane_count for none. */
static inline size_t plane_of(const struct SwitchTable *switches, size_t friction) {
  size_t first = 0, end = switches->plane_count;
  while (first < end) {
    size_t middle = first + (end - first) / 2;
    if (switches->planes[middle].along + 1 < friction) first = middle + 1;
    else end = middle;
  }
  bool is_in_it = first < switches->plane_count && switches->planes[first].along <= friction;
  return is_in_it ? first : switches->plane_count;
}

/* True if the friction is one of the two of a friction in a plane. */
static inline bool is_in_plane(const struct SwitchTable *switches, size_t friction) {
  return plane_of(switches, friction) < switches->plane_count;
}

/* True if the friction follows from the force of the contact. */
static inline bool rests_on(const struct SwitchTable *switches, size_t friction, size_t contact) {
  return switches->rests_on != NULL && switches->rests_on[friction * switches->contact_count + contact];
}

/* Returns the sample that switches a branch; NULL for none. */
static inline const struct SampleMetadata *sample_of(const struct SwitchTable *switches, size_t branch) {
  for (size_t i = 0; i < switches->sample_count; i++)
    if (switches->samples[i].branch == branch) return &switches->samples[i];
  return NULL;
}

/* Returns the number of indicators; 0 for NULL. */
static inline size_t indicator_count(const struct SwitchTable *switches) {
  return switches == NULL ? 0 : friction_indicator(switches, switches->friction_count);
}

struct Lu;
struct Projection;
struct Solver;
struct EventLaws;

/*
 * Functions below that return an int return 0, or 1 + the coordinate in which the mass matrix is singular or not
 * positive definite. In the latter case their results are undefined.
 */

/* Metadata for the choice of steps. */
struct StepMetadata {
  const double *nominal; /* [state_count]: scales of the absolute tolerance */
  double tolerance;      /* relative; used if the importer gives none */
  double max_step;       /* longest internal step of a solver, in s; INFINITY if not given */
  long max_steps;        /* most internal steps in one communication step; 0 if not given */
  struct StepWork work;
  struct OperationCounts operations;
  bool depends_on_time;
};

/* For methods with a Jacobian matrix; zeros for others. */
struct ImplicitTable {
  struct Sparsity pattern;
  const struct Lu *lu;         /* factorization that the solver uses (lu.h); NULL for none */
  struct LuPattern lu_pattern; /* for lu_sparse */
  /* Computes d derivatives / d state: the elements of the pattern, in its order. NULL if directional() does so. */
  int (*jacobian)(const struct Point *point, Real *values);
};

/* Taylor series of the motion and of outputs; zeros without them. */
struct TaylorTable {
  size_t rows, output_rows; /* rows of workspace of series() and output_series() */
  /* Does what derivatives() does, and computes the coefficients 0 in the workspace w[rows] of series(). */
  int (*start)(const struct Point *point, Real *derivative, Series *w);
  /*
   * Computes the Taylor coefficients x[state_count] of the state up to order. Needs those of the inputs, coefficients 0
   * and 1 of the state, and w as left by start() at the same point.
   */
  void (*series)(const struct Point *point, int order, const Series *input, Series *x, Series *w);
  /* Reduces the step by the elementary functions in series(), see series_limit.h; NULL if there are none. */
  void (*limit)(const struct Point *point, const Series *input, const Series *x, const Series *w,
                struct SeriesLimit *limit);
  /*
   * Computes the Taylor coefficients y[results.count] of the results that are outputs, up to order. Needs those of the
   * inputs, and of the state up to order + 1; w[output_rows] is workspace.
   */
  void (*output_series)(const struct Point *point, int order, const Series *input, const Series *x, Series *w,
                        Series *y);
};

/* Results: variables that are computed when read. */
struct ResultTable {
  size_t count;
  const bool *uses_acceleration; /* [count] */
  /*
   * Returns a result. acceleration holds the accelerations and the constraint forces at the point, if they are used.
   * result_along() returns the derivative along seed, only for outputs and calculated parameters; acceleration_along
   * is the derivative of acceleration.
   */
  Real (*result)(const struct Point *point, const Real *acceleration, size_t result);
  Real (*result_along)(const struct Point *point, const struct Seed *seed, const Real *acceleration,
                       const Real *acceleration_along, size_t result);
};

/* Systems with constraints, those of contacts and frictions among them; zeros for others. */
struct ConstraintTable {
  size_t count, prescribed_input_count;
  const char *const *names;
  const char *const *inputs; /* [count]: names of each one's prescribed inputs, or NULL; NULL if there are none */
  const struct PrescribedInput *prescribed_inputs;
  const bool *coordinate_is_fixed;     /* [n]: fixed at the start; NULL if none is */
  const struct Projection *projection; /* projection.h */
  /*
   * Solves M a + J^T F = Q, J a = b. acceleration[n + m], with n coordinates and m constraints, holds the
   * accelerations, then the constraint forces, as result() and result_along() take them.
   */
  int (*accelerations)(const struct Point *point, Real *acceleration);
  int (*accelerations_along)(const struct Point *point, const struct Seed *seed, Real *acceleration);
  /*
   * Computes the least correction, in the metric of M, that returns a state to the constraints. correction[n + 3 m]
   * holds the changes of the coordinates, then three numbers of each constraint. These are the negative residual,
   * the pivot (infinite if it depends on others), and the norm of its row of J. seed->state holds the changes made
   * so far. correct_velocities() does the same for the velocities, in which the constraints are linear, at fixed
   * coordinates.
   */
  int (*correct_positions)(const struct Point *point, const struct Seed *seed, Real *correction);
  int (*correct_velocities)(const struct Point *point, Real *correction);
  /* The same for start values: fixed coordinates and their velocities do not change. NULL if none is fixed. */
  int (*start_positions)(const struct Point *point, const struct Seed *seed, Real *correction);
  int (*start_velocities)(const struct Point *point, Real *correction);
  /*
   * Computes the effect of impulses of contacts and frictions while the other constraints hold. impulse[n + m] holds
   * them at the indices of their constraint forces. response[2 n] holds the changes of the velocities, then the
   * generalized impulses. A contact acts along its gap, a friction along its velocity. repeats: as in struct Seed. NULL
   * without contacts.
   */
  int (*respond)(const struct Point *point, bool repeats, const Real *impulse, Real *response);
};

struct ReverseSweep;

/*
 * A system: its sizes, tables and functions. It is constant data. Functions are reentrant: all that they change is in
 * their arguments, and in Point.work of work_count numbers.
 */
struct Lagrangian {
  const char *name, *guid;
  size_t coordinate_count, state_count, input_count, parameter_count, parameter_constants_count;
  size_t work_count; /* size of Point.work */
  /* Number of last coordinates that are sensitivities of the others. An importer may set them at events. */
  size_t sensitivity_count;
  size_t state_sensitivity_count; /* the same of the states of first order */
  size_t variable_count, array_count;
  const struct ScalarVariable *variables;
  const struct ArrayVariable *arrays; /* ascending; NULL if there are none */
  int output_derivative_order;        /* highest time derivative of outputs that is available */
  /* [coordinate_count]: the parameters and coordinates on which its inertia depends, for messages. */
  const char *const *inertia_depends_on;
  const struct Solver *solver; /* NULL for a system without coordinates */
  struct StepMetadata steps;
  struct ResultTable results;
  struct TaylorTable taylor;
  struct ImplicitTable implicit;
  struct ConstraintTable constraints;
  const struct SwitchTable *switches;       /* NULL if nothing switches */
  const struct EventLaws *event_laws;       /* event_laws.h; NULL if nothing switches */
  const struct ReverseSweep *reverse_sweep; /* reverse_sweep.h; NULL unless lagc was asked for --adjoint */

  /*
   * Computes parameter_constants[parameter_constants_count] from parameter[parameter_count]: the constants that depend
   * only on parameters.
   */
  int (*prepare)(const Real *parameter, Real *parameter_constants);
  const size_t *following; /* ascending indices of the variables with has_following_start(); NULL if there are none */
  size_t following_count;
  /*
   * Computes the start values value[following_count] of these variables, and their derivatives along seed. Uses no
   * parameter constants. NULL if there are none.
   */
  void (*initial_state)(const struct Point *point, Real *value);
  void (*initial_state_along)(const struct Point *point, const struct Seed *seed, Real *value);
  /* derivative[state_count] = d state / dt */
  int (*derivatives)(const struct Point *point, Real *derivative);
  /* Computes the derivative of derivatives() along seed. */
  int (*directional)(const struct Point *point, const struct Seed *seed, Real *derivative);
  /*
   * Computes the gradient of a weighted sum by each state, input, parameter, and by time. The sum has the
   * derivatives of the state times seed->state, and the outputs times seed->result. NULL unless lagc ran with
   * --adjoint.
   */
  int (*weighted_gradient)(const struct Point *point, const struct Seed *seed, Real *gradient);
  /*
   * For linear systems, d state / dt = A state + B input + c; row i of matrix[states][states + inputs + 1] is A, B, c.
   */
  void (*linear)(const Real *parameter, const Real *parameter_constants, Real *matrix);
};

extern const struct Lagrangian lagrangian;

#endif
