/*
 * Points on planes in closed form. A shape touches a plane with a fixed list of points: corners of boxes and meshes,
 * centres of round ends. An ellipsoid touches it with the point of its support function. A cylinder touches it with the
 * lowest point of each rim, and stands on fixed points of its ends.
 */
#include "read/shapes/plane_points.h"

#include "algebra/simplify.h"
#include "names/piecewise_functions.h"

/* Points on which each end of a cylinder stands, both ends, and the largest number of points of a shape. */
enum { END_POINTS = 8, STANDING_POINTS = 2 * END_POINTS, CYLINDER_ENDS = 2, MOST_POINTS = MOST_CORNERS };

/*
 * A rim's lowest point has no direction where a cylinder stands upright on the plane. Let y be the square of the sine
 * of its tilt over that of least_sine. Below y = 1 the rim reaches below its centre by 3/8 + 3/4 y - y^2/8, in units of
 * least_sine times the radius. That has the value and two derivatives of the sine at y = 1, and its lowest point is
 * never farther from the axis than the radius. A wheel may lie on that dome, which is wider then.
 */
static double least_sine(const struct ContactShape *shape, bool is_rigid) {
  return shape->stands && is_rigid ? 0.00025 : 0.0025;
}

/*
 * Points on which a rigid cylinder stands rise with its tilt by lift y less extension, in the same unit. So they touch
 * nothing while it rolls, and upright the middles of its ends touch nothing.
 */
static const double extension = 0.4, lift = 0.5;

/*
 * Compliant ones overlap by more than that. They rise by soft_lift times the fourth power of the sine, in radii. Rims
 * rise by recess (1 - z)^2, with the square z of the sine over recessed_sine, up to z = 1.
 */
static const double soft_lift = 0.4, recess = 0.004, recessed_sine = 0.3;

/* Centres of balls of a common radius; the contact points of a shape with a plane are on these balls. */
struct BallCentres {
  struct Vector positions[MOST_POINTS]; /* along the axes of the shape's frame */
  size_t count;
  Node radius;
};

static void append_point(struct Graph *graph, struct BallCentres *points, const struct ContactShape *shape,
                         struct Vector from) {
  points->positions[points->count++] = vector_add(graph, shape->offset, matrix_apply(graph, &shape->rotation, from));
}

static void append_corners(struct Graph *graph, struct BallCentres *points, const struct ContactShape *shape) {
  for (int corner = 0; corner < 8; corner++) {
    struct Vector point = {{ZERO, ZERO, ZERO}};
    bool is_another = true; /* false for the duplicate corners of a box without size along an axis */
    for (int i = 0; i < 3; i++) {
      bool is_upper = (corner >> i & 1) != 0;
      point.along[i] = scale(graph, is_upper ? 0.5 : -0.5, shape->size.along[i]);
      is_another &= !(is_upper && shape->is_flat[i]);
    }
    if (is_another) append_point(graph, points, shape, point);
  }
}

/* Appends both ends of the axis of a cylinder or capsule. */
static void append_ends_of_axis(struct Graph *graph, struct BallCentres *points, const struct ContactShape *shape) {
  append_point(graph, points, shape, along_axis(shape, scale(graph, 0.5, shape->length)));
  append_point(graph, points, shape, along_axis(shape, scale(graph, -0.5, shape->length)));
}

/*
 * Appends the points on which each end stands, then the centres of both ends. The first point of an end is on the axis
 * that follows the cylinder's cyclically.
 */
static void append_cylinder_points(struct Graph *graph, struct BallCentres *points, const struct ContactShape *shape) {
  static const double half = 0.70710678118654752440;
  static const double circle[END_POINTS][2] = {{1, 0},  {half, half},   {0, 1},  {-half, half},
                                               {-1, 0}, {-half, -half}, {0, -1}, {half, -half}};
  int across = (shape->axis + 1) % 3, beside = (shape->axis + 2) % 3;
  for (int i = 0; i < STANDING_POINTS && shape->stands; i++) {
    struct Vector point = along_axis(shape, scale(graph, i < END_POINTS ? 0.5 : -0.5, shape->length));
    point.along[across] = scale(graph, circle[i % END_POINTS][0], shape->radius);
    point.along[beside] = scale(graph, circle[i % END_POINTS][1], shape->radius);
    append_point(graph, points, shape, point);
  }
  append_ends_of_axis(graph, points, shape);
}

static void append_mesh_corners(struct Graph *graph, struct BallCentres *points, const struct ContactShape *shape) {
  const struct Mesh *mesh = shape->mesh;
  for (size_t i = 0; i < mesh->corner_count; i++) {
    struct Vector point;
    for (int axis = 0; axis < 3; axis++)
      point.along[axis] = graph_constant(graph, mesh->points[mesh->corners[i]][axis]);
    append_point(graph, points, shape, point);
  }
}

static struct BallCentres points_of(struct Graph *graph, const struct ContactShape *shape) {
  struct BallCentres points = {.radius = ZERO};
  switch (shape->type) {
  case SHAPE_SPHERE:
    points.radius = shape->radius;
    append_point(graph, &points, shape, (struct Vector){{ZERO, ZERO, ZERO}});
    break;
  case SHAPE_CAPSULE:
    points.radius = shape->radius;
    append_ends_of_axis(graph, &points, shape);
    break;
  case SHAPE_BOX: append_corners(graph, &points, shape); break;
  case SHAPE_CYLINDER: append_cylinder_points(graph, &points, shape); break;
  case SHAPE_MESH: append_mesh_corners(graph, &points, shape); break;
  default: break;
  }
  return points;
}

void plane_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct BallCentres points = points_of(graph, pair->first->shape);
  struct Vector normal = axis_of(pair, pair->second), ground = middle_of(pair, pair->second);
  contacts->carrier = pair->first;
  contacts->below = vector_scale(graph, negate(graph, points.radius), normal);
  for (size_t i = 0; i < points.count; i++) {
    struct Vector centre = position_at(graph, &pair->first->pose, points.positions[i]);
    Node height = vector_dot(graph, normal, vector_subtract(graph, centre, ground));
    contacts->items[contacts->count++] = (struct ContactPoint){.point = vector_add(graph, centre, contacts->below),
                                                               .normal = normal,
                                                               .gap = subtract(graph, height, points.radius),
                                                               .distance = ZERO,
                                                               .offset = points.positions[i]};
  }
}

/*
 * A height in radii as a function of the part of the plane's normal across the cylinder's axis. Its gradient is that
 * part times a factor. The gap is a function of the normal, whose gradient is the material point that moves with the
 * gap.
 */
struct HeightByTilt {
  Node height, gradient;
};

/* Returns the height of a rim's lowest point above its centre. */
static struct HeightByTilt height_of_rim(const struct ShapePair *pair, Node squared_sine) {
  double least = least_sine(pair->first->shape, pair->is_rigid), square = least * least;
  struct Graph *graph = pair->graph;
  Node y = scale(graph, 1.0 / square, squared_sine);
  Node excess = subtract(graph, squared_sine, graph_constant(graph, square));
  Node is_tilted = branch_of(pair->scope, excess, "the tilt of the cylinder", pair->line);
  /* The root is that of a positive number even where it is not chosen. */
  Node sine = power_number(graph, choose_node(graph, is_tilted, squared_sine, graph_constant(graph, square)), 0.5);
  Node reach = add(graph, graph_constant(graph, 0.375), scale(graph, 0.75, y));
  reach = subtract(graph, reach, scale(graph, 0.125, power_number(graph, y, 2.0)));
  Node slope = subtract(graph, graph_constant(graph, 0.75), scale(graph, 0.25, y));
  reach = choose_node(graph, is_tilted, sine, scale(graph, least, reach));
  slope = choose_node(graph, is_tilted, power_number(graph, sine, -1.0), scale(graph, 2.0 / least, slope));
  return (struct HeightByTilt){negate(graph, reach), negate(graph, slope)};
}

/* Returns how far the rims of a compliant cylinder that stands on other points rise. */
static struct HeightByTilt recess_of_rim(const struct ShapePair *pair, Node squared_sine) {
  const double square = recessed_sine * recessed_sine;
  struct Graph *graph = pair->graph;
  Node above = subtract(graph, ONE, scale(graph, 1.0 / square, squared_sine));
  above = piecewise_function(pair->scope, MAXIMUM, above, ZERO, pair->line);
  return (struct HeightByTilt){scale(graph, recess, power_number(graph, above, 2.0)),
                               scale(graph, -4.0 * recess / square, above)};
}

/* Returns how far the points on which a cylinder stands rise. */
static struct HeightByTilt rise_of_standing_points(const struct ShapePair *pair, Node squared_sine) {
  struct Graph *graph = pair->graph;
  if (!pair->is_rigid)
    return (struct HeightByTilt){scale(graph, soft_lift, power_number(graph, squared_sine, 2.0)),
                                 scale(graph, 4.0 * soft_lift, squared_sine)};
  double least = least_sine(pair->first->shape, true);
  Node rise = scale(graph, lift / least, squared_sine);
  return (struct HeightByTilt){subtract(graph, rise, graph_constant(graph, extension * least)),
                               graph_constant(graph, 2.0 * lift / least)};
}

void rim_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  const struct ContactShape *shape = pair->first->shape;
  struct Vector across = seen_by(pair, pair->first, axis_of(pair, pair->second));
  across.along[shape->axis] = ZERO;
  Node squared_sine = vector_dot(graph, across, across);
  struct HeightByTilt rim = height_of_rim(pair, squared_sine), standing = rise_of_standing_points(pair, squared_sine);
  if (shape->stands && !pair->is_rigid) {
    struct HeightByTilt rise = recess_of_rim(pair, squared_sine);
    rim = (struct HeightByTilt){add(graph, rim.height, rise.height), add(graph, rim.gradient, rise.gradient)};
  }
  across = matrix_apply(graph, &shape->rotation, across);
  plane_contacts(pair, contacts);
  for (size_t i = 0; i < contacts->count; i++) {
    struct HeightByTilt own = i + CYLINDER_ENDS < contacts->count ? standing : rim;
    struct ContactPoint *point = &contacts->items[i];
    point->gap = add(graph, point->gap, multiply(graph, shape->radius, own.height));
    struct Vector shift = vector_scale(graph, multiply(graph, shape->radius, own.gradient), across);
    point->offset = vector_add(graph, point->offset, shift);
    point->point = position_at(graph, &pair->first->pose, point->offset);
  }
}

/*
 * The first shape, an ellipsoid, on the second shape's plane. With the half axes as the matrix A and the normal n along
 * them, the lowest point is -A^2 n / |A n|, and |A n| is the support function.
 */
void ellipsoid_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct Vector normal = axis_of(pair, pair->second), centre = middle_of(pair, pair->first), lowest;
  struct Vector own = seen_by(pair, pair->first, normal);
  for (int i = 0; i < 3; i++) {
    Node half = scale(graph, 0.5, pair->first->shape->size.along[i]);
    lowest.along[i] = multiply(graph, power_number(graph, half, 2.0), own.along[i]);
  }
  Node support = power_number(graph, vector_dot(graph, lowest, own), 0.5);
  lowest =
      rotated_by(pair, pair->first, vector_scale(graph, negate(graph, power_number(graph, support, -1.0)), lowest));
  Node height = vector_dot(graph, normal, vector_subtract(graph, centre, middle_of(pair, pair->second)));
  contacts->items[contacts->count++] = (struct ContactPoint){.point = vector_add(graph, centre, lowest),
                                                             .normal = normal,
                                                             .gap = subtract(graph, height, support),
                                                             .distance = ZERO};
}

size_t count_points_on_plane(const struct ContactShape *shape) {
  size_t corners = 1;
  switch (shape->type) {
  case SHAPE_BOX:
    for (int i = 0; i < 3; i++) corners *= shape->is_flat[i] ? 1 : 2;
    return corners;
  case SHAPE_CYLINDER: return CYLINDER_ENDS + (shape->stands ? STANDING_POINTS : 0);
  case SHAPE_CAPSULE: return 2;
  case SHAPE_MESH: return shape->mesh != NULL ? shape->mesh->corner_count : 0;
  default: return 1;
  }
}
