/* What switches a system: modes, which are constant between events, and what changes them. */
#pragma once

#include <stdbool.h>

#include "algebra/graph.h"
#include "passage.h"

/* Its mode is the sign of its indicator, -1, 0 or 1; at a zero the mode changes. */
struct Branch {
  Node mode, indicator;
  bool is_side;         /* of an event's expression: what comes to 0 and rests there keeps it */
  bool is_of_friction;  /* the mode of a friction whose velocity is given; results hold the mode itself */
  unsigned kinds;       /* of the symbols that decide on the mode, those of further modes among them */
  const char *function; /* that has the pieces, and where: for messages */
  long line;
};

/*
 * A unilateral constraint, gap >= 0. Its mode is 1 while it holds as a constraint, -gap = 0, whose force then presses, and
 * 0 while it is open.
 */
struct Contact {
  size_t constraint; /* among the model's */
  Node mode, gap, restitution;
};

/*
 * What a friction along one of two velocities has that acts in their plane: Coulomb's cone. Both are frictions of the model, the
 * one across follows the one along, and share their modes: the common mode is 1 while the friction slides against the velocity
 * in the plane, 0 while it sticks, and -1 while it slides along the heading, as it does from rest on. While it sticks the heading
 * is what it carries beside its constraint, as a share of what it pushes with sliding: 0 but where several carry a load.
 */
enum PlaneAxis { NO_PLANE, ALONG, ACROSS };

struct PlaneSide {
  enum PlaneAxis axis;
  Node heading;      /* a mode: this component of a unit vector, or of a share */
  Node lower, upper; /* modes: speeds at which the mode may change; a negative upper one is along the heading */
};

/*
 * Dry friction along a velocity. Its mode is the sign of the velocity while it slides, 0 while it sticks: then a constraint
 * holds the velocity at 0 with a force of at most stiction. What it pushes with as it slides, it may also take at rest,
 * where others hold the velocity at 0: the told mode is 0 then. Against a negative velocity it pushes with sliding_back, up to
 * stiction_back. One whose velocity is given, by drives or inputs, never sticks: its mode is that of a branch, the velocity's
 * sign, or in a plane its own, and at rest it has no force.
 */
struct Friction {
  size_t constraint; /* among the model's */
  Node mode, told, velocity, sliding, stiction, sliding_back, stiction_back;
  bool is_given;
  struct PlaneSide plane;
};

/* What a variable becomes at an event: a coordinate, a velocity or a mode. */
struct Assignment {
  Node symbol, value;
};

/* Times base + count period, by modes: those of base and period change where the period is set anew. */
struct Sample {
  Node base, count, period;
  Node every, offset; /* constant between events: the period, and the first time */
  Node branch;        /* the mode of the branch that turns at the next time */
};

struct Event {
  enum Passage passage;
  struct Sample sample; /* of PASSAGE_SAMPLES */
  Node condition;       /* a function of modes alone: positive where it holds, or the sign of the expression */
  Node expression;      /* that passes 0; ZERO for conditions and samples */
  Node side;            /* of an expression, the mode that keeps its last sign other than 0; else ZERO */
  long line;            /* of a sample, or of the expression, for messages */
  bool is_of_contacts;  /* contacts, frictions and forces decide on the condition */
  struct Assignment *assignments;
  size_t assignment_count;
  char *text; /* for messages: when, or every of a sample */
};

struct Switches {
  size_t first;      /* the index of the first mode: the number of parameters */
  size_t mode_count; /* of all kinds */
  struct Branch *branches;
  size_t branch_count;
  struct Contact *contacts;
  size_t contact_count;
  struct Friction *frictions;
  size_t friction_count;
  struct Event *events;
  size_t event_count;
};

void append_branch(struct Switches *switches, struct Branch branch);

/* Whether anything may happen along the motion. */
bool has_switches(const struct Switches *switches);

/* Whether any friction acts in a plane. */
bool has_planes(const struct Switches *switches);

/* Of a friction that acts in a plane, of which this is the part along: the square of the speed. */
Node square_of_speed(struct Graph *graph, const struct Friction *along);

/* What it pushes with against its velocity without its constraint, and along it where that is negative. */
Node sliding_push(struct Graph *graph, const struct Friction *friction);

/* Positive while its constraint holds, else 0. */
Node friction_sticks(struct Graph *graph, const struct Friction *friction);

/* The force of a friction, from that of its constraint: while it slides it belongs to none. */
Node friction_force(struct Graph *graph, const struct Friction *friction, Node force);
