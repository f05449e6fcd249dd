/*
 * Finds rods and joints by sampling instead of symbolic proofs. At samples.count configurations that need not fulfil
 * the constraints g(q) = 0, a rod between two objects at distance d is an identity
 *
 *     d(q)^p = l^p + sum over k of mu_k g_k(q),   p = 2 or 1,
 *
 * for all q: on the constraints, the distance is l. Likewise, a joint is a point that is fixed both to a planar body
 * and to another object, up to multiples of the constraints. Both tests are linear in their unknowns. With about twice
 * as many equations, a residual of 0 to nine digits at unrelated q accepts the identity, as in probabilistic identity
 * tests (J. T. Schwartz: Fast probabilistic algorithms for verification of polynomial identities, Journal of the ACM
 * 27, 1980). Costs O(c^3) for each pair of objects with c constraints; large systems test neighbours only.
 */
#include "connections.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "least_squares.h"

/* above this, objects are compared with the base and their neighbours only, since pairs grow quadratically */
enum { MOST_OBJECTS = 60 };

/* Coefficients of constraints below NO_FORCE are rounding errors; rods shorter than NO_LENGTH, in m, are not drawn. */
static const double NO_FORCE = 1e-6, NO_LENGTH = 1e-9;

static double distance(const struct SampledPositions *samples, size_t sample, size_t first, size_t second) {
  const double *values = samples->values[sample];
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double way = values[samples->objects[second].position[axis]] - values[samples->objects[first].position[axis]];
    sum += way * way;
  }
  return sqrt(sum);
}

static double constraint_value(const struct SampledPositions *samples, size_t sample, size_t k) {
  return samples->values[sample][samples->model->constraints.items[samples->constraints[k]].node];
}

static bool moves(const struct SampledPositions *samples, size_t object) {
  for (int axis = 0; axis < 3; axis++)
    if (samples->values[1][samples->objects[object].position[axis]] !=
        samples->values[0][samples->objects[object].position[axis]])
      return true;
  return false;
}

/*
 * True if the constraint is the norm of a quaternion, which scales all distances in a body but has no force along any.
 */
static bool is_norm(const struct Model *model, size_t constraint) {
  for (size_t i = 0; i < model->mechanism.regularization_count; i++)
    if (model->mechanism.regularizations[i].constraint == model->constraints.items[constraint].node) return true;
  return false;
}

/* True if distance^power is a constant plus multiples of constraints. */
static bool is_rod(const struct SampledPositions *samples, int power, struct Rod *rod) {
  size_t columns = 1 + samples->constraint_count;
  struct LeastSquares system = least_squares_create(samples->count, columns);
  double *solution = allocate(columns, sizeof *solution);
  for (size_t k = 0; k < samples->count; k++) {
    double *row = least_squares_row(&system, k);
    row[0] = 1.0;
    for (size_t c = 0; c < samples->constraint_count; c++) row[1 + c] = constraint_value(samples, k, c);
    row[columns] = pow(distance(samples, k, rod->from, rod->to), power);
  }
  if (!least_squares_solve(&system, 1, solution)) return false;
  rod->length = pow(fmax(solution[0], 0.0), 1.0 / power);
  size_t forces = 0;
  for (size_t c = 0; c < samples->constraint_count; c++) {
    if (fabs(solution[1 + c]) < NO_FORCE) continue;
    forces++;
    rod->constraint = samples->constraints[c];
    rod->factor = -(power == 1 ? 1.0 : 2.0 * rod->length) / solution[1 + c];
  }
  rod->has_force = forces == 1 && !is_norm(samples->model, rod->constraint);
  return true;
}

static int by_length(const void *first, const void *second) {
  const struct Rod *a = first, *b = second;
  if (fabs(a->length - b->length) > 1e-9 * b->length) return a->length < b->length ? -1 : 1;
  if (a->from != b->from) return a->from < b->from ? -1 : 1;
  return a->to < b->to ? -1 : a->to > b->to;
}

static size_t group_of(const size_t *groups, size_t object) {
  while (groups[object] != object) object = groups[object];
  return object;
}

/*
 * Keeps the shortest rods that connect everything (a minimum spanning forest by Kruskal's algorithm), and all rods of
 * constraints; removes those of length 0.
 */
static void keep_shortest(struct Connections *connections, size_t object_count) {
  size_t *groups = allocate(object_count, sizeof *groups), kept = 0;
  for (size_t i = 0; i < object_count; i++) groups[i] = i;
  if (connections->rod_count > 0)
    qsort(connections->rods, connections->rod_count, sizeof *connections->rods, by_length);
  for (size_t i = 0; i < connections->rod_count; i++) {
    size_t from = group_of(groups, connections->rods[i].from), to = group_of(groups, connections->rods[i].to);
    if (from == to && !connections->rods[i].has_force) continue;
    groups[to] = from;
    if (!(connections->rods[i].length > NO_LENGTH)) continue;
    connections->rods[kept++] = connections->rods[i];
  }
  connections->rod_count = kept;
}

static void try_rod(struct Connections *connections, const struct SampledPositions *samples, size_t from, size_t to) {
  struct Rod rod = {.from = from, .to = to};
  if (!moves(samples, from) && !moves(samples, to)) return;
  if (!is_rod(samples, 2, &rod) && !is_rod(samples, 1, &rod)) return;
  APPEND(connections->rods, connections->rod_count, rod);
}

/*
 * Fills the equations of a joint. Unknowns: its position on each of the two objects, then the coefficients of the
 * constraints along x and y.
 */
static void fill_joint(const struct SampledPositions *samples, const struct SceneJoint *joint,
                       struct LeastSquares *system) {
  for (size_t k = 0; k < samples->count; k++)
    for (int axis = 0; axis < 2; axis++) {
      double *row = least_squares_row(system, 2 * k + (size_t)axis);
      const double *values = samples->values[k];
      const size_t pair[2] = {joint->of, joint->with};
      for (int side = 0; side < 2; side++) {
        const struct SceneObject *object = &samples->objects[pair[side]];
        double sign = side == 0 ? 1.0 : -1.0, angle = object->is_planar ? values[object->angle] : 0.0;
        row[2 * side] = sign * (axis == 0 ? cos(angle) : sin(angle));
        row[2 * side + 1] = sign * (axis == 0 ? -sin(angle) : cos(angle));
        row[system->columns] -= sign * values[object->position[axis]];
      }
      for (size_t c = 0; c < samples->constraint_count; c++)
        row[4 + 2 * c + (size_t)axis] = constraint_value(samples, k, c);
    }
}

/*
 * With r + A c = 0 for the distance r of both points and two constraints c, constraint forces l do the work l^T A^-1
 * dr, so that the force on the first object is F = A^-T l. Forces are found for exactly two constraints only.
 */
static void set_forces(const struct SampledPositions *samples, const double *multiples, struct SceneJoint *joint) {
  double a[FORCES][2] = {{0}};
  size_t count = 0;
  for (size_t c = 0; c < samples->constraint_count; c++) {
    if (fabs(multiples[2 * c]) < NO_FORCE && fabs(multiples[2 * c + 1]) < NO_FORCE) continue;
    if (count == FORCES) return;
    joint->constraints[count] = samples->constraints[c];
    a[count][0] = multiples[2 * c];
    a[count++][1] = multiples[2 * c + 1];
  }
  double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  if (count != FORCES || fabs(determinant) < NO_FORCE) return;
  joint->force_count = FORCES;
  joint->along[0][0] = a[1][1] / determinant;
  joint->along[0][1] = -a[1][0] / determinant;
  joint->along[1][0] = -a[0][1] / determinant;
  joint->along[1][1] = a[0][0] / determinant;
}

bool find_joint(const struct SampledPositions *samples, struct SceneJoint *joint) {
  size_t columns = 4 + 2 * samples->constraint_count;
  struct LeastSquares system = least_squares_create(2 * samples->count, columns);
  double *solution = allocate(columns, sizeof *solution);
  fill_joint(samples, joint, &system);
  if (!least_squares_solve(&system, JOINT_COORDINATES, solution)) return false;
  for (int i = 0; i < JOINT_COORDINATES; i++) joint->coordinates[i] = solution[i];
  bool is_loose =
      joint->with != 0 && !samples->objects[joint->with].is_planar && hypot(solution[2], solution[3]) > 1e-9;
  if (is_loose) return false; /* a particle has no other points */
  set_forces(samples, solution + JOINT_COORDINATES, joint);
  return true;
}

static void try_joint(struct Connections *connections, const struct SampledPositions *samples, size_t of, size_t with) {
  struct SceneJoint joint = {.of = of, .with = with};
  if (!find_joint(samples, &joint)) return;
  APPEND(connections->joints, connections->joint_count, joint);
}

/* True if the pair is tested. Objects in a frame are connected only with that. */
static bool are_compared(const struct SampledPositions *samples, size_t first, size_t second) {
  const struct SceneObject *a = &samples->objects[first], *b = &samples->objects[second];
  if (a->frame != 0 || b->frame != 0) return b->frame == first || (a->frame == second && second != 0);
  return samples->object_count <= MOST_OBJECTS || first == 0 || second == first + 1;
}

struct Connections find_connections(const struct SampledPositions *samples) {
  struct Connections connections = {.rod_count = 0};
  for (size_t i = 0; i < samples->object_count; i++)
    for (size_t j = i + 1; j < samples->object_count; j++) {
      if (!are_compared(samples, i, j)) continue;
      bool is_planar = samples->objects[i].is_planar || samples->objects[j].is_planar;
      if (samples->objects[j].is_planar) try_joint(&connections, samples, j, i);
      else if (samples->objects[i].is_planar) try_joint(&connections, samples, i, j);
      if (!is_planar) try_rod(&connections, samples, i, j);
    }
  keep_shortest(&connections, samples->object_count);
  return connections;
}
