/* C for the accelerations: straight lines for small blocks of the mass matrix, a factorization for large ones. */
#ifndef EMIT_ACCELERATIONS_H
#define EMIT_ACCELERATIONS_H

#include "write/emitter.h"

/* Whether the pivot depends on parameters alone, so that prepare() checks it. */
bool pivot_is_prepared(const struct Graph *graph, const struct Pivot *pivot);

/* What must be computed before the accelerations are known: themselves, or M and the right side of large blocks. */
struct NodeList acceleration_targets(const struct Emitter *emitter);

/* Tables of the patterns of blocks that are not full, and how a block is named in calls of ldlt.h; free with free(). */
void emit_patterns(const struct Emitter *emitter);
char *pattern_text(const struct Inertia *inertia, size_t number);

/* Returns from the generated function where the pivot is no larger than a rounding error. */
void emit_pivot_check(const struct Emitter *emitter, const struct Pivot *pivot);

/* The accelerations into target[0..n-1], with all checks. */
void emit_accelerations(struct Emitter *emitter, const char *target);

/*
 * Solves the large blocks once more, for right sides in nodes[coordinate * stride], into target[0..n-1]; number keeps
 * local names apart.
 */
void emit_along_blocks(struct Emitter *emitter, const Node *nodes, size_t stride, const char *target, size_t number);

#endif
