/*
 * The kinematic tree of the bodies in frames. Each link moves relative to its parent, by coordinates of its own. If
 * coordinates move such links only, their part of the mass matrix need not be formed, see articulated.h.
 */
#pragma once

#include "mechanics/mass_matrix/constraint_block.h"
#include "mechanics/mass_matrix/spatial.h"

/* A link of the tree. Its parent has a smaller index. */
struct TreeLink {
  size_t parent;    /* index of an earlier link; NO_LINK for the base */
  size_t tree;      /* number of its tree; NO_TREE if nothing moves it, or its coordinates belong to no tree */
  struct Pose pose; /* relative to its parent */
  size_t count;     /* number of its rows: coordinates, then constraints of only these */
  size_t *coordinates;
  struct SpatialVector
      *motion_subspace; /* motion subspace: relative velocity at unit rate, for each row; 0 for a constraint */
  Node *inertia;        /* elements of K in its rows besides bodies, such as armatures and constraints: count x count */
  bool has_inertia;     /* some of these are nonzero */
  struct SpatialInertia bodies; /* bodies that are fixed to it */
};

#define NO_LINK ((size_t)-1)

/* Links of no tree have no axes and inertias. */
struct KinematicTrees {
  struct TreeLink *items;
  size_t count;
  size_t *tree_of; /* [rows of K]: number of the tree; NO_TREE for none */
};

/*
 * Finds the kinematic trees of a model: those that are deep enough for articulated inertias to pay, and whose
 * constraints stay within single links. regularization is energy_of_regularization().
 */
struct KinematicTrees *kinematic_trees_create(const struct Model *model, const struct ConstraintBlock *constraint_block,
                                              Node regularization);

/* Returns links without trees, for this number of rows. */
struct KinematicTrees *no_kinematic_trees(size_t row_count);
