/* C for the accelerations: straight lines for small blocks of the mass matrix, a factorization for large ones. */
#ifndef EMIT_ACCELERATIONS_H
#define EMIT_ACCELERATIONS_H

#include <stdint.h>

#include "write/emitter.h"

#define NOWHERE SIZE_MAX

/* Whether the pivot depends on parameters alone, so that prepare() checks it. */
bool pivot_is_prepared(const struct Graph *graph, const struct Pivot *pivot);

/* What must be computed before the accelerations are known: themselves, or M and the right side of large blocks. */
struct NodeList acceleration_targets(const struct Emitter *emitter);

/* Returns from the generated function where the pivot is no larger than a rounding error. */
void emit_pivot_check(const struct Emitter *emitter, const struct Pivot *pivot);

/* The accelerations into target[0..n-1], with all checks. */
void emit_accelerations(struct Emitter *emitter, const char *target);

/*
 * Solves the large blocks once more, for right sides in nodes[coordinate * stride], into target: that of coordinate i
 * to target[place[i]], and blocks whose places are NOWHERE not at all; to target[i] where place is NULL. number keeps
 * local names apart.
 */
void emit_along_blocks(struct Emitter *emitter, const Node *nodes, size_t stride, const char *target,
                       const size_t *place, size_t number);

#endif
