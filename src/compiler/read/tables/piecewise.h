/*
 * Piecewise functions of tables, with a mode for each knot, see pieces_of_functions.h. A mode of 0, exactly on the
 * knot, selects the piece to its right.
 */
#pragma once

#include "read/names/scope.h"

/* Returns x clamped to the interval, minus from. */
Node way_in(struct Scope *scope, Node x, double from, double to);

/* Returns min(x - start, 0). */
Node way_before(struct Scope *scope, Node x, double start);

/* Returns max(x - end, 0). */
Node way_behind(struct Scope *scope, Node x, double end);
