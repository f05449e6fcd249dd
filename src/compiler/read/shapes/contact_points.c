/*
 * Nearest points in closed form. A shape touches a plane with a fixed list of points: corners of boxes and meshes,
 * centres of round ends. An ellipsoid touches it with the point of its support function. A cylinder touches it with the
 * lowest point of each rim, and stands on fixed points of its ends. Other pairs reduce to two balls, gap = |p1 - p2| - r1 - r2 with the nearest points p1, p2 of their
 * centres, axes or solids. Nearest points follow by clamping coordinates, whose kinks are events. The normal (p1 -
 * p2)/|p1 - p2| is undefined if a centre enters the other solid or axis, so that such deep penetration is not
 * covered.
 *
 * C. Ericson, Real-Time Collision Detection, 2005, section 5.1.
 */
#include "read/shapes/contact_points.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "names/piecewise_functions.h"

/* Points on which each end of a cylinder stands, both ends, and the largest number of points of a shape. */
enum { END_POINTS = 8, STANDING_POINTS = 2 * END_POINTS, CYLINDER_ENDS = 2, MOST_POINTS = MOST_CORNERS };

/*
 * A rim's lowest point has no direction where a cylinder stands upright on the plane. Let y be the square of the sine of
 * its tilt over that of least_sine. Below y = 1 the rim reaches below its centre by 3/8 + 3/4 y - y^2/8, in units of
 * least_sine times the radius. That has the value and two derivatives of the sine at y = 1, and its lowest point is
 * never farther from the axis than the radius.
 */
static double least_sine(bool is_rigid) {
  return is_rigid ? 0.00025 : 0.0025;
}

/*
 * Points on which a cylinder stands rise with its tilt, and so touch nothing while it rolls. Rigid ones rise by
 * lift y less extension, in the same unit. So they are lower than the ends, and the middles of the ends touch nothing.
 * Compliant ones overlap by more than that. They rise by soft_lift times the fourth power of the sine, in radii.
 */
static const double extension = 0.4, lift = 0.5, soft_lift = 0.4;

/* Two shapes, with the graph and scope for expressions of their contacts. */
struct ShapePair {
  struct Scope *scope;
  struct Graph *graph;
  long line;
  const struct ContactSide *first, *second;
  bool is_rigid;
};

/* Centres of balls of a common radius; the contact points of a shape with a plane are on these balls. */
struct BallCentres {
  struct Vector positions[MOST_POINTS]; /* along the axes of the shape's frame */
  size_t count;
  Node radius;
};

struct ContactSide contact_side_of(struct Reader *reader, long line, const struct ContactShape *shape) {
  const struct Mechanism *mechanism = &reader->model->mechanism;
  const char *name = shape->name;
  struct Pose pose = mechanism->frames[shape->frame].pose;
  if (shape->particle != NO_PARTICLE) {
    pose = pose_of_base();
    for (int i = 0; i < 3; i++) pose.origin.along[i] = mechanism->bodies[shape->particle].displaced[i];
    for (int i = 0; i < 3; i++) pose.velocity.along[i] = total_time_derivative(reader->scope, pose.origin.along[i]);
  }
  pose.rotation = matrix_without_displacements(reader, line, name, pose.rotation);
  pose.origin = vector_without_displacements(reader, line, name, pose.origin);
  pose.velocity = vector_without_displacements(reader, line, name, pose.velocity);
  pose.angular_velocity = vector_without_displacements(reader, line, name, pose.angular_velocity);
  return (struct ContactSide){shape, pose};
}

static struct Vector along_axis(const struct ContactShape *shape, Node length) {
  struct Vector vector = {{ZERO, ZERO, ZERO}};
  vector.along[shape->axis] = length;
  return vector;
}

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

/*
 * Appends the points on which each end stands, then the centres of both ends. The first point of an end is on the axis
 * that follows the cylinder's cyclically.
 */
static void append_ends(struct Graph *graph, struct BallCentres *points, const struct ContactShape *shape) {
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
  append_point(graph, points, shape, along_axis(shape, scale(graph, 0.5, shape->length)));
  append_point(graph, points, shape, along_axis(shape, scale(graph, -0.5, shape->length)));
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
    append_point(graph, &points, shape, along_axis(shape, scale(graph, 0.5, shape->length)));
    append_point(graph, &points, shape, along_axis(shape, scale(graph, -0.5, shape->length)));
    break;
  case SHAPE_BOX: append_corners(graph, &points, shape); break;
  case SHAPE_CYLINDER: append_ends(graph, &points, shape); break;
  case SHAPE_MESH: append_mesh_corners(graph, &points, shape); break;
  default: break;
  }
  return points;
}

/* Rotates a vector along the axes of the shape to the base's axes. */
static struct Vector rotated_by(const struct ShapePair *pair, const struct ContactSide *side, struct Vector vector) {
  vector = matrix_apply(pair->graph, &side->shape->rotation, vector);
  return matrix_apply(pair->graph, &side->pose.rotation, vector);
}

static struct Vector axis_of(const struct ShapePair *pair, const struct ContactSide *side) {
  return rotated_by(pair, side, along_axis(side->shape, ONE));
}

static struct Vector middle_of(const struct ShapePair *pair, const struct ContactSide *side) {
  return position_at(pair->graph, &side->pose, side->shape->offset);
}

static Node length_of(struct Graph *graph, struct Vector vector) {
  return power_number(graph, vector_dot(graph, vector, vector), 0.5);
}

/* The first shape's points on the second shape's plane. */
static void plane_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
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
 * A height in radii as a function of the part of the plane's normal across the cylinder's axis. Its gradient is that part
 * times a factor. The gap is a function of the normal, whose gradient is the material point that moves with the gap.
 */
struct HeightByTilt {
  Node height, gradient;
};

/* Returns the height of a rim's lowest point above its centre. */
static struct HeightByTilt height_of_rim(const struct ShapePair *pair, Node squared_sine) {
  double least = least_sine(pair->is_rigid), square = least * least;
  struct Graph *graph = pair->graph;
  Node sine = power_number(graph, squared_sine, 0.5), y = scale(graph, 1.0 / square, squared_sine);
  Node excess = subtract(graph, squared_sine, graph_constant(graph, square));
  Node is_tilted = branch_of(pair->scope, excess, "the tilt of the cylinder", pair->line);
  Node reach = add(graph, graph_constant(graph, 0.375), scale(graph, 0.75, y));
  reach = subtract(graph, reach, scale(graph, 0.125, power_number(graph, y, 2.0)));
  Node slope = subtract(graph, graph_constant(graph, 0.75), scale(graph, 0.25, y));
  reach = choose_node(graph, is_tilted, sine, scale(graph, least, reach));
  slope = choose_node(graph, is_tilted, power_number(graph, sine, -1.0), scale(graph, 2.0 / least, slope));
  return (struct HeightByTilt){negate(graph, reach), negate(graph, slope)};
}

/* Returns how far the points on which a cylinder stands rise. */
static struct HeightByTilt rise_of_standing_points(const struct ShapePair *pair, Node squared_sine) {
  struct Graph *graph = pair->graph;
  if (!pair->is_rigid)
    return (struct HeightByTilt){scale(graph, soft_lift, power_number(graph, squared_sine, 2.0)),
                                 scale(graph, 4.0 * soft_lift, squared_sine)};
  double least = least_sine(pair->is_rigid);
  Node rise = scale(graph, lift / least, squared_sine);
  return (struct HeightByTilt){subtract(graph, rise, graph_constant(graph, extension * least)),
                               graph_constant(graph, 2.0 * lift / least)};
}

/* Returns the normal of the second shape's plane along the axes of the first shape. */
static struct Vector normal_seen_from_first(const struct ShapePair *pair, struct Vector normal) {
  struct Vector own = matrix_apply_transposed(pair->graph, &pair->first->pose.rotation, normal);
  return matrix_apply_transposed(pair->graph, &pair->first->shape->rotation, own);
}

/* The first shape, a cylinder, on the second shape's plane: it stands on points of its ends, and rolls on its rims. */
static void rim_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  const struct ContactShape *shape = pair->first->shape;
  struct Vector across = normal_seen_from_first(pair, axis_of(pair, pair->second));
  across.along[shape->axis] = ZERO;
  Node squared_sine = vector_dot(graph, across, across);
  struct HeightByTilt rim = height_of_rim(pair, squared_sine), standing = rise_of_standing_points(pair, squared_sine);
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
static void ellipsoid_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct Vector normal = axis_of(pair, pair->second), centre = middle_of(pair, pair->first), lowest;
  struct Vector own = normal_seen_from_first(pair, normal);
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

/*
 * Appends the contact point of two balls about the nearest points of two shapes: the first point, and the vector to it.
 */
static void append_ball_contact(const struct ShapePair *pair, struct Vector first, struct Vector between,
                                Node second_radius, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  Node radius = pair->first->shape->radius, distance = length_of(graph, between);
  struct Vector normal = vector_scale(graph, power_number(graph, distance, -1.0), between);
  struct Vector point = vector_subtract(graph, first, vector_scale(graph, radius, normal));
  Node gap = subtract(graph, subtract(graph, distance, radius), second_radius);
  contacts->items[contacts->count++] =
      (struct ContactPoint){.point = point, .normal = normal, .gap = gap, .distance = distance};
}

/* Clamps a length to the interval of the size `whole` about 0. */
static Node clamp(const struct ShapePair *pair, Node length, Node whole) {
  Node half = scale(pair->graph, 0.5, whole);
  Node above = piecewise_function(pair->scope, MAXIMUM, length, negate(pair->graph, half), pair->line);
  return piecewise_function(pair->scope, MINIMUM, above, half, pair->line);
}

static void sphere_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Vector centre = middle_of(pair, pair->first);
  struct Vector between = vector_subtract(pair->graph, centre, middle_of(pair, pair->second));
  append_ball_contact(pair, centre, between, pair->second->shape->radius, contacts);
}

static void capsule_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct Vector centre = middle_of(pair, pair->first), middle = middle_of(pair, pair->second);
  struct Vector axis = axis_of(pair, pair->second);
  Node along = vector_dot(graph, axis, vector_subtract(graph, centre, middle));
  along = clamp(pair, along, pair->second->shape->length);
  struct Vector nearest = vector_add(graph, middle, vector_scale(graph, along, axis));
  append_ball_contact(pair, centre, vector_subtract(graph, centre, nearest), pair->second->shape->radius, contacts);
}

/* Returns the centre of the first shape relative to the second, along the axes of the second. */
static struct Vector seen_from_second(const struct ShapePair *pair) {
  struct Vector between = vector_subtract(pair->graph, middle_of(pair, pair->first), middle_of(pair, pair->second));
  between = matrix_apply_transposed(pair->graph, &pair->second->pose.rotation, between);
  return matrix_apply_transposed(pair->graph, &pair->second->shape->rotation, between);
}

/* Both points are relative to the second shape, along its axes: inside of it their difference is 0 without rounding. */
static void append_nearest_contact(const struct ShapePair *pair, struct Vector seen, struct Vector nearest,
                                   struct ContactPoints *contacts) {
  struct Vector between = rotated_by(pair, pair->second, vector_subtract(pair->graph, seen, nearest));
  append_ball_contact(pair, middle_of(pair, pair->first), between, ZERO, contacts);
}

static void box_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Vector seen = seen_from_second(pair), nearest;
  for (int i = 0; i < 3; i++) nearest.along[i] = clamp(pair, seen.along[i], pair->second->shape->size.along[i]);
  append_nearest_contact(pair, seen, nearest, contacts);
}

static void cylinder_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  const struct ContactShape *shape = pair->second->shape;
  struct Vector seen = seen_from_second(pair), nearest = seen;
  int across = (shape->axis + 1) % 3, beside = (shape->axis + 2) % 3;
  struct Vector off = seen;
  off.along[shape->axis] = ZERO;
  Node far = subtract(graph, vector_dot(graph, off, off), power_number(graph, shape->radius, 2.0));
  Node is_outside = branch_of(pair->scope, far, "the cylinder's side", pair->line);
  Node share = choose_node(graph, is_outside, divide(graph, shape->radius, length_of(graph, off)), ONE);
  nearest.along[across] = multiply(graph, share, seen.along[across]);
  nearest.along[beside] = multiply(graph, share, seen.along[beside]);
  nearest.along[shape->axis] = clamp(pair, seen.along[shape->axis], shape->length);
  append_nearest_contact(pair, seen, nearest, contacts);
}

/*
 * Finds the nearest points of two segments. The nearest point of the infinite lines is clamped to the first
 * segment, projected to the second and clamped, then projected back and clamped. This is exact (Ericson, section
 * 5.1.9).
 */
static void capsules_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  static const double nothing = 1e-12; /* for parallel lines, where any point is nearest */
  struct Graph *graph = pair->graph;
  struct Vector first = middle_of(pair, pair->first), second = middle_of(pair, pair->second);
  struct Vector u = axis_of(pair, pair->first), w = axis_of(pair, pair->second);
  struct Vector between = vector_subtract(graph, first, second);
  Node uw = vector_dot(graph, u, w), along_u = vector_dot(graph, between, u), along_w = vector_dot(graph, between, w);
  Node skew = subtract(graph, graph_constant(graph, 1.0 + nothing), power_number(graph, uw, 2.0));
  Node s = divide(graph, subtract(graph, multiply(graph, uw, along_w), along_u), skew);
  s = clamp(pair, s, pair->first->shape->length);
  Node t = clamp(pair, add(graph, along_w, multiply(graph, s, uw)), pair->second->shape->length);
  s = clamp(pair, subtract(graph, multiply(graph, t, uw), along_u), pair->first->shape->length);
  struct Vector nearest = vector_add(graph, first, vector_scale(graph, s, u));
  struct Vector other = vector_add(graph, second, vector_scale(graph, t, w));
  append_ball_contact(pair, nearest, vector_subtract(graph, nearest, other), pair->second->shape->radius, contacts);
}

typedef void ContactFunction(const struct ShapePair *pair, struct ContactPoints *contacts);

/* By types of the first and second shape. Pairs in the other order are exchanged. */
static ContactFunction *const functions[SHAPE_TYPES][SHAPE_TYPES] = {
    [SHAPE_SPHERE] = {plane_contacts, sphere_contact, box_contact, cylinder_contact, capsule_contact},
    [SHAPE_BOX] = {plane_contacts},
    [SHAPE_CYLINDER] = {rim_contacts},
    [SHAPE_CAPSULE] = {[SHAPE_PLANE] = plane_contacts, [SHAPE_CAPSULE] = capsules_contact},
    [SHAPE_MESH] = {plane_contacts},
    [SHAPE_ELLIPSOID] = {ellipsoid_contact},
};

static size_t point_count(const struct ContactShape *shape) {
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

size_t count_contact_points(const struct ContactShape *first, const struct ContactShape *second) {
  if (functions[first->type][second->type] != NULL) return second->type == SHAPE_PLANE ? point_count(first) : 1;
  if (functions[second->type][first->type] != NULL) return first->type == SHAPE_PLANE ? point_count(second) : 1;
  return 0;
}

struct ContactPoints contact_points_of(struct Reader *reader, long line, const struct ContactSide *first,
                                       const struct ContactSide *second, bool is_rigid) {
  struct Graph *graph = reader->model->graph;
  ContactFunction *append_contacts = functions[first->shape->type][second->shape->type];
  bool is_exchanged = append_contacts == NULL;
  struct ShapePair pair = {reader->scope, graph, line, is_exchanged ? second : first, is_exchanged ? first : second,
                           is_rigid};
  if (is_exchanged) append_contacts = functions[second->shape->type][first->shape->type];
  struct ContactPoints contacts = {
      .items = allocate(count_contact_points(first->shape, second->shape), sizeof *contacts.items)};
  append_contacts(&pair, &contacts);
  for (size_t i = 0; i < contacts.count && is_exchanged; i++)
    contacts.items[i].normal = vector_scale(graph, graph_constant(graph, -1.0), contacts.items[i].normal);
  return contacts;
}
