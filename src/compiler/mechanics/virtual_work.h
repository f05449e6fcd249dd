/* The principle of virtual work: a force F along what moves, r, acts with F dr/ds along s. */
#pragma once

#include "algebra/graph.h"

/* What moves, positions or velocities, and the force along each. */
struct VirtualWork {
  Node *moved, *forces;
  size_t count;
};

/* Nothing where one of them is ZERO. */
void virtual_work_add(struct VirtualWork *work, Node moved, Node force);

/* The forces along all symbols of the kind. */
Node *virtual_work_along(struct Graph *graph, const struct VirtualWork *work, enum SymbolKind kind, size_t count);

/* Adds the forces along rates, each of which follows the symbol that it is the rate of, to those along the symbols. */
void virtual_work_add_along_rates(struct Graph *graph, const struct VirtualWork *work, enum SymbolKind kind,
                                  size_t count, Node *forces);
