/* Configurations that fulfil the constraints, at the start and near it, with the values of all nodes. */
#pragma once

#include "algebra/node_list.h"
#include "model/model.h"

/* The constraints g(q) = 0, their derivatives by each coordinate, and the nodes to evaluate. */
struct Configurations {
  const struct Model *model;
  Node *level, **slope;
  size_t count;
  Node *part; /* nodes to evaluate, ascending; NULL: all */
  size_t part_count;
};

/*
 * Prepares the evaluation of the wanted nodes (NULL: all). Systems with very many coordinates count as unconstrained.
 */
struct Configurations configurations_of(const struct Model *model, const struct NodeList *wanted);

/*
 * Returns the values of the nodes, indexed by node, at the start configuration plus offsets (NULL: none). The
 * configuration is projected onto the constraints by the least change of the coordinates. Returns NULL if the
 * projection fails.
 */
double *values_at(const struct Configurations *configurations, const double *offsets);

/* True if the constraint restricts positions at all times, unlike those of contacts and frictions. */
bool holds_positions(const struct Model *model, size_t constraint);
