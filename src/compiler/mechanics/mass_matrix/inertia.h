/*
 * The mass matrix M = d2L/dv dv, with the constraints' Jacobian matrix J as K = (M J^T; J 0). Its rows are the
 * coordinates, then the constraints.
 *
 * K is sparse. Rows that are not coupled form independent blocks, found as connected components; each one is
 * factored as L D L^T in an order of minimum degree (elimination.h). Constraints come after their coordinates in
 * it, so that no pivoting is needed (saddle.h). Small blocks are solved symbolically, kinematic trees by
 * articulated inertias
 * (articulated.h), others at run time.
 */
#pragma once

#include "mechanics/mass_matrix/articulated.h"

/* A pivot that is checked at run time: M is singular unless value > 0, and value is not small against scale. */
struct Pivot {
  Node value;    /* D_i of M = L D L^T */
  Node diagonal; /* M_ii */
  Node scale;    /* magnitude of the terms of M_ii, with |sin| and |cos| as 1 */
  size_t coordinate;
};

/*
 * A connected component of the rows of K. Elements have the pattern of L: row i has the elements
 * start[i] .. start[i + 1] - 1, at ascending columns, the diagonal last. Rows and columns are positions in coordinates.
 */
struct InertiaBlock {
  size_t count;
  size_t constraint_count; /* number of its rows that are constraints; each is eliminated after its coordinates */
  size_t *coordinates;     /* its rows, in the order of elimination */
  bool is_unrolled;        /* solved symbolically, as straight-line code; else numerically at run time */
  size_t *start, *column;
  Node *mass; /* elements of K; ZERO at fill-in */
  /* Forces on which generalized forces depend: number, row of each, columns added to K; see nonsymmetric.h. */
  size_t force_count, *forces;
  Node *nonsymmetric;
  Node *factor; /* unrolled blocks: the elements of L, and of D on the diagonal; else NULL */
  /* A kinematic tree, which replaces elements and factors; else NULL. Its rows are ascending. */
  const struct ArticulatedTree *tree;
};

/* K, as the list of its blocks. Each row belongs to one block. */
struct Inertia {
  size_t count;            /* rows: coordinates and constraints */
  size_t coordinate_count; /* number of coordinates */
  struct InertiaBlock *blocks;
  size_t block_count;
  size_t *block_of, *index_in_block; /* of each row: its block, and its position in the block */
  unsigned char *rank;  /* of each row: rows of a lower rank are eliminated before it, if they are coupled */
  struct Pivot *pivots; /* of unrolled blocks */
  size_t pivot_count;
};

/* Returns the matrix, factors and pivots with each symbol s replaced by replacements[s]. */
struct Inertia *inertia_substitute(struct Graph *graph, const struct Inertia *inertia, const Node *replacements);

/* Solves K solution = right_side for the unrolled blocks; other elements become ZERO. Both may be the same array. */
void inertia_solve(struct Graph *graph, const struct Inertia *inertia, const Node *right_side, Node *solution);

/* Factors a block. */
void block_factor(struct Graph *graph, struct InertiaBlock *block);

/* Solves for the unknowns of an unrolled block in place, in their order of elimination. */
void block_solve(struct Graph *graph, const struct InertiaBlock *block, Node *x);

/* Adds K vector to sum. */
void inertia_add_product(struct Graph *graph, const struct Inertia *inertia, const Node *vector, Node *sum);

/* Returns the index of element (i, j) in its block's mass; the number of elements if it is not in the pattern. */
size_t inertia_find(const struct Inertia *inertia, size_t i, size_t j);

/* Returns K_ij; ZERO for trees, whose elements are not formed. */
Node inertia_element(const struct Inertia *inertia, size_t i, size_t j);

/* True if a block is a tree; false for NULL. */
bool inertia_has_trees(const struct Inertia *inertia);

/* Returns the block of a row. */
const struct InertiaBlock *inertia_block_of(const struct Inertia *inertia, size_t coordinate);

/* True if the block is positive definite and its pattern is the whole triangle. */
bool block_is_full(const struct InertiaBlock *block);
