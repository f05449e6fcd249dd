/*
 * Functions by pieces as expressions of min and max, which every method takes piece by piece. Where two pieces meet, min
 * and max give the left operand's derivative: so the first piece to the right counts at a point, and each point belongs
 * to one piece.
 */
#ifndef PIECES_H
#define PIECES_H

#include "algebra/graph.h"

/* x - from inside of an interval, 0 before and to - from behind it. */
Node way_in(struct Graph *graph, Node x, double from, double to);

/* x - start where that is negative, else 0. */
Node way_before(struct Graph *graph, Node x, double start);

/* x - end where that is positive, else 0. */
Node way_behind(struct Graph *graph, Node x, double end);

#endif
