#include "model/switches.h"

#include "algebra/simplify.h"
#include "base/memory.h"

void append_branch(struct Switches *switches, struct Branch branch) {
  branch.sign = allocate(1, sizeof *branch.sign);
  APPEND(switches->branches, switches->branch_count, branch);
}

void append_remainder(struct Switches *switches, struct Remainder remainder) {
  APPEND(switches->remainders, switches->remainder_count, remainder);
}

void append_ball(struct Switches *switches, struct BallContact ball) {
  APPEND(switches->balls, switches->ball_count, ball);
}

Node next_mode(struct Switches *switches, struct Graph *graph, const char *name) {
  return graph_symbol(graph, MODE, (int)(switches->first + switches->mode_count++), name);
}

Node mode_of_importer(struct Switches *switches, struct Graph *graph) {
  if (switches->importer == ZERO) switches->importer = next_mode(switches, graph, "importer");
  return switches->importer;
}

void append_condition(struct Switches *switches, Node condition) {
  if (switches->shown_conditions == NULL) switches->shown_conditions = allocate(1, sizeof *switches->shown_conditions);
  append_node(&switches->conditions, condition);
}

const struct Branch *branch_with_mode(const struct Switches *switches, Node mode) {
  for (size_t i = 0; i < switches->branch_count; i++)
    if (switches->branches[i].mode == mode) return &switches->branches[i];
  return NULL;
}

bool has_switches(const struct Switches *switches) {
  return switches->branch_count + switches->contact_count + switches->friction_count > 0;
}

bool has_planes(const struct Switches *switches) {
  bool has = false;
  for (size_t i = 0; i < switches->friction_count; i++) has |= switches->frictions[i].plane.axis != NO_PLANE;
  return has;
}

Node square_of_speed(struct Graph *graph, const struct Friction *along) {
  Node first = power_number(graph, along[0].velocity, 2.0), second = power_number(graph, along[1].velocity, 2.0);
  return add(graph, first, second);
}

/*
 * Below this share of the lower speed, the friction along a prescribed velocity falls to 0. Such a velocity may
 * pass through 0, where it has no direction.
 */
static const double resting_share = 0.1;

/*
 * Returns this component of the unit vector that a friction in a plane opposes: that of the velocity, or the slip
 * direction.
 */
static Node direction_in_plane(struct Graph *graph, const struct Friction *friction) {
  const struct Friction *along = friction->plane.axis == ACROSS ? friction - 1 : friction;
  Node component = choose_node(graph, friction->mode, friction->velocity, friction->plane.slip_direction);
  Node speed = square_of_speed(graph, along);
  if (friction->is_given)
    speed = add(graph, speed, power_number(graph, scale(graph, resting_share, along->plane.lower), 2.0));
  Node square = choose_node(graph, friction->mode, speed, ONE);
  return divide(graph, component, power_number(graph, square, 0.5));
}

static Node by_direction(struct Graph *graph, const struct Friction *friction, Node forth, Node back) {
  return forth == back ? forth : choose_node(graph, friction->mode, forth, back);
}

/* Returns the size of the force of a friction along a velocity while it slides, or acts with its limit at rest. */
static Node size_along_line(struct Graph *graph, const struct Friction *friction) {
  Node sliding = by_direction(graph, friction, friction->sliding, friction->sliding_back);
  if (!friction->has_static_limit) return sliding;
  Node limit = by_direction(graph, friction, friction->stiction, friction->stiction_back);
  return choose_node(graph, power_number(graph, friction->reported, 2.0), sliding, limit);
}

Node sliding_force(struct Graph *graph, const struct Friction *friction) {
  if (friction->plane.axis == NO_PLANE) {
    Node carried = friction->is_given ? ZERO : multiply(graph, friction->share, friction->sliding);
    return add(graph, multiply(graph, friction->mode, size_along_line(graph, friction)), carried);
  }
  return multiply(graph, friction->sliding, direction_in_plane(graph, friction));
}

Node friction_sticks(struct Graph *graph, const struct Friction *friction) {
  return subtract(graph, ONE, power_number(graph, friction->mode, 2.0));
}

Node friction_force(struct Graph *graph, const struct Friction *friction, Node force) {
  if (friction->is_given) return sliding_force(graph, friction);
  Node static_force = function(graph, GUARD, friction_sticks(graph, friction), force);
  return add(graph, static_force, sliding_force(graph, friction));
}
