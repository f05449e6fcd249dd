/*
 * Functions by pieces, each of which is smooth, see branches.h. At a point where two pieces meet, that counts into which
 * the motion goes.
 */
#pragma once

#include "read/names/scope.h"

/* x - from inside of an interval, 0 before and to - from behind it. */
Node way_in(struct Scope *scope, Node x, double from, double to);

/* x - start where that is negative, else 0. */
Node way_before(struct Scope *scope, Node x, double start);

/* x - end where that is positive, else 0. */
Node way_behind(struct Scope *scope, Node x, double end);
