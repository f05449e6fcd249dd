/* One instance of the FMU, for all versions of FMI. Instances share no data. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "instance/log.h"
#include "instance/scratch.h"
#include "lagrangian.h"

enum { INPUT_ORDER = 3 }; /* highest derivative of an input, which is a polynomial of time over a step */

/* The interface that the importer uses. */
enum InterfaceType { KIND_MODEL_EXCHANGE, KIND_CO_SIMULATION };

/* States of the FMI state machines (fmi/life_cycle.h). */
enum Phase {
  PHASE_INSTANTIATED,
  PHASE_INITIALIZATION,
  PHASE_EVENT,
  PHASE_CONTINUOUS_TIME,
  PHASE_STEP_COMPLETE,
  PHASE_STEP_FAILED,
  PHASE_TERMINATED,
  PHASE_ERROR,
  PHASE_INTERMEDIATE_UPDATE, /* within a communication step, while intermediate values are read */
  PHASE_INPUT_REQUEST,       /* as a communication step begins, while inputs at times within it are set */
  PHASE_COUNT
};

/*
 * The change since the last step: none; state, inputs or parameters; modes and state by an event,
 * consistently. CHANGED_COURSE restarts the solver without a value that was set: at the start, and where the
 * polynomials of inputs end.
 */
enum Change { CHANGED_NOTHING, CHANGED_VALUES, CHANGED_BY_EVENT, CHANGED_COURSE };

/* The update of the discrete states in event mode: missing; done before a value was set; done. */
enum Update { UPDATE_MISSING, UPDATE_BEFORE_CHANGE, UPDATE_DONE };

/* An interval of time in s; start <= end. */
struct Span {
  double start, end;
};

/*
 * The snapshot: all that a saved state of the instance contains, in one block without pointers.
 *
 * values[] holds the state, the inputs, the parameters, and the inputs' derivatives of orders 1, 2 and 3. A flag
 * follows for each variable of lagrangian.following: 1 if it was set. The solver's part comes last.
 */
struct FmuState {
  int32_t phase; /* enum Phase */
  int32_t kind;  /* enum InterfaceType */
  int32_t experiment_defined, stop_time_defined;
  int32_t input_derivatives_set; /* for the next step */
  int32_t changed;               /* enum Change, since the last step */
  int32_t waiting_event;         /* 1 + the indicator at the end of the last step, if uses_event_mode; 0 for none */
  int32_t close_events;          /* Zeno counter of such events; in model exchange, of those at corners of gaps */
  int64_t statistics[STATISTIC_COUNT];
  int64_t completed_steps;                      /* of an importer that integrates, since the start */
  int64_t update;                               /* enum Update */
  int64_t has_redundant;                        /* model exchange: constraints depend on each other at the last event */
  int64_t reported_statistics[STATISTIC_COUNT]; /* at the last event mode of a co-simulation */
  double time, start_time, stop_time;
  double tolerance;
  double suggested_step; /* proposed by a solver that restarts at each step, in s; 0 for none */
  struct Span last_step; /* of the solver, which may end after time; in model exchange, of the importer */
  double searched;       /* all events before it are handled */
  double switched;       /* in model exchange: time of the last event in which a branch switched */
  double values[];
};

/* Sets the time at which the solver or the importer is to start. */
static inline void fmu_state_begin(struct FmuState *fmu_state, double time) {
  fmu_state->last_step = (struct Span){time, time};
  fmu_state->searched = time;
}

/* Functions that allocate and free memory; allocate() returns NULL if there is none. */
struct Allocator {
  void *(*allocate)(size_t count, size_t size); /* returns zeros */
  void (*free)(void *block);
};

struct CommunicationStep;

/* An instance. fmu_state is the current snapshot; state, input, parameter and the like point into it. */
struct Instance {
  struct Allocator memory;
  struct Log log;
  const char *function; /* last called FMI function, for messages */
  enum InterfaceType kind;
  struct FmuState *fmu_state;
  /*
   * Snapshots for reading (reading.h): the values that were set, and the reported ones that follow from them. NULL in
   * systems in which neither the start nor a step moves states.
   */
  struct FmuState *given, *shown;
  bool is_reading;     /* fmu_state holds the reported values, and shown those that were set */
  bool shown_is_found; /* the reported values were computed, and differ from those set */
  double *state, *input, *parameter, *input_derivatives, *start_was_set; /* in fmu_state->values */
  void *saved;                                                           /* the solver's part of fmu_state->values */
  double *largest_input; /* the largest magnitude that each input was set to */
  double *parameter_constants;
  bool parameter_constants_are_stale;
  bool modes_stay;                /* keep modes also before the start: those of the start are computed or read */
  bool solver_is_stale;           /* the snapshot was replaced: solver_memory must follow it */
  bool reported_impossible_start; /* logged since the reset: there is no start */
  bool reported_other_forces;     /* logged since the reset: contact forces are not unique */
  bool reported_other_impulses;   /* logged since the reset: an impact has several outcomes */
  bool reported_time_steps;       /* the same: time steps have passed events */
  bool reported_slowness;         /* the same: a communication step takes long */
  bool reported_ended_slip;       /* logged since the reset: an impulse has ended a slip without forces */
  bool reported_straight_input;   /* logged since the reset: an input would leave its limits within a step */
  uint64_t reported_singularity;  /* checksum of the snapshot at which missing accelerations were logged */
  int singular;                   /* 1 + the coordinate of a singular mass matrix, at the last evaluation; 0 for none */
  bool is_out_of_memory;          /* an allocation of the present step has failed */
  size_t violated_constraint;     /* 1 + the constraint that the last projection could not fulfil; 0 for none */
  const char *limited_by;         /* function that limited the solver's last step; NULL for none */
  double *work;                   /* of evaluations: 3 state_count + 2 input_count + parameter_count */
  double *start_work;             /* of start values: lagrangian.following_count */
  double *point_work;             /* of generated functions: lagrangian.work_count */
  struct ProjectionWork *projection_work;
  double *switching_work;               /* event_laws->work_count() */
  double departure, departure_time;     /* the sign with which a branch at rest at 0 last left it, and when */
  bool uses_event_mode;                 /* co-simulation: the importer handles events between steps */
  bool stops_at_events;                 /* an event ends a communication step */
  bool lifts;                           /* the contact whose gap reached 0 in the last event lifts */
  bool was_at_zero;                     /* the last event's indicator had not left 0 before by more than rounding */
  struct Scratch scratch[SCRATCH_USES]; /* workspace of events */
  double *event_state;                  /* with events: the state after the last one; then state_count of workspace */
  double *acceleration;                 /* accelerations and constraint forces for result(); the same along a seed */
  void *solver_memory;
  /* Called at each end of a solver step within a communication step (intermediate.h); NULL for none. */
  void (*observe)(struct Instance *instance, struct CommunicationStep *step, double time);
  /* Requests the inputs at times within a communication step (intermediate.h); NULL for none. */
  void (*request_inputs)(struct Instance *instance, const struct CommunicationStep *step);
  const struct Intermediate *intermediate; /* the data of both */
};

/* Creates an instance. False without memory; then nothing is allocated. Logs nothing. */
bool instance_create(struct Instance *instance, enum InterfaceType kind, const struct Allocator *memory,
                     const struct Log *log);
void instance_destroy(struct Instance *instance);

/* Makes a block of fmu_state_size() bytes the snapshot of the instance. */
void instance_use(struct Instance *instance, struct FmuState *fmu_state);

/* Sets the state after creation: start values, no experiment. */
void instance_reset(struct Instance *instance);

/* Copies a snapshot of this instance, fmu_state_size() bytes, back into it. */
void instance_restore(struct Instance *instance, const void *fmu_state);

/* Returns the evaluation point of the snapshot: time, state, inputs and parameters. */
static inline struct Point instance_point(const struct Instance *instance) {
  return (struct Point){.time = instance->fmu_state->time,
                        .state = instance->state,
                        .input = instance->input,
                        .parameter = instance->parameter,
                        .parameter_constants = instance->parameter_constants,
                        .work = instance->point_work};
}

/* Returns the name of the phase in messages. */
const char *instance_phase_name(const struct Instance *instance);

/* Returns the bytes of a snapshot of this system. */
size_t fmu_state_size(void);

/* Returns a checksum of a block of bytes. */
uint64_t instance_checksum(const void *block, size_t size);
