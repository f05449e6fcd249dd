/*
 * abs, sign, min, max, if and the knots of tables are smooth pieces. Which of them holds is a mode, the sign of a switching
 * function, that events alone change: so every expression is smooth between events, and its pieces have series.
 */
#pragma once

#include "read/names/scope.h"

/*
 * The sign of a node: -1, 0 or 1, a mode where it may change along the motion. function and line say what needs it, for
 * messages.
 */
Node branch_of(struct Scope *scope, Node node, const char *function, long line);

/* The side of 0 on which the expression of an event is: struct Branch.is_side. */
Node side_of(struct Scope *scope, Node node, long line);

/* Whether a node that is constant in time changes where parameters are set, by these alone. */
bool rests_on_parameters(const struct Graph *graph, Node node);

/* Of a condition of parameters alone: a mode, by which an event knows whether it held before these were set. */
Node tuned_condition(struct Scope *scope, Node node, long line);

/* A bit beyond those of kinds of symbols: whether contacts are closed, or frictions slide. */
enum { CONTACT_STATE = 1 << 29 };

/* Another one, of places: the expression is read at events alone, so that its roundings are values there. */
enum { AT_INSTANT = 1 << 28 };

/* The kinds of symbols that a node rests on, also by what decides on its pieces; CONTACT_STATE among them. */
unsigned kinds_that_decide(const struct Scope *scope, Node node);

/*
 * A node that was read while the scope keeps expressions whole, by its pieces, unless it still does; line: for messages.
 */
Node with_pieces(struct Scope *scope, Node node, long line);

/*
 * The largest whole number that is not above a node. Along the motion it switches at zeros of sin(pi x), whose sign says whether
 * it is even or odd.
 */
Node floor_of(struct Scope *scope, Node node, long line);

/* abs, sign, min or max of nodes, by their pieces. */
Node pieces_of(struct Scope *scope, enum Operation operation, Node left, Node right, long line);
