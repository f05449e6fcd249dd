/*
 * Elimination order of a sparse symmetric matrix by minimum degree, and the pattern of L in M = L D L^T (A. George, J.
 * W. H. Liu: The evolution of the minimum degree ordering algorithm, SIAM Review 31, 1989).
 *
 * Each step eliminates the row with the fewest neighbours in the elimination graph, the first of several, and connects
 * its neighbours with each other. A chain or a tree has no fill-in; a full matrix keeps its order. Each step joins
 * sorted sets, so the cost is about the sum of the squared column lengths of L.
 */
#pragma once

#include <stddef.h>

#include "algebra/graph.h"

/*
 * The rows of the lower triangle of L: row i has the elements start[i] .. start[i + 1] - 1, at ascending columns, the
 * diagonal last. Rows and columns are positions in order, the elimination order.
 */
struct Elimination {
  size_t *order;
  size_t *start, *column;
};

/* Row and column of an element. */
struct Position {
  size_t row, column;
};

/* Compares structs that begin with a position, for qsort(): by columns, then by rows. */
int compare_positions(const void *first, const void *second);

/*
 * Orders a matrix of count rows, with elements at these positions of the lower triangle and on all of the diagonal. A
 * row is eliminated after all its neighbours of a lower rank, as a constraint after its coordinates. rank: [count], or
 * NULL if all are equal. Counts its work in the graph; beyond the limit the result has no meaning.
 */
struct Elimination eliminate(const struct Graph *graph, size_t count, const unsigned char *rank,
                             const struct Position *positions, size_t position_count);
