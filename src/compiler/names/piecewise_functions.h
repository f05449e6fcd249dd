/*
 * Piecewise functions: abs, sign, min, max, if, floor and the segments of tables. The active piece is a mode: the sign
 * of a switching function, constant between events. So every expression is smooth between events and has a Taylor
 * series.
 */
#pragma once

#include "names/scope.h"

/* Returns the sign of a node: -1, 0 or 1, as a mode if it may change along the motion. function, line: for messages. */
Node branch_of(struct Scope *scope, Node node, const char *function, long line);

/* Returns the last nonzero sign of an event's expression, as a mode: see struct Branch.is_last_sign. */
Node last_sign_of(struct Scope *scope, Node node, long line);

/*
 * Returns a mode with the sign of a condition on parameters. By it an event detects that setting parameters changed the
 * condition.
 */
Node condition_of_parameters(struct Scope *scope, Node node, long line);

/* A bit of kinds beyond those of symbols: whether contacts are closed or frictions slide. */
enum { CONTACT_STATE = 1 << 29 };

/* A bit of allowed kinds: the expression is evaluated only at events, so that floor and the like are plain values. */
enum { AT_INSTANT = 1 << 28 };

/* Returns the kinds of symbols that a node depends on, including those that decide its modes, with CONTACT_STATE. */
unsigned deciding_kinds(const struct Scope *scope, Node node);

/*
 * Replaces the piecewise functions of a node that was parsed while the scope kept them whole. Does nothing while the
 * scope still does. line: for messages.
 */
Node with_modes(struct Scope *scope, Node node, long line);

/* Returns floor(node). Its events are the zeros of sin(pi x), whose sign gives the parity of floor(x). */
Node floor_of(struct Scope *scope, Node node, long line);

/* Returns abs, sign, min or max of nodes in terms of modes. */
Node piecewise_function(struct Scope *scope, enum Operation operation, Node left, Node right, long line);

/* The same, which messages call by its purpose. */
Node piecewise_function_for(struct Scope *scope, enum Operation operation, Node left, Node right, const char *purpose,
                            long line);
