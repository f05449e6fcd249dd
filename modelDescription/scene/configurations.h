/* The system where it starts, and where it may be else: values of all nodes, with coordinates that fulfil the constraints. */
#pragma once

#include "algebra/node_list.h"
#include "model/model.h"

/* Constraints g(q) = 0 with their derivatives by each coordinate, and what is evaluated: of large systems a small part. */
struct Configurations {
  const struct Model *model;
  Node *level, **slope;
  size_t count;
  Node *part; /* ascending; NULL for all nodes */
  size_t part_count;
};

/* For values of the wanted nodes, or of all for NULL. Of constraints on many coordinates it takes no notice. */
struct Configurations configurations_of(const struct Model *model, const struct NodeList *wanted);

/*
 * The values of the nodes at the start, by their number in the graph, with the coordinates moved there by offsets (NULL for none) and
 * then back, by as little as it takes, to where the constraints are fulfilled. NULL where that fails.
 */
double *values_at(const struct Configurations *configurations, const double *offsets);

/* Whether the constraint is one of positions that holds at every time: not that of a contact or of friction. */
bool holds_positions(const struct Model *model, size_t constraint);
