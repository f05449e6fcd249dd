/*
 * The kinematic tree of the bodies in frames: each link moves against the one before it by coordinates of its own. Where
 * all bodies that coordinates move are such links, the mass matrix need not be formed: see articulated.h.
 */
#pragma once

#include "mechanics/mass_matrix/border.h"
#include "mechanics/mass_matrix/spatial.h"

struct Link {
  size_t parent;    /* among the links before it; NO_LINK for the base */
  size_t tree;      /* what moves it; NO_TREE where that is none, or is for other ways */
  struct Pose pose; /* in its parent */
  size_t count;     /* of its rows: its coordinates, and then constraints that hold these alone */
  size_t *coordinates;
  struct SpatialVector *axes; /* of each row: the motion against the parent at a velocity of 1, none of a constraint */
  Node *inertia;              /* what K has in its rows beside bodies, as of armatures and constraints: count x count */
  bool has_inertia;           /* not all of these are ZERO */
  struct SpatialInertia bodies; /* of those that are fixed to it */
};

#define NO_LINK ((size_t)-1)

/* Only what belongs to trees has its axes and inertias. */
struct Links {
  struct Link *items;
  size_t count;
  size_t *tree_of; /* of each row of K: the number of its tree; NO_TREE for none */
};

/*
 * The trees of a model are those that are deep enough for articulated inertias to pay, and that no constraint holds beyond one
 * link. stillness: energy_of_stillness().
 */
struct Links *links_create(const struct Model *model, const struct Border *border, Node stillness);

/* None, for so many rows. */
struct Links *links_without_trees(size_t row_count);
