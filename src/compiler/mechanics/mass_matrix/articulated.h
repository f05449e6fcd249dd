/*
 * M a = b of a kinematic tree without M, by articulated inertias (Featherstone, Rigid Body Dynamics Algorithms, 2008,
 * section 7.3): from the last links to the first, each hands on the inertia that its coordinates leave, and its force;
 * then accelerations follow from the first to the last. The cost grows with the number of links.
 */
#pragma once

#include "mechanics/mass_matrix/factors.h"
#include "mechanics/mass_matrix/links.h"

/* A link with what is left of the inertia behind it. */
struct ArticulatedLink {
  const struct Link *link;
  size_t parent; /* among the tree's; NO_LINK for what the tree does not move */
  size_t *rows;  /* of its coordinates among those of the tree */
  struct FactorPattern pattern;
  Node *mass, *factor;        /* of its coordinates, in the pattern of a full matrix */
  Node *scale;                /* of each coordinate: its element of M on the diagonal is no larger */
  struct SpatialVector *gain; /* of each coordinate: forces = gain times what pushes along it */
};

struct ArticulatedTree {
  struct ArticulatedLink *items;
  size_t count;
  size_t row_count;
};

/*
 * Of the links that the tree moves; coordinates: row_count of them, in the order of its rows. NULL where one of them moves
 * nothing that has inertia.
 */
struct ArticulatedTree *articulated_create(struct Graph *graph, const struct Links *links, size_t tree,
                                           const size_t *coordinates, size_t row_count);

/* The element of D of a row. */
Node articulated_pivot(const struct ArticulatedTree *tree, size_t row);

/* Solves M x = b in place. */
void articulated_solve(struct Graph *graph, const struct ArticulatedTree *tree, Node *x);

/* sum += M x */
void articulated_add_product(struct Graph *graph, const struct ArticulatedTree *tree, const Node *x, Node *sum);
