/* Switching elements of a system, and their modes, which are constant between events. */
#pragma once

#include <stdbool.h>

#include "algebra/node_list.h"
#include "passage.h"
#include "resting.h"

/* A piecewise expression's branch. The mode is the sign of the indicator, -1, 0 or 1. */
struct Branch {
  Node mode, indicator;
  Node *sign;           /* of the indicator, without the modes of other branches, once it is needed; before, ZERO */
  bool is_last_sign;    /* of an event's expression: while the indicator rests at 0, the mode keeps its sign */
  bool is_of_friction;  /* the mode of a friction with a prescribed velocity; results keep the mode itself */
  unsigned kinds;       /* of the symbols on which the mode depends, also through other modes */
  const char *function; /* name of the piecewise function, and its line, for messages */
  long line;
};

/*
 * A unilateral constraint, gap >= 0. Its mode is 1 while it is closed: then -gap = 0 holds as a constraint, with a
 * compressive force. It is 0 while it is open.
 */
struct Contact {
  size_t constraint; /* index among the model's constraints */
  Node mode, gap, restitution;
  Node carried; /* with frictions, a mode: the part of the force that acts beside the constraint; else ZERO */
};

/*
 * Coulomb friction in a plane, along two velocities. It is two consecutive frictions of the model, "along" and
 * "across", with one mode. The mode is 1 while it slides against the velocity in the plane, and 0 while it sticks.
 * It is -1 while it slips along a given slip direction, as at the onset of slip. While it sticks, the slip
 * direction is the load that it carries in addition to its constraint, as a share of the sliding force. It is 0
 * unless several frictions share a load.
 */
enum PlaneAxis { NO_PLANE, ALONG, ACROSS };

/* The part of a friction in a plane; axis is NO_PLANE for a friction along a line. */
struct FrictionPlane {
  enum PlaneAxis axis;
  Node slip_direction; /* a mode: its component of the unit vector, or of the share */
  Node lower, upper;   /* modes that hold speeds; upper < 0 is a bound on the velocity along the slip direction */
};

/*
 * Dry friction along a velocity. Its mode is the sign of the velocity while it slides, and 0 while it sticks. Then
 * a constraint keeps the velocity at 0 with a force of at most stiction. `reported` is the mode that outputs show.
 * It is also 0 while other constraints keep the velocity at 0, when the friction may act with its limit at rest. That
 * is the stiction if has_static_limit, else the sliding force. Against a negative velocity the sliding force is
 * sliding_back, and the largest static one stiction_back. A friction with a prescribed velocity never sticks and has no
 * force at rest. Its mode is that of a branch on the velocity's sign, or in a plane its own.
 */
struct Friction {
  size_t constraint; /* index among the model's constraints */
  Node mode, reported, velocity, sliding, stiction, sliding_back, stiction_back;
  Node share; /* along a line beside others, a mode: the part of its sliding force that acts while it sticks; or ZERO */
  bool is_given;
  bool has_static_limit; /* the stiction differs, and other frictions or constraints may keep the velocity at 0 */
  struct FrictionPlane plane;
};

/* An expression mod(a, divisor) whose pieces are branches. */
struct Remainder {
  Node node, divisor;
};

/*
 * A velocity that conditions, functions or outputs use, or a sum of velocities in the indicator of a branch. Its mode is
 * positive while it moves, and 0 at rest: sticking frictions, closed contacts and constraints keep it at 0, or its
 * prescribed motion dwells.
 */
struct RestingVelocity {
  enum RestingKind kind;
  Node mode;
  size_t coordinate; /* unless RESTING_SUM */
  Node sum;          /* of RESTING_SUM */
};

/* An assignment of an event, to a coordinate, a velocity or a mode. */
struct Assignment {
  Node symbol, value;
};

/* Sampling times base + count period. These are modes, since base and period change when the period is changed. */
struct SampleClock {
  Node base, count, period;
  Node every, offset; /* period and first time, constant between events */
  Node branch;        /* mode of the branch that switches at the next time */
};

/* An <event> or <sample>. All values are computed before the first assignment. */
struct Event {
  enum Passage passage;
  struct SampleClock sample; /* with PASSAGE_SAMPLES */
  Node condition;            /* of modes only: positive if the condition holds; for an expression, its sign */
  Node expression;           /* whose zero crossing is the event; ZERO for conditions and samples */
  Node last_sign;            /* of an expression, the mode with its last nonzero sign; else ZERO */
  long line;                 /* of the sample, or of when, for messages */
  bool is_of_contacts;       /* the condition depends on contacts, frictions or constraint forces */
  struct Assignment *assignments;
  size_t assignment_count;
  char *text; /* for messages: the condition, or the period of a sample */
};

/* A compliant contact of a ball with another shape, or of two capsules. */
struct BallContact {
  const char *name;
  Node distance; /* of the centre, or of the axes, relative to the radii; at 0 the force has no direction */
};

/* All switching elements. Their modes are numbered from first on, after the parameters. */
struct Switches {
  size_t first;      /* index of the first mode: the number of parameters */
  size_t mode_count; /* modes of all kinds */
  struct Branch *branches;
  size_t branch_count;
  struct Remainder *remainders;
  size_t remainder_count;
  struct Contact *contacts;
  size_t contact_count;
  struct Friction *frictions;
  size_t friction_count;
  struct RestingVelocity *resting;
  size_t resting_count;
  struct BallContact *balls;
  size_t ball_count;
  struct Event *events;
  size_t event_count;
  Node importer;                     /* see mode_of_importer(); ZERO if nothing needs it */
  struct NodeList conditions;        /* see append_condition() */
  struct NodeList *shown_conditions; /* the first ones as pages would show them, ascending; NULL without conditions */
};

/* Appends a branch to the list. */
void append_branch(struct Switches *switches, struct Branch branch);

/* Appends a contact to the list of balls. */
void append_ball(struct Switches *switches, struct BallContact ball);

/* Returns the next mode, in the order of their numbers. */
Node next_mode(struct Switches *switches, struct Graph *graph, const char *name);

/*
 * Returns a mode that is 1 in model exchange, else 0. An importer compares indicators at the ends of its steps alone. It
 * may step over a contact whose indicators are constant on both sides.
 */
Node mode_of_importer(struct Switches *switches, struct Graph *graph);

/* Appends a condition of guards that leave out what has no effect elsewhere: pages do not show them. */
void append_condition(struct Switches *switches, Node condition);

/* Appends the expression of mod(a, divisor) to the list. */
void append_remainder(struct Switches *switches, struct Remainder remainder);

/* Returns the branch of a mode; NULL for other nodes. */
const struct Branch *branch_with_mode(const struct Switches *switches, Node mode);

/* True if events may occur. */
bool has_switches(const struct Switches *switches);

/* True if a friction acts in a plane. */
bool has_planes(const struct Switches *switches);

/* Returns the square of the speed of a friction in a plane. along: the first of its two frictions. */
Node square_of_speed(struct Graph *graph, const struct Friction *along);

/* Returns the force that the friction exerts against the velocity, in addition to the force of its constraint. */
Node sliding_force(struct Graph *graph, const struct Friction *friction);

/* Returns an expression that is 1 while the friction's constraint is active, else 0. */
Node friction_sticks(struct Graph *graph, const struct Friction *friction);

/* Returns the whole force of a friction: that of its constraint while it sticks, else the sliding force. */
Node friction_force(struct Graph *graph, const struct Friction *friction, Node force);
