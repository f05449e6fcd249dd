/* Interfaces between the files of Radau IIA, and for the choice of the method (auto.c). */
#pragma once

#include "instance/solver.h"
#include "support/arena.h"

/* Most stages of a method, and most linear systems: one real, and one for each conjugate pair. */
enum { STAGE_LIMIT = 7, SYSTEM_LIMIT = (STAGE_LIMIT + 1) / 2 };

/*
 * A method with an odd number of stages s. A^-1 has one real eigenvalue and (s - 1) / 2 conjugate pairs; index 0 is the
 * real one, and one of each pair follows.
 */
struct RadauMethod {
  int stages;
  double node[STAGE_LIMIT];
  double weight[STAGE_LIMIT]; /* 1 over the product of the node and its distances from the others */
  double value_real[SYSTEM_LIMIT], value_imaginary[SYSTEM_LIMIT];
  double vector_real[STAGE_LIMIT][SYSTEM_LIMIT], vector_imaginary[STAGE_LIMIT][SYSTEM_LIMIT];
  double back_real[SYSTEM_LIMIT][STAGE_LIMIT], back_imaginary[SYSTEM_LIMIT][STAGE_LIMIT]; /* rows of V^-1 */
  double error[STAGE_LIMIT]; /* weights of the stages in the error estimate */
};

/* A complex number: the operations of C's complex type may need functions of the compiler's library. */
struct Complex {
  double real, imaginary;
};

/*
 * The linear systems (mu - J) x = r of a step, with mu = eigenvalue / step and J = d f / d state. As q' = v, the
 * unknowns dv = mu dq - r_q are eliminated. The remaining systems have rows for q and for the other states z, which
 * follow the velocities:
 *
 *     (mu^2 - mu D - K) dq -        E  dz = r_v + (mu - D) r_q        K, D, E: of the accelerations by q, v, z
 *        -(mu G + F)    dq + (mu - H) dz = r_z -       G  r_q         F, G, H: of the rates by q, v, z
 */
struct RadauSystems {
  double *values;                        /* elements of J, in the order of lagrangian.implicit.pattern */
  size_t *slot, *diagonal;               /* offsets in the matrices: of J's elements in this order, of the diagonal */
  struct Complex mu[SYSTEM_LIMIT];       /* the first one and its matrix are real */
  double *factors[SYSTEM_LIMIT];         /* factored by lagrangian.implicit.lu */
  struct Complex *right_side, *solution; /* states each: workspace */
  double *work;                          /* workspace of lagrangian.implicit.lu */
};

/* Takes all arrays but values; then finds the offsets of J's elements in the matrices. */
void radau_systems_take(struct RadauSystems *systems, struct Arena *arena);
void radau_systems_find_slots(struct RadauSystems *systems);

/*
 * Evaluates the Jacobian, with 0 for elements that are not finite, as at a root of 0: the iterations need an
 * approximation only. False if it does not exist.
 */
bool radau_systems_evaluate(struct Instance *instance, struct RadauSystems *systems, double time, const double *state);

/* Factors the systems of the method for a step. False if one is singular. */
bool radau_systems_factor(struct RadauSystems *systems, const struct RadauMethod *method, double step);

/* Solves system j for systems->right_side, which is overwritten; the solution is in systems->solution. */
void radau_systems_solve(struct RadauSystems *systems, int j);

/* Return, for auto.c, the proposed step in s, the stages for the tolerance, and the Jacobian of the last step. */
double radau_next_step(const struct Instance *instance);
int radau_stage_count(const struct Instance *instance);
const double *radau_jacobian(const struct Instance *instance);

/* Sets the first step after a restart, in s; 0 to derive it from the motion. */
void radau_try_first(struct Instance *instance, double step);

/* Returns the relative tolerance of one step. */
double radau_tolerance(const struct Instance *instance);
