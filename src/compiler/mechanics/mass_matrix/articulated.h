/*
 * Solves M a = b for a kinematic tree by articulated-body inertias, without forming M (R. Featherstone: Rigid Body
 * Dynamics Algorithms, 2008, section 7.3).
 *
 * For each link with the motion subspace S, from the outermost to the base: its articulated inertia I is that of
 * its bodies and of its children. Then U = I S, and D = S^T U plus the inertia of the coordinates themselves. I - U
 * D^-1 U^T goes to the parent. The forces p follow likewise: u = b - S^T p, and p + U D^-1 u goes to the parent.
 * From the base outwards, a = D^-1 u - D^-1 U^T (acceleration of the parent). The D are the pivots of an L D L^T
 * factorization of M, positive if M is positive definite. Each pass visits each link once: the cost is proportional
 * to the number of links. Constraints within a link are further rows of D, with S = 0.
 */
#pragma once

#include "mechanics/mass_matrix/symbolic_factors.h"
#include "mechanics/mass_matrix/kinematic_trees.h"

/* A link with its factors. */
struct ArticulatedLink {
  const struct TreeLink *link;
  size_t parent; /* index among the tree's links; NO_LINK if the tree does not move the parent */
  size_t *rows;  /* of each of its rows, the index among the rows of the tree */
  struct FactorPattern pattern;
  Node *mass, *factor;        /* D and its factors, in the pattern of a full matrix */
  Node *scale;                /* of each coordinate: a bound of its diagonal element of M */
  struct SpatialVector *gain; /* of each row: a column of U D^-1 */
};

/* A kinematic tree with its factors. Each link follows its parent. */
struct ArticulatedTree {
  struct ArticulatedLink *items;
  size_t count;
  size_t row_count;
};

/*
 * Returns the tree of links with this number; coordinates are its row_count rows. Returns NULL if a constant is not
 * finite, as of a link whose motion has no inertia.
 */
struct ArticulatedTree *articulated_create(struct Graph *graph, const struct KinematicTrees *trees, size_t tree,
                                           const size_t *coordinates, size_t row_count);

/* Returns the pivot of a row. */
Node articulated_pivot(const struct ArticulatedTree *tree, size_t row);

/* Solves M x = b in place. */
void articulated_solve(struct Graph *graph, const struct ArticulatedTree *tree, Node *x);

/* Adds M x to sum. */
void articulated_add_product(struct Graph *graph, const struct ArticulatedTree *tree, const Node *x, Node *sum);
