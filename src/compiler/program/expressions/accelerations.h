/* The accelerations as instructions: pivots are checked, and large blocks of M are factored at run time. */
#pragma once

#include "mechanics/equations.h"
#include "program/values/values.h"

/* A block of M that is factored at run time, and its part of the spaces for masses and right sides. */
struct LoopedBlock {
  const struct InertiaBlock *block;
  size_t first_mass, first_side;
  size_t mass_count; /* numbers of its part of the masses */
};

struct LoopedBlocks {
  struct LoopedBlock *items;
  size_t count;
  size_t mass_count, side_count; /* of all blocks together */
};

struct LoopedBlocks looped_blocks_of(const struct Equations *equations);

/* The elements of K in a block. */
void append_elements(struct NodeList *targets, const struct InertiaBlock *block);

/* All nodes that the accelerations rest on, and the forces of constraints where asked for. */
struct NodeList accelerations_targets(const struct Graph *graph, const struct Equations *equations, bool with_forces);

/* Whether the pivot depends on parameters alone, so that it is checked when they change. */
bool pivot_is_prepared(const struct Graph *graph, const struct Pivot *pivot);

/* Returns from the routine where the pivot, which is computed, has vanished. */
void append_pivot_check(struct Values *values, const struct Pivot *pivot);

/*
 * Computes the accelerations and copies them to their space, and the least forces of constraints with them where asked for;
 * the factors of large blocks stay in theirs.
 */
void append_accelerations(struct Values *values, const struct Equations *equations, const struct LoopedBlocks *blocks,
                          bool with_forces);

/*
 * Names what append_solution() has left in the right sides of large blocks: symbol holds a node for each row. The next
 * solution takes its place.
 */
void hold_solutions(struct Values *values, const struct LoopedBlocks *blocks, const Node *symbol);

/*
 * Does the same of the unknowns, whose symbols are given, behind append_accelerations(), where the rates of states use them: forces of
 * constraints are those of least norm.
 */
void hold_unknowns(struct Values *values, const struct Equations *equations, const struct LoopedBlocks *blocks,
                   const Node *symbol);

/* The elements of a large block, which are computed, to their space. */
void append_masses(struct Values *values, const struct LoopedBlock *looped);

/* Factors a large block, whose elements are in their space. */
void append_factor(struct Values *values, const struct LoopedBlocks *blocks, size_t block);

/* Leaves the factors of large blocks in their space, where the accelerations themselves are not needed. */
void append_factors(struct Values *values, const struct LoopedBlocks *blocks);

/* Solves a large block, whose factors are there; side: for each row of the system, computed. The solution is in its right side. */
void append_solution(struct Values *values, const struct LoopedBlocks *blocks, size_t number, const Node *side);
