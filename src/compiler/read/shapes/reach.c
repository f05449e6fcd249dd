/*
 * Shapes out of each other's reach have no contact points to look for. A ball about each shape decides that: a mode says
 * whether the balls overlap, and the branches of the contact matter only while they do. The mode switches at an event as
 * any other one. So no contact is missed, and the points of distant shapes are not computed. (C. Ericson, Real-Time
 * Collision Detection, 2005, section 4.3.) In model exchange shapes always are in reach: see mode_of_importer().
 */
#include "read/shapes/reach.h"

#include <math.h>

#include "algebra/simplify.h"
#include "model/switches.h"
#include "names/piecewise_functions.h"
#include "read/shapes/plane_points.h"

/* Balls are larger than their shapes by this factor, so that they overlap before the shapes touch. */
static const double enlargement = 1.1;

/* Shapes with fewer points on a plane cost as much as a ball. */
enum { LEAST_POINTS = 4 };

/* A ball about a shape. Its centre is along the base's axes. */
struct Ball {
  struct Vector centre;
  Node radius;
};

static Node length_of_sides(struct Graph *graph, Node one, Node other) {
  Node squares = add(graph, power_number(graph, one, 2.0), power_number(graph, other, 2.0));
  return power_number(graph, squares, 0.5);
}

/* Returns the radius of the ball about a shape whose middle is that of the ball. */
static Node radius_about(struct Graph *graph, const struct ContactShape *shape) {
  switch (shape->type) {
  case SHAPE_CAPSULE: return add(graph, scale(graph, 0.5, shape->length), shape->radius);
  case SHAPE_CYLINDER: return length_of_sides(graph, scale(graph, 0.5, shape->length), shape->radius);
  case SHAPE_BOX:
  case SHAPE_ELLIPSOID: return scale(graph, 0.5, power_number(graph, vector_dot(graph, shape->size, shape->size), 0.5));
  default: return shape->radius;
  }
}

/* Returns the ball about the box that holds a mesh. */
static struct Ball ball_about_mesh(const struct ShapePair *pair, const struct ContactSide *side) {
  const struct Mesh *mesh = side->shape->mesh;
  struct Vector middle;
  double squares = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < mesh->corner_count; i++) {
      least = fmin(least, mesh->points[mesh->corners[i]][axis]);
      most = fmax(most, mesh->points[mesh->corners[i]][axis]);
    }
    middle.along[axis] = graph_constant(pair->graph, 0.5 * (least + most));
    squares += 0.25 * (most - least) * (most - least);
  }
  return (struct Ball){vector_add(pair->graph, middle_of(pair, side), rotated_by(pair, side, middle)),
                       graph_constant(pair->graph, sqrt(squares))};
}

static struct Ball ball_about(const struct ShapePair *pair, const struct ContactSide *side) {
  if (side->shape->type == SHAPE_MESH) return ball_about_mesh(pair, side);
  return (struct Ball){middle_of(pair, side), radius_about(pair->graph, side->shape)};
}

/* Returns by how much a ball overlaps a plane, the second shape. */
static Node overlap_with_plane(const struct ShapePair *pair, const struct Ball *ball) {
  struct Graph *graph = pair->graph;
  struct Vector apart = vector_subtract(graph, ball->centre, middle_of(pair, pair->second));
  Node height = vector_dot(graph, axis_of(pair, pair->second), apart);
  return subtract(graph, scale(graph, enlargement, ball->radius), height);
}

/* Returns the square of the reach of two balls, less that of their distance. */
static Node overlap_of_balls(struct Graph *graph, const struct Ball *first, const struct Ball *second) {
  struct Vector apart = vector_subtract(graph, first->centre, second->centre);
  Node reach = scale(graph, enlargement, add(graph, first->radius, second->radius));
  return subtract(graph, power_number(graph, reach, 2.0), vector_dot(graph, apart, apart));
}

/* True if a ball about each shape is cheaper than the contact points, and modes may decide. */
static bool is_worth_a_ball(const struct ShapePair *pair) {
  const struct ContactShape *first = pair->first->shape, *second = pair->second->shape;
  if (pair->is_rigid || pair->scope->switches == NULL) return false;
  if (second->type == SHAPE_PLANE) return count_points_on_plane(first) >= LEAST_POINTS;
  return first->type != SHAPE_SPHERE || second->type != SHAPE_SPHERE;
}

static Node overlap_of(const struct ShapePair *pair) {
  struct Ball ball = ball_about(pair, pair->first);
  if (pair->second->shape->type == SHAPE_PLANE) return overlap_with_plane(pair, &ball);
  struct Ball other = ball_about(pair, pair->second);
  return overlap_of_balls(pair->graph, &ball, &other);
}

Node are_near(const struct ShapePair *pair) {
  struct Graph *graph = pair->graph;
  if (!is_worth_a_ball(pair)) return ONE;
  Node overlap = overlap_of(pair);
  /* A held input may contradict its derivative. The mode would then switch without end (Zeno behaviour). */
  if (graph_depends_on(graph, overlap, INPUT)) return ONE;
  Node importer = mode_of_importer(pair->scope->switches, graph);
  return branch_of(pair->scope, choose_node(graph, importer, ONE, overlap), "the reach of a contact", pair->line);
}
