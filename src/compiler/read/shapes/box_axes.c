#include "read/shapes/box_axes.h"

#include "algebra/simplify.h"
#include "names/piecewise_functions.h"
#include "read/shapes/reach.h"

/* Signs of numbers that rest at 0 are those of the number plus this share of its size. They decide nothing there. */
static const double sign_bias = 1e-7;

/*
 * Edges count as parallel below this sine times the ratio of the smallest and the largest half size. Their crossings
 * then move by less than 1 % of a width. Boxes are close up to the second share of the smallest half size.
 */
static const double least_sine = 0.01, closeness = 0.05;

/* Overlaps along edges count as larger by this share, so that faces and edges that lie flat do not take turns. */
static const double edge_share = 0.05;

Node cosine_of_axes(const struct Boxes *boxes, int own, int i, int k) {
  return own == 0 ? boxes->cosine[i][k] : boxes->cosine[k][i];
}

Node is_positive_where(const struct Boxes *boxes, Node matters, Node value) {
  Node relevant = choose_node(boxes->graph, matters, value, ONE);
  return branch_of(boxes->pair->scope, relevant, "a contact of boxes", boxes->pair->line);
}

Node sign_where(const struct Boxes *boxes, Node matters, Node value, Node size) {
  struct Graph *graph = boxes->graph;
  Node biased = add(graph, value, scale(graph, sign_bias, size));
  return choose_node(graph, is_positive_where(boxes, matters, biased), ONE, negate(graph, ONE));
}

Node along_face(const struct Boxes *boxes, const struct BoxFace *face, Node first, Node second, Node third) {
  return choose_node(boxes->graph, face->is_third, third, choose_node(boxes->graph, face->is_first, first, second));
}

Node margin_within(const struct Boxes *boxes, Node reach, Node coordinate) {
  struct Graph *graph = boxes->graph;
  return subtract(graph, power_number(graph, reach, 2.0), power_number(graph, coordinate, 2.0));
}

/* Returns the mode of one length that is larger than another one, or is equal to it. */
static Node is_larger(const struct Boxes *boxes, Node matters, Node one, Node other) {
  struct Graph *graph = boxes->graph;
  Node excess = subtract(graph, one, other);
  return is_positive_where(boxes, matters, add(graph, excess, scale(graph, sign_bias, boxes->least)));
}

/* Returns the larger one of two lengths; the first one where the second one does not matter. */
static Node larger_of(const struct Boxes *boxes, Node matters, Node one, Node other) {
  return choose_node(boxes->graph, is_larger(boxes, matters, one, other), one, other);
}

static struct Box box_of(const struct ShapePair *pair, const struct ContactSide *side) {
  struct Box box = {.centre = middle_of(pair, side)};
  for (int i = 0; i < 3; i++) {
    box.axis[i] = own_axis_of(pair, side, i);
    box.half[i] = scale(pair->graph, 0.5, side->shape->size.along[i]);
  }
  return box;
}

/* Returns the smallest half size of both boxes, or the largest one. */
static Node extreme_of(const struct Boxes *boxes, enum Operation operation) {
  Node extreme = boxes->box[0].half[0];
  for (int i = 1; i < 6; i++) {
    Node half = boxes->box[i / 3].half[i % 3];
    extreme = piecewise_function(boxes->pair->scope, operation, extreme, half, boxes->pair->line);
  }
  return extreme;
}

static struct BoxFace face_towards(const struct Boxes *boxes, Node matters, int own) {
  struct Graph *graph = boxes->graph;
  const struct Box *box = &boxes->box[own], *other = &boxes->box[1 - own];
  struct BoxFace face;
  Node distance[3];
  for (int k = 0; k < 3; k++) {
    face.side[k] = sign_where(boxes, matters, other->other[k], boxes->least);
    distance[k] = subtract(graph, multiply(graph, face.side[k], other->other[k]), other->half[k]);
    for (int i = 0; i < 3; i++) {
      Node shadow = own == 0 ? boxes->size[i][k] : boxes->size[k][i];
      distance[k] = subtract(graph, distance[k], multiply(graph, shadow, box->half[i]));
    }
  }
  face.is_first = is_larger(boxes, matters, distance[0], distance[1]);
  Node larger = choose_node(graph, face.is_first, distance[0], distance[1]);
  face.is_third = is_larger(boxes, matters, distance[2], larger);
  face.distance = choose_node(graph, face.is_third, distance[2], larger);
  return face;
}

/* Returns the distance of the boxes along the perpendicular of two edges. */
static Node distance_along(const struct Boxes *boxes, const struct BoxCrossing *crossing) {
  struct Graph *graph = boxes->graph;
  int i = crossing->axis[0], j = crossing->axis[1];
  Node distance = crossing->height;
  for (int k = 1; k < 3; k++) {
    Node shadow = multiply(graph, boxes->box[0].half[(i + k) % 3], boxes->size[(i + 3 - k) % 3][j]);
    Node other = multiply(graph, boxes->box[1].half[(j + k) % 3], boxes->size[i][(j + 3 - k) % 3]);
    distance = subtract(graph, distance, add(graph, shadow, other));
  }
  return multiply(graph, distance, crossing->inverse);
}

static struct BoxCrossing crossing_of(const struct Boxes *boxes, int i, int j) {
  struct Graph *graph = boxes->graph;
  const struct Box *first = &boxes->box[0], *second = &boxes->box[1];
  struct Vector product = vector_cross(graph, first->axis[i], second->axis[j]);
  Node height = vector_dot(graph, product, vector_subtract(graph, first->centre, second->centre));
  struct BoxCrossing crossing = {.axis = {i, j}, .cosine = boxes->cosine[i][j]};
  crossing.squared_sine = add(graph, power_number(graph, boxes->cosine[(i + 1) % 3][j], 2.0),
                              power_number(graph, boxes->cosine[(i + 2) % 3][j], 2.0));
  Node excess = subtract(graph, crossing.squared_sine, boxes->parallel);
  crossing.is_skew = choose_node(graph, boxes->is_close, is_positive_where(boxes, boxes->is_close, excess), ZERO);
  crossing.inverse = power_number(graph, choose_node(graph, crossing.is_skew, crossing.squared_sine, ONE), -0.5);
  crossing.outward = sign_where(boxes, crossing.is_skew, height, boxes->least);
  crossing.height = multiply(graph, crossing.outward, height);
  crossing.product = vector_scale(graph, crossing.outward, product);
  crossing.distance = distance_along(boxes, &crossing);
  return crossing;
}

/*
 * Finds the distance of the boxes. Switching functions matter where the balls about the boxes overlap, and those of
 * edges only where no face separates the boxes.
 */
static void find_distance(struct Boxes *boxes) {
  struct Graph *graph = boxes->graph;
  Node near = are_near(boxes->pair);
  for (int i = 0; i < 9; i++) {
    Node cosine = boxes->cosine[i / 3][i % 3];
    boxes->size[i / 3][i % 3] = multiply(graph, sign_where(boxes, near, cosine, ONE), cosine);
  }
  for (int own = 0; own < 2; own++) boxes->face[own] = face_towards(boxes, near, own);
  boxes->distance = larger_of(boxes, near, boxes->face[0].distance, boxes->face[1].distance);
  Node margin = subtract(graph, scale(graph, closeness, boxes->least), boxes->distance);
  boxes->is_close = choose_node(graph, near, is_positive_where(boxes, near, margin), ZERO);
  for (int i = 0; i < 9; i++) {
    struct BoxCrossing *crossing = &boxes->crossing[i / 3][i % 3];
    *crossing = crossing_of(boxes, i / 3, i % 3);
    Node counted = scale(graph, 1.0 + edge_share, crossing->distance);
    boxes->distance = larger_of(boxes, crossing->is_skew, boxes->distance, counted);
  }
}

struct Boxes boxes_of(const struct ShapePair *pair) {
  struct Graph *graph = pair->graph;
  struct Boxes boxes = {.pair = pair, .graph = graph, .box = {box_of(pair, pair->first), box_of(pair, pair->second)}};
  struct Box *first = &boxes.box[0], *second = &boxes.box[1];
  struct Vector apart = vector_subtract(graph, second->centre, first->centre);
  boxes.least = extreme_of(&boxes, MINIMUM);
  Node sine = divide(graph, scale(graph, least_sine, boxes.least), extreme_of(&boxes, MAXIMUM));
  boxes.parallel = power_number(graph, sine, 2.0);
  for (int i = 0; i < 3; i++) {
    first->other[i] = vector_dot(graph, apart, first->axis[i]);
    second->other[i] = negate(graph, vector_dot(graph, apart, second->axis[i]));
    for (int j = 0; j < 3; j++) boxes.cosine[i][j] = vector_dot(graph, first->axis[i], second->axis[j]);
  }
  find_distance(&boxes);
  return boxes;
}
