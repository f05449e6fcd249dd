/* One instance of the FMU, for any interface: nothing here is shared between instances. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "instance/log.h"
#include "instance/scratch.h"
#include "lagrangian.h"

enum { INPUT_ORDER = 3 }; /* the highest input derivative; an input is a polynomial over a step */

enum Kind { KIND_MODEL_EXCHANGE, KIND_CO_SIMULATION };

/* Where an instance stands in its life. */
enum Phase {
  PHASE_INSTANTIATED,
  PHASE_INITIALIZATION,
  PHASE_EVENT,
  PHASE_CONTINUOUS_TIME,
  PHASE_STEP_COMPLETE,
  PHASE_STEP_FAILED,
  PHASE_TERMINATED,
  PHASE_ERROR,
  PHASE_INTERMEDIATE_UPDATE, /* within a communication step, while values of it are told */
  PHASE_COUNT
};

/*
 * Since the last step: nothing; state, inputs or parameters; the modes and the state by an event, which agree; or what makes
 * the solver start anew without a value that was set, as at the start and where the polynomials of inputs end.
 */
enum Change { CHANGED_NOTHING, CHANGED_VALUES, CHANGED_BY_EVENT, CHANGED_COURSE };

/* From one time to a later one. */
struct Span {
  double start, end;
};

/*
 * All that a saved state of the instance holds, in one block of memory without pointers. The values are state, input,
 * parameter, the input derivatives of order 1, then 2, then 3, where start values follow from parameters which states
 * were set (1, else 0), and what the solver keeps.
 */
struct Situation {
  int32_t phase; /* enum Phase */
  int32_t kind;  /* enum Kind */
  int32_t experiment_defined, stop_time_defined;
  int32_t input_derivatives_set; /* for the step to come */
  int32_t changed;               /* enum Change: what was, since the last step */
  int32_t waiting_event; /* 1 + the indicator whose zero ended the last step, where stops_at_events; 0 for none */
  int32_t gathered;      /* such events one after another that the time hardly tells apart */
  int64_t statistics[STATISTIC_COUNT];
  int64_t completed_steps;                      /* of an importer that integrates, since the start */
  int64_t reported_statistics[STATISTIC_COUNT]; /* at the last event mode, of a co-simulation that has one */
  double time, start_time, stop_time;
  double tolerance;
  double suggested_step; /* of a solver that starts anew, not clipped by the communication step; 0 for none */
  struct Span last_step; /* of the solver, which may end after time */
  double searched;       /* no event is left in it before this time */
  double values[];
};

/* The solver is to begin at a time. */
static inline void situation_begin(struct Situation *situation, double time) {
  situation->last_step = (struct Span){time, time};
  situation->searched = time;
}

struct Allocator {
  void *(*allocate)(size_t count, size_t size); /* zeros */
  void (*free)(void *block);
};

struct CommunicationStep;

struct Instance {
  struct Allocator memory;
  struct Log log;
  const char *function; /* of the interface, that was called last, for messages */
  enum Kind kind;
  struct Situation *situation;
  /* See reading.h: what was set when what is told was found last, and what is told. NULL where no start or step moves states. */
  struct Situation *given, *shown;
  bool is_reading;     /* the situation is what is told, and shown is what was set */
  bool shown_is_found; /* what is told was found, and is not as it was set */
  double *state, *input, *parameter, *input_derivatives, *state_was_set; /* inside situation->values */
  void *saved; /* what the solver keeps inside situation->values */
  double *prepared;
  bool prepared_is_stale;
  bool modes_stay;            /* before the start too: those of the start are being found, or shown */
  bool solver_is_stale;       /* the situation was replaced: what the solver keeps outside of it no longer counts */
  bool told_impossible_start; /* that there is no start, since the last reset */
  bool told_other_forces;     /* that forces of contacts may not be the only ones, since the last reset */
  bool told_other_impulses;   /* that an impact has other outcomes, since the last reset */
  uint64_t told_singularity;  /* the checksum of the situation whose lack of accelerations was logged last */
  int singular;               /* 1 + the coordinate in which the mass matrix was found singular last, 0 for none */
  size_t unkept;              /* 1 + the constraint that kept the last projection from success; 0 for none */
  const char *limited_by;     /* the elementary function that shortened the solver's last step; NULL for none */
  double *work;               /* 3 state_count + 2 input_count + parameter_count, for evaluations */
  double *point_work;         /* lagrangian.work_count, for generated functions */
  double *projection_work;    /* projection_work_count() */
  double *switching_work;     /* switching->work_count() */
  double departure;           /* the sign with which a branch that rested at 0 leaves it, as found last */
  bool
      lacks_update; /* of an importer that integrates: in event mode, no update of discrete states since it began or a value was set */
  bool uses_event_mode;                 /* of a co-simulation: the importer goes through events between steps */
  bool stops_at_events;                 /* and an event ends the step */
  bool was_at_zero;                     /* what changed its sign last had not left 0 by more than rounding before */
  struct Scratch scratch[SCRATCH_USES]; /* for events */
  double *event_state;  /* in FMUs that switch: the state behind the last event, and as many numbers of workspace */
  double *acceleration; /* what result() takes: accelerations and forces of constraints; and the same along a seed */
  void *solver_memory;
  /* Is told of each time that the solver comes to within a communication step, see intermediate.h; NULL for none. */
  void (*observe)(struct Instance *instance, struct CommunicationStep *step, double time);
  const struct Intermediate *intermediate; /* for it */
};

/* False, and nothing is allocated, where there is no memory. Logs nothing. */
bool instance_create(struct Instance *instance, enum Kind kind, const struct Allocator *memory, const struct Log *log);
void instance_destroy(struct Instance *instance);

/* Lets a block of situation_size() bytes be the situation. */
void instance_use(struct Instance *instance, struct Situation *situation);

/* As after creation: start values, nothing defined. */
void instance_reset(struct Instance *instance);

/* Goes back to a situation of this instance, situation_size() bytes. */
void instance_restore(struct Instance *instance, const void *situation);

/* The point of the situation: its time, state, inputs and parameters. */
static inline struct Point instance_point(const struct Instance *instance) {
  return (struct Point){.time = instance->situation->time,
                        .state = instance->state,
                        .input = instance->input,
                        .parameter = instance->parameter,
                        .prepared = instance->prepared,
                        .work = instance->point_work};
}

/* The phase as messages name it. */
const char *instance_phase_name(const struct Instance *instance);

/* Bytes of the situation of this system. */
size_t situation_size(void);

/* Of so many bytes that are a situation, which tells different ones apart. */
uint64_t situation_checksum(const void *situation);

#endif
