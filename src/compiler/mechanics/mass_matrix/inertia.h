/*
 * The mass matrix M = d2L/dv dv, bordered by the constraints' Jacobian matrix J where there are some: K = (M J^T; J 0).
 * It is sparse, in blocks that are independent of each other, each with its factors L D L^T or the pattern of them. Its
 * rows are the coordinates, then the constraints.
 */
#pragma once

#include "mechanics/mass_matrix/articulated.h"

/* Where M loses its rank: it must hold that pivot > 0 and that it has not vanished against its scale. */
struct Pivot {
  Node value;    /* D_i of M = L D L^T */
  Node diagonal; /* M_ii */
  Node scale;    /* the magnitude of the terms of M_ii, with |sin| and |cos| taken as 1 */
  size_t coordinate;
};

/*
 * Rows that K couples, directly or by way of others. Elements are kept in the pattern of L, by rows of its lower
 * triangle, columns ascending and the diagonal last: row i has elements start[i] .. start[i + 1] - 1. Rows and columns
 * are places in coordinates.
 */
struct InertiaBlock {
  size_t count;
  size_t constraint_count; /* of its rows; each of them is eliminated after its coordinates */
  size_t *coordinates;     /* its rows in the order of elimination */
  bool is_unrolled;        /* solved symbolically, as straight-line code; others by ldlt.h at run time */
  size_t *start, *column;
  Node *mass; /* the elements of K; ZERO where L fills in */
  /* Of the forces that others follow from: how many, the row of each, and the columns that they add to K, see oblique.h. */
  size_t force_count, *forces;
  Node *oblique;
  Node *factor; /* of unrolled blocks: the elements of L, and those of D on the diagonal; NULL in others */
  /* In place of elements and factors, of which it has none; NULL for those. Its rows are the coordinates, ascending. */
  const struct ArticulatedTree *tree;
};

struct Inertia {
  size_t count;            /* rows: coordinates and constraints */
  size_t coordinate_count; /* of them */
  struct InertiaBlock *blocks;
  size_t block_count;
  size_t *block_of, *place_of; /* of each row */
  struct Pivot *pivots;        /* of the unrolled blocks */
  size_t pivot_count;
};

/* The same matrix with each symbol s replaced by replacements[s], its factors and pivots too. */
struct Inertia *inertia_substitute(struct Graph *graph, const struct Inertia *inertia, const Node *replacements);

/* Solves M solution = right_side for the unrolled blocks; other elements become ZERO. Both may be the same array. */
void inertia_solve(struct Graph *graph, const struct Inertia *inertia, const Node *right_side, Node *solution);

/* Factors a block that has no factors yet. */
void block_factor(struct Graph *graph, struct InertiaBlock *block);

/* Solves for the coordinates of one unrolled block, in their order of elimination, in place. */
void block_solve(struct Graph *graph, const struct InertiaBlock *block, Node *x);

/* sum += K vector */
void inertia_add_product(struct Graph *graph, const struct Inertia *inertia, const Node *vector, Node *sum);

/* Where the block of i and j keeps an element, in its mass; the end of that where it is not in the pattern. */
size_t inertia_find(const struct Inertia *inertia, size_t i, size_t j);

/* K_ij, which is not known in trees: ZERO. */
Node inertia_element(const struct Inertia *inertia, size_t i, size_t j);

/* Whether some block is a tree; false for NULL, of systems without coordinates. */
bool inertia_has_trees(const struct Inertia *inertia);

/* The block that a row belongs to. */
const struct InertiaBlock *inertia_block_of(const struct Inertia *inertia, size_t coordinate);

/* Whether the pattern of the block is the whole triangle, and its matrix positive definite. */
bool block_is_full(const struct InertiaBlock *block);
