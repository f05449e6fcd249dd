/* In which order the rows of a sparse symmetric matrix are eliminated, and what L of M = L D L^T then holds. */
#pragma once

#include <stddef.h>

#include "algebra/graph.h"

/*
 * The rows of the lower triangle of L: row i has its elements at start[i] .. start[i + 1] - 1, their columns ascending
 * and the diagonal last. Rows and columns are places in order.
 */
struct Elimination {
  size_t *order;
  size_t *start, *column;
};

/* An element of the matrix: row and column. */
struct Position {
  size_t row, column;
};

/* For qsort(), of what begins with a position: by columns, and in these by rows. */
int compare_positions(const void *first, const void *second);

/*
 * For a matrix of count rows with elements at these positions of the lower triangle and on all of the diagonal. Always
 * takes the row with the fewest neighbours among those left (minimum degree), the first of several: a chain or a tree
 * fills nothing in, and a full matrix stays as it is. A row from late on is not taken before its neighbours below late;
 * late is count for none. Its work is counted in the graph; beyond the limit the result is no elimination.
 */
struct Elimination eliminate(const struct Graph *graph, size_t count, size_t late, const struct Position *positions,
                             size_t position_count);
