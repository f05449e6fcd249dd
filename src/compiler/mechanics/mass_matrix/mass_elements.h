/* The elements of the mass matrix, and the components of coordinates that they couple. */
#pragma once

#include "mechanics/mass_matrix/elimination.h"
#include "model/model.h"

/* Elements of a sparse matrix in no particular order; those of M are on and below the diagonal. */
struct Elements {
  struct Position *positions; /* rows and columns */
  Node *nodes;
  size_t count;
};

/* Number of no tree, see kinematic_trees.h. */
#define NO_TREE ((size_t)-1)

/* Returns M from the momenta dL/dv, for coordinates that belong to no tree. Elements that vanish are left out. */
struct Elements elements_of(const struct Model *model, const Node *momentum, const size_t *tree_of);

/* Appends an element; its position must be new. */
void elements_append(struct Elements *elements, size_t row, size_t column, Node node);

/* Connected components: coordinates that are coupled, directly or through others; numbered by their first ones. */
struct ConnectedComponents {
  size_t *of; /* [coordinates] */
  size_t count;
};

/* Finds the components of count coordinates, by union-find. */
struct ConnectedComponents find_components(size_t count, const struct Elements *elements);

/* Sorts the elements by components. Returns the start of each component, and the end. */
size_t *sort_by_components(struct Elements *elements, const struct ConnectedComponents *components);
