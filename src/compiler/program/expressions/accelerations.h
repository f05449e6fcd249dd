/* Code for the accelerations: checks of the pivots, and blocks of the mass matrix that are factored at run time. */
#pragma once

#include "mechanics/equations.h"
#include "program/codegen/code_generator.h"

/* A block of K that is factored at run time, and its ranges in SPACE_MASS and SPACE_RIGHT_SIDE. */
struct LoopedBlock {
  const struct InertiaBlock *block;
  size_t first_mass, first_right_side;
  size_t mass_count;                  /* length of its range in SPACE_MASS */
  size_t *columns, column_count;      /* column[] of ldlt.h or saddle.h */
  size_t *places, place_count, given; /* of the elements of K: their places among those of L; first one in SPACE_MASS */
};

/* The blocks of K that are factored at run time. */
struct LoopedBlocks {
  struct LoopedBlock *items;
  size_t count;
  size_t mass_count, right_side_count; /* lengths of both spaces, for all blocks */
};

/* Returns the blocks that are factored at run time; none for explicit accelerations. */
struct LoopedBlocks looped_blocks_of(const struct Equations *equations);

/* Appends the elements of the block in K, and its nonsymmetric columns. */
void append_elements(struct NodeList *targets, const struct InertiaBlock *block);

/* Returns all nodes that the accelerations need, and those of the constraint forces if with_forces. */
struct NodeList accelerations_targets(const struct Graph *graph, const struct Equations *equations, bool with_forces);

/* True if the pivot is constant in time, so that prepare() checks it when parameters change. */
bool pivot_is_parameter_constants(const struct Graph *graph, const struct Pivot *pivot);

/* Appends the check that makes the function return an error where the pivot vanishes; the pivot must be computed. */
void append_pivot_check(struct CodeGenerator *generator, const struct Pivot *pivot);

/*
 * Computes the accelerations into SPACE_ACCELERATION, and the constraint forces of least norm if with_forces. The
 * factors of the blocks stay in SPACE_MASS.
 */
void append_accelerations(struct CodeGenerator *generator, const struct Equations *equations,
                          const struct LoopedBlocks *blocks, bool with_forces);

/* Declares the solution of append_solution() as the value of each row's symbol, until the next solution. */
void define_solutions(struct CodeGenerator *generator, const struct LoopedBlocks *blocks, const Node *symbol);

/*
 * Does the same after append_accelerations() for the unknowns, if rates of first-order states depend on them;
 * constraint forces become those of least norm.
 */
void define_unknowns(struct CodeGenerator *generator, const struct Equations *equations,
                     const struct LoopedBlocks *blocks, const Node *symbol);

/* Returns where K_ii of a row of the block is before the factorization. */
Slot slot_of_diagonal(const struct LoopedBlock *looped, size_t row);

/* Returns the first element of the block's nonsymmetric columns in SPACE_MASS. */
size_t first_nonsymmetric(const struct LoopedBlock *looped);

/* Copies the elements of the block, which must be computed, to SPACE_MASS. */
void append_masses(struct CodeGenerator *generator, const struct LoopedBlock *looped);

/* Returns the arithmetic operations of one factorization and one solution of the block. */
size_t block_operations(const struct InertiaBlock *block);

/* Appends the factorization of the block, whose elements must be in SPACE_MASS. */
void append_factor(struct CodeGenerator *generator, const struct LoopedBlocks *blocks, size_t block);

/* Computes and factors all blocks, if the accelerations themselves are not needed. */
void append_factors(struct CodeGenerator *generator, const struct LoopedBlocks *blocks);

/* Solves a factored block in place of its right side. right_side: a computed node for each row of K. */
void append_solution(struct CodeGenerator *generator, const struct LoopedBlocks *blocks, size_t number,
                     const Node *right_side);
