/*
 * Piecewise functions of tables, with a mode for each knot, see piecewise_functions.h. A mode of 0, exactly on the
 * knot, selects the piece to its right.
 */
#pragma once

#include "names/scope.h"

/* Returns x clamped to the interval, minus from. */
Node clamped_offset(struct Scope *scope, Node x, double from, double to);

/* Returns min(x - start, 0). */
Node offset_below(struct Scope *scope, Node x, double start);

/* Returns max(x - end, 0). */
Node offset_above(struct Scope *scope, Node x, double end);
