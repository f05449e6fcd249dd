/* An event resolution in progress (resolve.c), shared by the files that find modes and the state after an event. */
#pragma once

#include "instance/event_laws.h"
#include "nonsmooth/tolerances.h"

/*
 * FORCED_OPEN: the contact pulled, or an event opened it. FORCED_CLOSED: by the solution for all forces at rest.
 * SHARES_LOAD: it touched at rest, and was closed to share the load.
 */
enum Forced { UNFORCED, FORCED_OPEN, FORCED_CLOSED, SHARES_LOAD };

/*
 * The part of a contact or friction in the problem that is being solved, struct ContactImpulses or struct RestForces. In
 * the latter IS_OVERCOME is a friction that slips at its limit, and WAS_OPEN a contact that may close. IS_SLOW is a
 * friction that slid, and continues with its velocity if it does not stick. In a short step its rate, or that of a
 * contact whose bounce is lost, counts as 0 (end_slip.c).
 */
enum Part { LEFT_OUT, TAKES_PART, IS_OVERCOME, IS_SLOW, WAS_OPEN };

/*
 * The state of an event resolution: values and rounding error bounds at the present modes and state, and its history.
 * The arrays are parts of one workspace; value, error_bound and tolerances are valid if is_evaluated.
 */
struct Resolution {
  struct Instance *instance;
  const struct SwitchTable *switches;
  double time;
  double *state;
  enum Occasion occasion;
  size_t indicator; /* of the event, for AT_EVENT */
  struct Tolerances tolerances;
  double *value, *error_bound; /* value[] of the switch table, and its rounding error bounds */
  double *other_error_bound;   /* rounding error bounds by the second pattern, at the start of the event */
  double *force_error_bound;   /* rounding error bound of the force of each friction's constraint */
  double *began, *first_rate;  /* mode of each friction, and size of the rate of its velocity, before the event */
  double *largest;             /* of velocities and rates in value[] since the start of the event */
  double *condition;           /* value of each condition before the last change */
  double *happened;            /* 1 for each event that happened in this round, else 0 */
  double *flips;               /* of each indicator: switches in the event */
  enum Forced *forced;         /* of each contact: what its force, or an event, did last */
  double *rate;                /* of each branch before its last switch; 0 if it has not switched */
  double *absent;              /* of each branch: its mode whose piece has no value here; 0 for none */
  double *first_modes;         /* at the start of the event */
  double *struck;              /* contacts: 1 if an impulse acted in the event, else 0 */
  bool *has_shared;            /* of each contact: it was closed in the event to share the load */
  enum Part *part;             /* of each contact, then each friction */
  double *guess;     /* of contacts, then frictions: force in a short step; mode, if no friction is in a plane */
  double *start_gap; /* of each contact: the most negative one that rounded start values gave; else 0 */
  double *moves;     /* of each resting velocity: its mode by find_resting */
  double *probe_input, *probe_acceleration, *probe_sums; /* workspace of find_resting */
  double *ball_distance;                                 /* workspace of explain_ball() */
  double *acceleration;                                  /* accelerations, then constraint forces */
  double *kept_modes;
  double *rounded, *derivative, *rounding, *correction;
  const struct BranchMetadata *switched;  /* the first branch that switched; NULL for none */
  double overshoot;                       /* time in s since its indicator was 0 */
  const struct BranchMetadata *energetic; /* the first with holds_energy; NULL for none */
  double *energy;                         /* energies and momenta before it switched */
  bool changed, jumped;                   /* jumped: velocities or coordinates jumped */
  bool is_projected;                      /* the state was projected onto constraints */
  bool moved, thrown, set_mode;           /* events have set coordinates; coordinates or velocities; a mode */
  bool lags;                              /* frictions have switched, and velocities were not projected since */
  bool came_to_rest;                      /* contacts came to rest in their last round */
  bool keeps_accelerations;               /* evaluations use those of the last one */
  bool is_evaluated;                      /* value[], error_bound and tolerances are valid */
  bool has_rested, has_left_rest;         /* a velocity has come to rest, or has left it */
  bool is_departure;                      /* the indicator, of a branch, was at rest at 0 until the event */
  bool is_beside_departure;               /* another one has left 0 at this time, in the event before */
  bool has_started;                       /* contacts and frictions have their modes of the start, for AT_START */
  bool has_several_motions;               /* several motions of the frictions were logged */
  bool has_stuck_again;                   /* frictions at their limits at rest have stuck again */
  bool has_searched_jam;                  /* all modes of frictions at rest were tried */
  bool has_found_forces;                  /* modes were set from a solution for all forces at rest */
  int continued_forces;                   /* trials of those of a short step, end_slip.c */
  int impacts, plastic_impacts, lifts;    /* plastic_impacts: those of all contacts that touch */
  int ended_slips;                        /* by impulses, end_slip.c */
  double lost_speed;                      /* largest rate of a gap at which a contact came to rest in the event */
  double least_acceleration; /* smaller ones are rounding errors of the last solution for frictions at rest */
};

/* Returns the status of messages if the motion cannot continue: an error at the start, else a discarded step. */
static inline enum Status resolution_status(const struct Resolution *resolution) {
  return resolution->occasion == AT_START ? STATUS_ERROR : STATUS_DISCARD;
}

/* Contacts; FMUs without any do not link them. */
struct ContactLaws {
  /*
   * Handles one impact, contacts that come to rest, or that were lifted; sets *again if there was any. Returns NULL, or
   * the reason why the motion cannot continue.
   */
  const char *(*act)(struct Resolution *resolution, bool *again);
  /* Opens the closed contact that pulls most. False if none pulls. */
  bool (*open_pulling)(struct Resolution *resolution);
  /*
   * After frictions: opens and closes contacts at rest according to the unique solution for their forces. Returns NULL,
   * or the reason why there is none.
   */
  const char *(*resolve_forces)(struct Resolution *resolution, bool *again);
  /* After those: closes contacts that touch at rest, to share the load. False if there are none. */
  bool (*share_load)(struct Resolution *resolution);
  /* Moves start values that penetrate contacts by rounding; false if velocities cannot follow. */
  bool (*lift_start)(struct Resolution *resolution);
  /* Opens contacts that were moved apart, before the projection; false after logging one that penetrates. */
  bool (*part)(struct Resolution *resolution);
  /* Logs a contact that is penetrated. Returns NULL if there is none, else the reason to stop. */
  const char *(*check_gaps)(const struct Resolution *resolution);
};

struct RestingContacts; /* contact_forces.h */
struct Paradox;

/* The problem of contacts with sliding frictions; FMUs without any do not link it (sliding_laws.c). */
struct SlidingLaws {
  /*
   * True if a friction on a selected contact begins to slide: it is at rest, and its direction follows from its
   * acceleration. With other contacts closed it would slide in another direction, so that forces at this direction say
   * nothing about other solutions.
   */
  bool (*any_begins)(const struct Resolution *resolution);
  /* Finds what a message says if no forces are found. */
  void (*find_paradox)(const struct Resolution *resolution, const struct RestingContacts *resting,
                       struct Paradox *paradox);
  /* Finds the forces of frictions in planes at rest too, or ends the slip. False if that fails. */
  bool (*find_all_forces)(struct Resolution *resolution);
  /*
   * Does the same where forces of the contacts alone do not exist; sets *again if it succeeds. Else it logs the paradox,
   * and returns the reason to stop.
   */
  const char *(*resolve_paradox)(struct Resolution *resolution, const struct Paradox *paradox, bool *again);
  /* Warns at most once an instance that there may be other forces. */
  void (*report_others)(const struct Resolution *resolution, const struct RestingContacts *resting);
  /* Ends a slip of contacts without forces; false if there is none (end_slip.h). */
  bool (*end_slip)(struct Resolution *resolution);
  /* Logs the contact that jams where the solver stopped; false if none does. */
  bool (*explain)(struct Resolution *resolution);
};

/* Frictions: friction_laws, or plane_friction_laws where some follow from contacts or are in a plane. */
struct FrictionLaws {
  /* Lets one friction along a line slide whose constraint does not hold its velocity. False if there is none. */
  bool (*slide_unheld)(struct Resolution *resolution);
  /* Lets one friction stick or slide; sets *again if any. Returns NULL, or the reason why no mode is consistent. */
  const char *(*act)(struct Resolution *resolution, bool *again);
  /* Updates the reported modes; sets *again if any changed. False if the accelerations do not exist. */
  bool (*report)(struct Resolution *resolution, bool *again);
  /* Logs that something, such as accelerations, is missing for the frictions; there must be some. */
  void (*report_missing)(const struct Resolution *resolution, const char *missing);
  /* Logs a friction with a negative force. Returns NULL if there is none, else the reason to stop. */
  const char *(*check)(struct Resolution *resolution);
  /* Lets frictions slide that stick at a nonzero velocity. */
  void (*release)(struct Resolution *resolution);
  /* Finds the unique motion of frictions that follow from forces; false if there is none (jams_resolve()). */
  bool (*resolve_jam)(struct Resolution *resolution);
  /* Logs a friction that jams a constraint; false if none does (frictions_explain_jam()). */
  bool (*explain_jam)(struct Resolution *resolution, size_t branch);
  /* Sets the modes of frictions in planes from start values, as guess of struct EventLaws; NULL without any. */
  void (*guess)(struct Instance *instance);
  /*
   * Finds the modes of contacts and frictions at rest from all their forces at once (plane_rests.c), at most once in an
   * event resolution. False if there are none. This and the next ones are NULL in friction_laws.
   */
  bool (*resolve_together)(struct Resolution *resolution);
  /* plane_rests_continue() */
  bool (*continue_together)(struct Resolution *resolution, bool stops);
  /* let_stopped_slip() of contact_impulses.h */
  bool (*slip_where_stopped)(struct Resolution *resolution);
  /* True if the friction in a plane is so slow that it is tried to stick. */
  bool (*is_slow)(const struct Resolution *resolution, size_t plane);
  /* Lets the friction in a plane slide or stick. */
  void (*set_plane)(struct Resolution *resolution, size_t plane, bool slides);
};

/* Returns the length of value[]. */
size_t resolution_value_count(const struct SwitchTable *switches);

/* Return the number of doubles of workspace, and an event resolution in it. */
size_t resolution_work_count(void);
struct Resolution resolution_of(struct Instance *instance);

/* Returns an event resolution at a time and a state, for an occasion. */
struct Resolution resolution_at(struct Instance *instance, double time, double *state, enum Occasion occasion);

/* Evaluates all values and rounding error bounds for the present modes and state. False without accelerations. */
bool resolution_evaluate(struct Resolution *resolution);

/*
 * Evaluates all values and rounding error bounds with the accelerations of the last evaluation: behind an impact, the
 * gaps and the rates. False if the values do not exist.
 */
bool resolution_evaluate_rates(struct Resolution *resolution);

/* Evaluates the values at a state, without rounding error bounds. */
bool resolution_values(struct Resolution *resolution, const double *state, double *value);

/* Evaluates the values at a state and another time, with the inputs of that time. */
bool resolution_values_near(struct Resolution *resolution, double time, const double *state, double *value);

/* Evaluates value[] at a point with accelerations of 0, and the force of one constraint; constraints.count for none. */
void resolution_values_of_force(const struct Resolution *resolution, const struct Point *point, size_t constraint,
                                double force, double *value);

/* Evaluates the accelerations for the present modes and state. False if they do not exist. */
bool resolution_find_accelerations(struct Resolution *resolution);

/* Returns the accelerations of the last evaluation. */
const double *resolution_accelerations(const struct Resolution *resolution);

/* Finds the least change of the velocities, in the metric of M, onto the active constraints. False if that fails. */
bool resolution_find_correction(struct Resolution *resolution);

/* Makes this change. False if that fails. */
bool resolution_project_velocities(struct Resolution *resolution);

/*
 * True if velocities change along an active constraint, by resolution_project_velocities(); false if its row of J is 0.
 */
bool resolution_moves(const struct Resolution *resolution, size_t constraint);

/* Projects the coordinates onto the active constraints, by the least change in the metric of M. False if that fails. */
bool resolution_project_coordinates(struct Resolution *resolution);

/*
 * In s: a rate counts as a rounding error if it changes the velocity by less than its rounding error within this time.
 */
static const double shortest_slip = 1e-4;

/* True if the zero of this indicator is the event. */
static inline bool is_hit(const struct Resolution *resolution, size_t indicator) {
  return resolution->occasion == AT_EVENT && resolution->indicator == indicator;
}

/* True if a branch or a mode may have changed gaps or their rates. */
static inline bool may_change_gaps(const struct Resolution *resolution) {
  return resolution->switched != NULL || resolution->set_mode;
}

/* Ends a slip of contacts without forces. False if there is none, or no friction on contacts. */
static inline bool resolution_ends_slip(struct Resolution *resolution) {
  const struct SlidingLaws *laws = resolution->switches->sliding_laws;
  return laws != NULL && laws->end_slip(resolution);
}

/* Returns the value of a mode, given its index among the parameters. */
static inline double mode_of(const struct Resolution *resolution, size_t mode) {
  return resolution->instance->parameter[mode];
}

/* The same for the mode that it had at the start of the event. */
static inline double first_mode_of(const struct Resolution *resolution, size_t mode) {
  return resolution->first_modes[mode - (lagrangian.parameter_count - resolution->switches->mode_count)];
}

/* Returns the element of part[] of a friction. */
static inline enum Part *part_of_friction(const struct Resolution *resolution, size_t friction) {
  return &resolution->part[resolution->switches->contact_count + friction];
}

/* Sets a mode, and notes that something changed. */
void resolution_set_mode(struct Resolution *resolution, size_t mode, double value);

/* True if the state or a mode is no longer that before the event. */
bool resolution_has_changed(const struct Resolution *resolution);

/* Sets the mode of a friction: 0 for sticking, else the sign of its velocity, which frictions in planes ignore. */
void set_friction(struct Resolution *resolution, size_t friction, double mode);

/* Save and restore the modes, around trials of others. */
void resolution_keep_modes(struct Resolution *resolution);
void resolution_restore_modes(struct Resolution *resolution);

/* Returns the rounding error bound of a value, with the rounding of time at its rate. */
double resolution_error_bound(const struct Resolution *resolution, size_t slot, size_t rate);
