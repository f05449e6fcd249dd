/* An event on its way: what finds the modes and the state behind it shares this. */
#ifndef SETTLEMENT_H
#define SETTLEMENT_H

#include "instance/event_laws.h"

struct Settlement {
  struct Instance *instance;
  const struct SwitchTable *switches;
  double time;
  double *state;
  enum Occasion occasion;
  size_t indicator;           /* for AT_EVENT */
  double *value, *noise;      /* value[], and what rounding may make of it */
  double *other_noise;        /* by rounding in another way, at the beginning of the event */
  double *force_noise;        /* what rounding may make of the force of each friction's constraint */
  double *began;              /* the mode of each friction, at the beginning of the event */
  double *largest;            /* of velocities and rates in value[], since the start of the event */
  double *condition;          /* as it was before the last change */
  double *happened;           /* 1 of each event that happened in this round, else 0 */
  double *flips, *was_opened; /* of each branch and friction; of each contact: -1 where it closed again by its force */
  double *rate;               /* of each branch, before it flipped last; 0 where it did not */
  double *takes_part;         /* of each contact, then of each friction: 1 in what pushes.h looks at, else 0 */
  double *acceleration;       /* and forces of constraints */
  double *kept_modes;
  double *rounded, *derivative, *rounding, *correction;
  const struct BranchFacts *switched;  /* the branch that was first; NULL for none */
  double overshoot;                    /* in s: how long ago its indicator was 0 */
  const struct BranchFacts *energetic; /* the first that holds energies; NULL for none */
  double *energy;                      /* energies and momenta before it */
  bool changed, jumped;                /* jumped: velocities, or coordinates did */
  bool moved, thrown, set_mode;        /* an event has set coordinates; coordinates or velocities; a mode */
  bool lags;                           /* frictions have changed, and velocities were not taken to what holds since */
  bool came_to_rest;                   /* contacts have, in the last round of them */
  bool is_evaluated;                   /* value[] and the noise are there */
  bool has_started;                    /* contacts and frictions are as they start, for AT_START */
  bool has_shared;                     /* what touches at rest shares the load */
  bool has_several_motions;            /* frictions have, which was logged */
  bool has_searched_jam;               /* all modes of frictions at rest were tried */
  bool has_found_forces;               /* modes were set by the forces of all at rest at once */
  int impacts, lifts;
  struct {
    size_t friction;        /* that has switched, where nothing else has changed since; friction_count for none */
    double mode, certainty; /* which it had, and by how many times rounding it left that */
  } last;
};

/* What a message is logged with where the motion cannot go on: a start is an error, a step is discarded. */
static inline enum Status settlement_status(const struct Settlement *settlement) {
  return settlement->occasion == AT_START ? STATUS_ERROR : STATUS_DISCARD;
}

struct Pushes;

/* What contacts do; FMUs without any do not hold it. */
struct ContactLaws {
  /*
   * One impact, or contacts that come to rest, or one that parts; *again where there was any. NULL, or the reason why the
   * motion cannot go on.
   */
  const char *(*act)(struct Settlement *settlement, bool *again);
  /*
   * Behind frictions: opens and closes contacts at rest as the only solution for their forces says. NULL, or the reason why
   * there is none.
   */
  const char *(*settle_forces)(struct Settlement *settlement, bool *again);
  /* Behind those: closes what touches at rest and shares the load; *again where there is any. NULL, or as above. */
  const char *(*share_load)(struct Settlement *settlement, bool *again);
  /* Moves start values that penetrate contacts by their rounding; false where velocities do not follow. */
  bool (*lift_start)(struct Settlement *settlement);
  /* Opens contacts that were moved apart, before constraints are kept; false after logging one that was pushed in. */
  bool (*part)(struct Settlement *settlement);
  /* Logs a contact that is penetrated; NULL where there is none, else the reason to refuse it. */
  const char *(*check_gaps)(const struct Settlement *settlement);
  /* Logs the contact that jams where the solver stopped; false where none does. */
  bool (*explain)(struct Settlement *settlement);
};

/* What frictions do; FMUs without any do not hold it. */
struct FrictionLaws {
  /* One friction that begins to stick or to slide; *again where there was any. NULL, or the reason why there is no mode. */
  const char *(*act)(struct Settlement *settlement, bool *again);
  /* Brings the modes that are told up to date; *again where that changed any. False where there are no accelerations. */
  bool (*tell)(struct Settlement *settlement, bool *again);
  /* Logs that something, as accelerations, is not found for the frictions, of which there are some. */
  void (*blame)(const struct Settlement *settlement, const char *missing);
  /* Logs a friction whose force is negative; NULL where there is none, else the reason to refuse it. */
  const char *(*check)(struct Settlement *settlement);
  /* Lets frictions slide that stick at a velocity which is not 0. */
  void (*release)(struct Settlement *settlement);
  /* Finds the one motion of frictions that follow from forces; false where there is none. As jams_resolve(). */
  bool (*resolve_jam)(struct Settlement *settlement);
  /* Logs a friction that jams a constraint; false where none does. As frictions_explain_jam(). */
  bool (*explain_jam)(struct Settlement *settlement, size_t branch);
  /* Sets the modes of frictions in planes to what start values say, as guess in struct EventLaws; NULL without any. */
  void (*guess)(struct Instance *instance);
  /* Lets the friction in a plane slide, or stick; NULL without any. */
  void (*set_plane)(struct Settlement *settlement, size_t plane, bool slides);
  /*
   * The impulse of each push where some are of frictions in a plane, such that the rates, and those that the impulses add, fulfil
   * the law of impacts. False where none is found. NULL without any.
   */
  bool (*find_impulses)(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                        double *impulse);
  /* Whether other impulses than these fulfil the law at the rates, and make another motion. */
  bool (*has_other_impulses)(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                             const double *impulse);
};

/* The numbers in value[]. */
size_t settlement_value_count(const struct SwitchTable *switches);

/* Numbers of workspace, and where they are. */
size_t settlement_work_count(void);
struct Settlement settlement_of(struct Instance *instance);

/* At a time and a state, for an occasion. */
struct Settlement settlement_at(struct Instance *instance, double time, double *state, enum Occasion occasion);

/* Brings all values up to date with the modes and the state; false where there are no accelerations. */
bool settlement_evaluate(struct Settlement *settlement);

/* The values at a state, without what rounding may make of them. */
bool settlement_values(struct Settlement *settlement, const double *state, double *value);

/*
 * Evaluates value[] at a point as if there were no accelerations, and no force but that of one constraint; constraints.count for
 * none.
 */
void settlement_values_of_force(const struct Settlement *settlement, const struct Point *point, size_t constraint,
                                double force, double *value);

/* The accelerations as the last evaluation left them. */
const double *settlement_accelerations(const struct Settlement *settlement);

/* Moves the velocities onto the constraints that hold, the least in the metric of M. False where there is none. */
bool settlement_push(struct Settlement *settlement);

/* Whether anything moves along a constraint that holds, as settlement_push() found: in a plane nothing moves across it. */
bool settlement_moves(const struct Settlement *settlement, size_t constraint);

/* Moves the coordinates onto the constraints that hold, the least in the metric of M. False where that cannot be. */
bool settlement_move(struct Settlement *settlement);

static inline bool is_hit(const struct Settlement *settlement, size_t indicator) {
  return settlement->occasion == AT_EVENT && settlement->indicator == indicator;
}

/* Whether gaps may have jumped or turned, by a branch or a mode. */
static inline bool may_turn_gaps(const struct Settlement *settlement) {
  return settlement->switched != NULL || settlement->set_mode;
}

static inline double mode_of(const struct Settlement *settlement, size_t mode) {
  return settlement->instance->parameter[mode];
}

void settlement_set_mode(struct Settlement *settlement, size_t mode, double value);

/* What is tried out in between leaves no mode behind. */
void settlement_keep_modes(struct Settlement *settlement);
void settlement_restore_modes(struct Settlement *settlement);

/* What rounding of the state and the time leaves of a value that changes at a rate. */
double settlement_noise(const struct Settlement *settlement, size_t place, size_t rate);

#endif
