/*
 * Lagrange's equation, d/dt (dL/dv_i) - dL/dq_i = Q_i, for a general L(q, v, t) = K - U:
 *
 *   M a = Q + dL/dq - (d2L/dv dq) v - d2L/dv dt,     M = d2L/dv dv
 *
 * For the bodies' share of K the left side is the same as d'Alembert's sum m (d2r/dt2) . dr/dq_i. This form is used
 * for it, because the general one makes terms that only cancel each other.
 */
#ifndef LAGRANGE_H
#define LAGRANGE_H

#include "mechanics/model.h"

/* Where M loses its rank: it must hold that pivot > 0 and that it has not vanished against its scale. */
struct Pivot {
  Node value;    /* D_i of M = L D L^T */
  Node diagonal; /* M_ii */
  Node scale;    /* the magnitude of the terms of M_ii, with |sin| and |cos| taken as 1 */
  size_t coordinate;
};

struct Equations {
  size_t count;       /* coordinates */
  bool explicit_form; /* accelerations are given as such (linearised systems), there is no mass matrix */
  Node *mass;         /* count x count, symmetric, both triangles */
  Node *right_side;   /* M a = right_side */
  Node *residual;     /* M a - right_side with the acceleration symbols for a */
  size_t *block;      /* the number of the block of M that a coordinate belongs to, from 0 */
  size_t block_count;
  bool *unrolled;         /* for each block: factored symbolically, as straight-line code */
  Node *lower, *diagonal; /* M = L D L^T of the unrolled blocks; lower is count x count */
  Node *acceleration;     /* expressions in unrolled blocks, the acceleration symbols in others */
  struct Pivot *pivots;
  size_t pivot_count;
  Node power;                     /* of the non-conservative forces: sum Q_i v_i, and F . dr/dt of Cartesian ones */
  Node kinetic, potential, total; /* energies, see energies.h */
};

/*
 * Blocks of M up to this size become straight-line code. Larger ones take fewer operations where their numbers are
 * factored: the Taylor series of a symbolic factorization alone would be longer than all others.
 */
enum { UNROLL_LIMIT = 2 };

/* Derives the equations of motion; reports errors (a coordinate without inertia, ...) to diagnostics. */
struct Equations *equations_derive(struct Model *model, struct Diagnostics *diagnostics);
/* Reports coefficients that are not finite: of sums and products too large for numbers, and of a point at a pole. */
void equations_check_finite(const struct Model *model, const struct Equations *equations,
                            struct Diagnostics *diagnostics);

void equations_free(struct Equations *equations);

/* Whether a block is so large that ldlt_factor() solves it at run time. */
bool block_is_looped(const struct Equations *equations, size_t block);

/* Whether the coordinate belongs to such a block. */
bool is_looped(const struct Equations *equations, size_t coordinate);

/* Whether there is such a block. */
bool has_loops(const struct Equations *equations);

/* Solves M solution = right_side for the unrolled blocks; other elements become ZERO. */
void equations_solve(struct Graph *graph, const struct Equations *equations, const Node *right_side, Node *solution);

#endif
