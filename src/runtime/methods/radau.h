/* What the files of Radau IIA share. */
#ifndef RADAU_H
#define RADAU_H

#include "instance/solver.h"

enum { STAGE_LIMIT = 7, SYSTEM_LIMIT = (STAGE_LIMIT + 1) / 2 };

/*
 * A method of an odd number of stages (E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, sections IV.5
 * and IV.8). The inverse of its matrix A has one real eigenvalue and pairs of complex ones, of which one each is kept.
 */
struct RadauMethod {
  int stages;
  double node[STAGE_LIMIT];
  double weight[STAGE_LIMIT]; /* 1 over the product of the node and of its distances from the others */
  double value_real[SYSTEM_LIMIT], value_imaginary[SYSTEM_LIMIT];
  double vector_real[STAGE_LIMIT][SYSTEM_LIMIT], vector_imaginary[STAGE_LIMIT][SYSTEM_LIMIT];
  double back_real[SYSTEM_LIMIT][STAGE_LIMIT], back_imaginary[SYSTEM_LIMIT][STAGE_LIMIT]; /* the inverse's rows */
  double error[STAGE_LIMIT]; /* weights of the stages in the estimate of the error */
};

/* A complex number; C's own need functions of the compiler's library. */
struct Complex {
  double real, imaginary;
};

/*
 * The linear systems of a step, (mu - J) x = r for the real or complex mu = eigenvalue / step, J = d f / d state. As
 * q' = v, each is one for q and the states z behind the velocities alone, with dv = mu dq - r_q:
 *
 *     (mu^2 - mu D - K) dq -        E  dz = r_v + (mu - D) r_q        K, D, E: of the accelerations by q, v, z
 *        -(mu G + F)    dq + (mu - H) dz = r_z -       G  r_q         F, G, H: of the rates by q, v, z
 */
struct RadauSystems {
  double *values;                        /* of the Jacobian, in the order of lagrangian.implicit.pattern */
  size_t *place, *diagonal;              /* of J's elements in the matrices, in the same order; of the diagonal */
  struct Complex mu[SYSTEM_LIMIT];       /* the first one is real, and so is its matrix */
  double *factors[SYSTEM_LIMIT];         /* by lagrangian.implicit.lu */
  struct Complex *right_side, *solution; /* workspace, states */
  double *work;                          /* for lagrangian.implicit.lu */
};

/* Numbers of memory that radau_systems_place() divides for so many systems, and what it leaves. */
size_t radau_systems_size(void);
void radau_systems_place(struct RadauSystems *systems, double *memory);

/* Evaluates the Jacobian. False where it does not exist. */
bool radau_systems_evaluate(struct Instance *instance, struct RadauSystems *systems, double time, const double *state);

/* Factors the systems of the method for a step. False where one is singular. */
bool radau_systems_factor(struct RadauSystems *systems, const struct RadauMethod *method, double step);

/* Solves system number j for systems->right_side, which is lost; the solution is in systems->solution. */
void radau_systems_solve(struct RadauSystems *systems, int j);

/* For whoever chooses between methods: the stages of a step, the step to come, and the Jacobian at the last one's start. */
double radau_next_step(const struct Instance *instance);
int radau_stage_count(const struct Instance *instance);
const double *radau_jacobian(const struct Instance *instance);

/* The step to try first after a restart; 0 for one that follows from the motion. */
void radau_try_first(struct Instance *instance, double step);

/* The share of the tolerance that a step may err by. */
double radau_tolerance(const struct Instance *instance);

#endif
