/* The elements of the mass matrix, as expressions, and which coordinates they couple. */
#pragma once

#include "mechanics/mass_matrix/elimination.h"
#include "model/model.h"

/* Elements of M on and below the diagonal, in no particular order. */
struct Elements {
  struct Position *positions; /* coordinates */
  Node *nodes;
  size_t count;
};

/* Of no tree, by number: see links.h. */
#define NO_TREE ((size_t)-1)

/* From the momenta dL/dv of the coordinates that belong to no tree; none is ZERO. */
struct Elements elements_of(const struct Model *model, const Node *momentum, const size_t *tree_of);

/* Appends an element; none at its position may be there. */
void elements_append(struct Elements *elements, size_t row, size_t column, Node node);

/* Coordinates that are coupled, directly or by way of others, are of one component, numbered by their first ones. */
struct Components {
  size_t *of; /* each coordinate */
  size_t count;
};

/* count: coordinates. */
struct Components find_components(size_t count, const struct Elements *elements);

/* Sorts the elements by components. Returns where each component begins, and the end. */
size_t *sort_by_components(struct Elements *elements, const struct Components *components);
