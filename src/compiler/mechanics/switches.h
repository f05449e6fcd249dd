/* What switches a system: modes, which are constant between events, and what changes them. */
#ifndef SWITCHES_H
#define SWITCHES_H

#include <stdbool.h>

#include "algebra/graph.h"

/* Its mode is the sign of its indicator, -1, 0 or 1; at a zero the mode changes. */
struct Switch {
  Node mode, indicator;
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
 * Dry friction along a velocity. Its mode is the sign of the velocity while it slides, 0 while it sticks: then a constraint
 * holds the velocity at 0 with a force of at most stiction.
 */
struct Friction {
  size_t constraint; /* among the model's */
  Node mode, velocity, sliding, stiction;
};

/* What a variable becomes at an event: a coordinate, a velocity or a mode. */
struct Assignment {
  Node symbol, value;
};

/* Happens where its condition becomes positive: a function of modes alone. */
struct Event {
  Node conditions[2]; /* of a zero that is passed in both directions there are two; else the second is ZERO */
  struct Assignment *assignments;
  size_t assignment_count;
  char *text; /* for messages */
};

struct Switches {
  size_t first;      /* the index of the first mode: the number of parameters */
  size_t mode_count; /* of all kinds */
  struct Switch *items;
  size_t count;
  struct Contact *contacts;
  size_t contact_count;
  struct Friction *frictions;
  size_t friction_count;
  struct Event *events;
  size_t event_count;
};

void append_switch(struct Switches *switches, struct Switch item);

/* Whether anything may happen along the motion. */
bool has_switches(const struct Switches *switches);

/* Frees what the switches own. */
void switches_clear(struct Switches *switches);

#endif
