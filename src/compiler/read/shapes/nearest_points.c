/*
 * Nearest points in closed form. Pairs of shapes reduce to two balls, gap = |p1 - p2| - r1 - r2 with the nearest points
 * p1, p2 of their centres, axes or solids. Nearest points follow by clamping coordinates, whose kinks are events. The
 * normal (p1 - p2)/|p1 - p2| is undefined if a centre enters the other solid or axis, so that such deep penetration is
 * not covered.
 *
 * C. Ericson, Real-Time Collision Detection, 2005, section 5.1.
 */
#include "read/shapes/nearest_points.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "names/piecewise_functions.h"

enum { BOX_EDGES = 12 };

static Node length_of(struct Graph *graph, struct Vector vector) {
  return power_number(graph, vector_dot(graph, vector, vector), 0.5);
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

/* Returns what messages call the pieces of functions of a pair. */
static const char *purpose_of_pair(const struct ShapePair *pair) {
  return format_text("the nearest points of '%s' and '%s'", pair->first->shape->name, pair->second->shape->name);
}

/* Clamps a length to the interval of the size `whole` about 0. */
static Node clamp(const struct ShapePair *pair, Node length, Node whole) {
  const char *purpose = purpose_of_pair(pair);
  Node half = scale(pair->graph, 0.5, whole);
  Node above = piecewise_function_for(pair->scope, MAXIMUM, length, negate(pair->graph, half), purpose, pair->line);
  return piecewise_function_for(pair->scope, MINIMUM, above, half, purpose, pair->line);
}

void sphere_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Vector centre = middle_of(pair, pair->first);
  struct Vector between = vector_subtract(pair->graph, centre, middle_of(pair, pair->second));
  append_ball_contact(pair, centre, between, pair->second->shape->radius, contacts);
}

void capsule_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct Vector centre = middle_of(pair, pair->first), middle = middle_of(pair, pair->second);
  struct Vector axis = axis_of(pair, pair->second);
  Node along = vector_dot(graph, axis, vector_subtract(graph, centre, middle));
  along = clamp(pair, along, pair->second->shape->length);
  struct Vector nearest = vector_add(graph, middle, vector_scale(graph, along, axis));
  append_ball_contact(pair, centre, vector_subtract(graph, centre, nearest), pair->second->shape->radius, contacts);
}

/* Returns a point relative to the centre of the second shape, along its axes. */
static struct Vector seen_from_second(const struct ShapePair *pair, struct Vector point) {
  return seen_by(pair, pair->second, vector_subtract(pair->graph, point, middle_of(pair, pair->second)));
}

/* Both seen and nearest are relative to the second shape: inside of it their difference is 0 without rounding. */
static void append_nearest_contact(const struct ShapePair *pair, struct Vector centre, struct Vector seen,
                                   struct Vector nearest, struct ContactPoints *contacts) {
  struct Vector between = rotated_by(pair, pair->second, vector_subtract(pair->graph, seen, nearest));
  append_ball_contact(pair, centre, between, ZERO, contacts);
}

/* Appends the contact of a ball of the first shape with the second shape, a box. */
static void append_box_contact(const struct ShapePair *pair, struct Vector centre, struct ContactPoints *contacts) {
  struct Vector seen = seen_from_second(pair, centre), nearest;
  for (int i = 0; i < 3; i++) nearest.along[i] = clamp(pair, seen.along[i], pair->second->shape->size.along[i]);
  append_nearest_contact(pair, centre, seen, nearest, contacts);
}

void box_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  append_box_contact(pair, middle_of(pair, pair->first), contacts);
}

void cylinder_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  const struct ContactShape *shape = pair->second->shape;
  struct Vector centre = middle_of(pair, pair->first), seen = seen_from_second(pair, centre), nearest = seen;
  int across = (shape->axis + 1) % 3, beside = (shape->axis + 2) % 3;
  struct Vector off = seen;
  off.along[shape->axis] = ZERO;
  Node far = subtract(graph, vector_dot(graph, off, off), power_number(graph, shape->radius, 2.0));
  Node is_outside = branch_of(pair->scope, far, "the cylinder's side", pair->line);
  Node share = choose_node(graph, is_outside, divide(graph, shape->radius, length_of(graph, off)), ONE);
  nearest.along[across] = multiply(graph, share, seen.along[across]);
  nearest.along[beside] = multiply(graph, share, seen.along[beside]);
  nearest.along[shape->axis] = clamp(pair, seen.along[shape->axis], shape->length);
  append_nearest_contact(pair, centre, seen, nearest, contacts);
}

/* A segment: its middle, its direction as a unit vector, and its length. */
struct Segment {
  struct Vector middle, direction;
  Node length;
};

/* The nearest points of two segments, and how far the first one would have to be longer for a nearer point. */
struct NearestPoints {
  struct Vector first, second;
  Node excess;
};

/*
 * Finds the nearest points of two segments. The nearest point of the infinite lines is clamped to the first
 * segment, projected to the second and clamped, then projected back and clamped. This is exact (Ericson, section
 * 5.1.9). If spreads, the points of nearly parallel segments approach the middle of the first one. The exact ones would
 * jump from end to end where the segments are parallel.
 */
static struct NearestPoints nearest_points_of(const struct ShapePair *pair, const struct Segment *first,
                                              const struct Segment *second, bool spreads) {
  static const double nothing = 1e-12; /* for parallel lines, where any point is nearest */
  static const double nearly = 1e-3;   /* squared sine of the angle below which points spread */
  struct Graph *graph = pair->graph;
  struct Vector u = first->direction, w = second->direction,
                between = vector_subtract(graph, first->middle, second->middle);
  Node uw = vector_dot(graph, u, w), along_u = vector_dot(graph, between, u), along_w = vector_dot(graph, between, w);
  /* The squared sine is not negative by rounding, as 1 - uw^2 may be. */
  struct Vector product = vector_cross(graph, u, w);
  Node skew = add(graph, graph_constant(graph, nothing), vector_dot(graph, product, product));
  if (spreads)
    skew = piecewise_function_for(pair->scope, MAXIMUM, skew, graph_constant(graph, nearly), purpose_of_pair(pair),
                                  pair->line);
  Node s = divide(graph, subtract(graph, multiply(graph, uw, along_w), along_u), skew);
  s = clamp(pair, s, first->length);
  Node t = clamp(pair, add(graph, along_w, multiply(graph, s, uw)), second->length);
  Node whole = subtract(graph, multiply(graph, t, uw), along_u);
  s = clamp(pair, whole, first->length);
  return (struct NearestPoints){vector_add(graph, first->middle, vector_scale(graph, s, u)),
                                vector_add(graph, second->middle, vector_scale(graph, t, w)),
                                subtract(graph, whole, s)};
}

static struct Segment axis_of_capsule(const struct ShapePair *pair, const struct ContactSide *side) {
  return (struct Segment){middle_of(pair, side), axis_of(pair, side), side->shape->length};
}

void capsules_contact(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Segment first = axis_of_capsule(pair, pair->first), second = axis_of_capsule(pair, pair->second);
  struct NearestPoints nearest = nearest_points_of(pair, &first, &second, !pair->is_rigid);
  struct Vector between = vector_subtract(pair->graph, nearest.first, nearest.second);
  append_ball_contact(pair, nearest.first, between, pair->second->shape->radius, contacts);
}

/* An edge of a box along an axis. upper: on which sides of the two following axes it is. */
struct BoxEdge {
  int axis;
  bool upper[2];
};

/* Lists the edges that have a length; of those that coincide at a box without size along an axis the first one. */
static size_t list_edges(const struct ContactShape *box, struct BoxEdge edges[BOX_EDGES]) {
  size_t count = 0;
  for (int i = 0; i < BOX_EDGES; i++) {
    struct BoxEdge edge = {i % 3, {(i / 3 & 1) != 0, i / 6 != 0}};
    bool coincides = false;
    for (int side = 0; side < 2; side++) coincides |= edge.upper[side] && box->is_flat[(edge.axis + 1 + side) % 3];
    if (!box->is_flat[edge.axis] && !coincides) edges[count++] = edge;
  }
  return count;
}

/* Returns an edge of the second shape, a box, along the base's axes. */
static struct Segment segment_of_edge(const struct ShapePair *pair, const struct BoxEdge *edge) {
  struct Graph *graph = pair->graph;
  struct Vector size = pair->second->shape->size, middle = {{ZERO, ZERO, ZERO}};
  for (int side = 0; side < 2; side++) {
    int across = (edge->axis + 1 + side) % 3;
    middle.along[across] = scale(graph, edge->upper[side] ? 0.5 : -0.5, size.along[across]);
  }
  middle = vector_add(graph, middle_of(pair, pair->second), rotated_by(pair, pair->second, middle));
  return (struct Segment){middle, own_axis_of(pair, pair->second, edge->axis), size.along[edge->axis]};
}

/*
 * Appends the contact of the first shape, a capsule, with an edge. Where an end of its axis is nearest to the edge, the
 * ball of that end touches it already. So the gap grows there by the square of the missing length over the radius.
 */
static void append_edge_contact(const struct ShapePair *pair, const struct Segment *edge,
                                struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct Segment axis = axis_of_capsule(pair, pair->first);
  struct NearestPoints nearest = nearest_points_of(pair, &axis, edge, false);
  append_ball_contact(pair, nearest.first, vector_subtract(graph, nearest.first, nearest.second), ZERO, contacts);
  struct ContactPoint *point = &contacts->items[contacts->count - 1];
  Node grown = divide(graph, power_number(graph, nearest.excess, 2.0), pair->first->shape->radius);
  point->gap = add(graph, point->gap, grown);
}

void capsule_on_box_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  struct Vector middle = middle_of(pair, pair->first), axis = axis_of(pair, pair->first);
  for (int end = 0; end < 2; end++) {
    Node half = scale(graph, end == 0 ? 0.5 : -0.5, pair->first->shape->length);
    append_box_contact(pair, vector_add(graph, middle, vector_scale(graph, half, axis)), contacts);
  }
  struct BoxEdge edges[BOX_EDGES];
  size_t count = list_edges(pair->second->shape, edges);
  for (size_t i = 0; i < count; i++) {
    struct Segment edge = segment_of_edge(pair, &edges[i]);
    append_edge_contact(pair, &edge, contacts);
  }
  carry_by_first(pair, contacts);
}

size_t count_points_of_capsule_on_box(const struct ContactShape *box) {
  struct BoxEdge edges[BOX_EDGES];
  return 2 + list_edges(box, edges);
}
