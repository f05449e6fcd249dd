/*
 * Points of two boxes. Convex solids touch where a corner of one is on a face of the other, or where two edges cross.
 * Each diagonal of a box has one corner on the side of the other box, and each of the two planes through opposite edges
 * has one edge there. So four corners of each box and 36 pairs of edges are enough, and none of these points jumps
 * while it touches. A point counts while its feature is within the other one; elsewhere its gap is a constant.
 *
 * The first box is taken as slightly smaller than it is where features coincide. So boxes of equal size that stand on
 * each other touch at four points.
 *
 * S. Gottschalk, M. C. Lin, D. Manocha, OBBTree, 1996: the separating axes. Their gaps are the gaps of these points.
 */
#include "read/shapes/box_points.h"

#include "algebra/simplify.h"
#include "names/piecewise_functions.h"

/* The share of its size by which the first box is smaller where features coincide. */
static const double shrinkage = 1e-5;

/* Signs of numbers that rest at 0 are those of the number plus this share of its size. They decide nothing there. */
static const double sign_bias = 1e-7;

/* Edges count as parallel below this sine. Boxes are close to each other up to this share of the smallest half size. */
static const double least_sine = 0.01, closeness = 0.05;

/*
 * Overlaps along edges count as larger by the first share, and points with an overlap larger than that of the boxes by
 * the second one touch less. So features that touch at the same time do not take turns.
 */
static const double edge_share = 0.05, deep_share = 0.15;

/* The sine by which a normal may leave the cone of its edge, so that both edges of a face count that lies flat. */
static const double largest_tilt = 0.02;

/* A box, in vectors along the base's axes. */
struct Box {
  struct Vector centre, axis[3];
  Node half[3];  /* m, half of the size along each axis */
  Node other[3]; /* m, the centre of the other box, seen from this one's along its axes */
};

/*
 * Two edges with the axes i and j. Their common perpendicular is the cross product l of the axes, with the sine as its
 * length. l times axes i + 1, i + 2 and j + 1, j + 2 are products of axes.
 */
struct Crossing {
  int axis[2];
  Node cosine, squared_sine;
  Node outward;            /* the sign for which the perpendicular points to the first box */
  Node height;             /* m, the distance of the centres along the perpendicular, times the sine */
  Node is_skew;            /* positive where the edges are not nearly parallel */
  Node inverse;            /* of the sine */
  struct Vector direction; /* from the second to the first box, with the sine as its length */
  Node distance;           /* m, of the boxes along the perpendicular */
};

struct Boxes {
  const struct ShapePair *pair;
  struct Graph *graph;
  struct Box box[2];
  Node turn[3][3], size[3][3]; /* products of an axis of the first and an axis of the second box; without sign */
  Node least;                  /* m, the smallest half size */
  Node reach;                  /* m, the sum of the half diagonals */
  struct Face {
    /* The face of the other box with the largest distance from a box. The modes tell which of three values along the
     * axes of the other box belongs to its normal: the first one if is_first and not is_third. */
    Node is_first, is_third;
    Node side[3];  /* the signs of the centre of the own box, seen from the other's */
    Node distance; /* m */
  } face[2];
  struct Crossing crossing[3][3];
  Node distance; /* m, of the boxes along the separating axis */
  Node matters;  /* positive where the modes of switching functions matter; elsewhere there are no events of these */
};

static Node product_of_axes(const struct Boxes *boxes, int own, int i, int k) {
  return own == 0 ? boxes->turn[i][k] : boxes->turn[k][i];
}

/* Returns the mode of a switching function: 1 where it is positive, or where it does not matter. */
static Node is_positive_where(const struct Boxes *boxes, Node matters, Node value) {
  Node relevant = choose_node(boxes->graph, matters, value, ONE);
  return branch_of(boxes->pair->scope, relevant, "a contact of boxes", boxes->pair->line);
}

static Node is_positive(const struct Boxes *boxes, Node value) {
  return is_positive_where(boxes, boxes->matters, value);
}

/* Returns the sign of a value with a size, without 0. */
static Node sign_of(const struct Boxes *boxes, Node value, Node size) {
  struct Graph *graph = boxes->graph;
  Node biased = add(graph, value, scale(graph, sign_bias, size));
  return choose_node(graph, is_positive(boxes, biased), ONE, negate(graph, ONE));
}

/* Returns the mode of one length that is larger than another one, or is equal to it. */
static Node is_larger(const struct Boxes *boxes, Node one, Node other) {
  struct Graph *graph = boxes->graph;
  return is_positive(boxes, add(graph, subtract(graph, one, other), scale(graph, sign_bias, boxes->least)));
}

static Node larger_of(const struct Boxes *boxes, Node one, Node other) {
  return choose_node(boxes->graph, is_larger(boxes, one, other), one, other);
}

static Node square(const struct Boxes *boxes, Node value) {
  return multiply(boxes->graph, value, value);
}

/*
 * Appends a point with the gap z that counts where the margins are positive. Where one is not, the next ones do not
 * matter. Below the distance S of the boxes the gap is 3 S - 2 z: a box that has sunk into the top of another one
 * overlaps by more with its sides, where it does not touch.
 */
static void append_point(const struct Boxes *boxes, struct ContactPoint point, const Node *margins, size_t count,
                         struct ContactPoints *contacts) {
  struct Graph *graph = boxes->graph;
  Node counts = boxes->matters;
  for (size_t i = 0; i < count; i++)
    counts = choose_node(graph, counts, is_positive_where(boxes, counts, margins[i]), ZERO);
  Node beyond = scale(graph, 1.0 + deep_share, boxes->distance);
  beyond = subtract(graph, beyond, scale(graph, sign_bias, boxes->least));
  Node above = subtract(graph, point.gap, beyond), other = subtract(graph, beyond, scale(graph, 2.0, above));
  point.gap = choose_node(graph, is_positive_where(boxes, counts, above), point.gap, other);
  point.gap = choose_node(graph, counts, point.gap, boxes->least);
  point.distance = ZERO;
  contacts->items[contacts->count++] = point;
}

/* Returns the value of the face's axis. */
static Node along_face(const struct Boxes *boxes, const struct Face *face, Node first, Node second, Node third) {
  return choose_node(boxes->graph, face->is_third, third, choose_node(boxes->graph, face->is_first, first, second));
}

static struct Face face_towards(const struct Boxes *boxes, int own) {
  struct Graph *graph = boxes->graph;
  const struct Box *box = &boxes->box[own], *other = &boxes->box[1 - own];
  struct Face face;
  Node distance[3];
  for (int k = 0; k < 3; k++) {
    face.side[k] = sign_of(boxes, other->other[k], boxes->least);
    distance[k] = subtract(graph, multiply(graph, face.side[k], other->other[k]), other->half[k]);
    for (int i = 0; i < 3; i++) {
      Node extent = own == 0 ? boxes->size[i][k] : boxes->size[k][i];
      distance[k] = subtract(graph, distance[k], multiply(graph, extent, box->half[i]));
    }
  }
  face.is_first = is_larger(boxes, distance[0], distance[1]);
  Node larger = choose_node(graph, face.is_first, distance[0], distance[1]);
  face.is_third = is_larger(boxes, distance[2], larger);
  face.distance = choose_node(graph, face.is_third, distance[2], larger);
  return face;
}

/* Returns by how much a corner is within a face across one of its axes, as a difference of squares. */
static Node margin_of_corner(const struct Boxes *boxes, Node half, Node corner, double enlargement) {
  struct Graph *graph = boxes->graph;
  Node reach = scale(graph, 1.0 + enlargement, half);
  return subtract(graph, square(boxes, reach), square(boxes, corner));
}

/* Appends the corner of a diagonal of a box that is next to the face of the other box. signs: of the diagonal. */
static void append_corner(const struct Boxes *boxes, int own, const int signs[3], struct ContactPoints *contacts) {
  struct Graph *graph = boxes->graph;
  const struct Face *face = &boxes->face[own];
  const struct Box *box = &boxes->box[own], *other = &boxes->box[1 - own];
  Node diagonal[3] = {ZERO, ZERO, ZERO}, margins[3], turn;
  struct Vector point = {{ZERO, ZERO, ZERO}}, normal;
  for (int i = 0; i < 3; i++) {
    Node half = scale(graph, signs[i], box->half[i]);
    point = vector_add(graph, point, vector_scale(graph, half, box->axis[i]));
    for (int k = 0; k < 3; k++) {
      turn = product_of_axes(boxes, own, i, k);
      diagonal[k] = add(graph, diagonal[k], multiply(graph, half, turn));
    }
  }
  const Node *side = face->side, *half = other->half;
  Node outward = along_face(boxes, face, side[0], side[1], side[2]);
  Node along = along_face(boxes, face, diagonal[0], diagonal[1], diagonal[2]);
  Node upper = sign_of(boxes, along, boxes->least), end = negate(graph, multiply(graph, outward, upper));
  for (int k = 0; k < 3; k++) {
    Node corner = add(graph, other->other[k], multiply(graph, end, diagonal[k]));
    margins[k] = margin_of_corner(boxes, half[k], corner, own == 0 ? shrinkage : -shrinkage);
    normal.along[k] =
        along_face(boxes, face, other->axis[0].along[k], other->axis[1].along[k], other->axis[2].along[k]);
  }
  Node across[2] = {along_face(boxes, face, margins[1], margins[0], margins[0]),
                    choose_node(graph, face->is_third, margins[1], margins[2])};
  Node height = along_face(boxes, face, multiply(graph, side[0], other->other[0]),
                           multiply(graph, side[1], other->other[1]), multiply(graph, side[2], other->other[2]));
  Node gap = subtract(graph, height, along_face(boxes, face, half[0], half[1], half[2]));
  gap = subtract(graph, gap, multiply(graph, upper, along));
  point = vector_add(graph, box->centre, vector_scale(graph, end, point));
  normal = vector_scale(graph, own == 0 ? outward : negate(graph, outward), normal);
  append_point(boxes, (struct ContactPoint){.point = point, .normal = normal, .gap = gap}, across, 2, contacts);
}

static void append_corners_of(const struct Boxes *boxes, int own, struct ContactPoints *contacts) {
  static const int diagonals[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
  for (int i = 0; i < 4; i++) append_corner(boxes, own, diagonals[i], contacts);
}

/* Edges along an axis of a box, in a plane through its centre, and the edge there that is next to the other box. */
struct Edge {
  Node end;    /* the sign of the edge */
  Node along;  /* m, the edge's distance from the centre of the box along the other edge, without the sign */
  Node reach;  /* m, its distance from the centre along the common perpendicular, times the sine of both edges */
  Node margin; /* positive where the normal is in the cone of the edge, or nearly so */
};

/* upper: on which side of axis i + 2 the edge is while it is on the positive one of axis i + 1. */
static struct Edge edge_of(const struct Boxes *boxes, const struct Crossing *crossing, int own, int upper) {
  struct Graph *graph = boxes->graph;
  const struct Box *box = &boxes->box[own];
  int i = crossing->axis[own], j = crossing->axis[1 - own], first = (i + 1) % 3, second = (i + 2) % 3;
  Node along_first = product_of_axes(boxes, own, first, j), along_second = product_of_axes(boxes, own, second, j);
  Node one = multiply(graph, box->half[first], along_second);
  Node two = scale(graph, upper, multiply(graph, box->half[second], along_first));
  Node offset = subtract(graph, two, one), sign = sign_of(boxes, offset, boxes->least);
  struct Edge edge = {.reach = multiply(graph, sign, offset)};
  edge.end = negate(graph, multiply(graph, crossing->outward, sign));
  edge.along = add(graph, multiply(graph, box->half[first], along_first),
                   scale(graph, upper, multiply(graph, box->half[second], along_second)));
  Node lean = scale(graph, upper, multiply(graph, along_first, along_second));
  edge.margin = subtract(graph, scale(graph, largest_tilt, crossing->squared_sine), lean);
  return edge;
}

/* Returns by how much the crossing, at a coordinate along an edge times the squared sine, is between the edge's ends. */
static Node margin_of_crossing(const struct Boxes *boxes, const struct Crossing *crossing, Node half, Node place,
                               double enlargement) {
  struct Graph *graph = boxes->graph;
  Node reach = multiply(graph, scale(graph, 1.0 + enlargement, half), crossing->squared_sine);
  return subtract(graph, square(boxes, reach), square(boxes, place));
}

static void append_crossing(const struct Boxes *boxes, const struct Crossing *crossing, int upper, int other_upper,
                            struct ContactPoints *contacts) {
  struct Graph *graph = boxes->graph;
  const struct Box *first = &boxes->box[0], *second = &boxes->box[1];
  int i = crossing->axis[0], j = crossing->axis[1], following = (i + 1) % 3, last = (i + 2) % 3;
  struct Edge edge = edge_of(boxes, crossing, 0, upper), other = edge_of(boxes, crossing, 1, other_upper);
  /* The vector between the edges' middles along both axes. */
  Node along_i = negate(graph, add(graph, first->other[i], multiply(graph, other.end, other.along)));
  Node along_j = add(graph, second->other[j], multiply(graph, edge.end, edge.along));
  Node place = subtract(graph, multiply(graph, crossing->cosine, along_j), along_i);
  Node other_place = subtract(graph, along_j, multiply(graph, crossing->cosine, along_i));
  Node margins[4] = {edge.margin, other.margin, margin_of_crossing(boxes, crossing, first->half[i], place, -shrinkage),
                     margin_of_crossing(boxes, crossing, second->half[j], other_place, shrinkage)};
  Node gap = subtract(graph, crossing->height, add(graph, edge.reach, other.reach));
  gap = multiply(graph, gap, crossing->inverse);
  struct Vector middle = vector_add(graph, vector_scale(graph, first->half[following], first->axis[following]),
                                    vector_scale(graph, scale(graph, upper, first->half[last]), first->axis[last]));
  struct Vector point = vector_add(graph, first->centre, vector_scale(graph, edge.end, middle));
  point = vector_add(graph, point,
                     vector_scale(graph, multiply(graph, place, square(boxes, crossing->inverse)), first->axis[i]));
  append_point(boxes,
               (struct ContactPoint){
                   .point = point, .normal = vector_scale(graph, crossing->inverse, crossing->direction), .gap = gap},
               margins, 4, contacts);
}

/* Returns the distance of the boxes along the perpendicular of two edges, which is far below 0 for parallel ones. */
static Node distance_along(const struct Boxes *boxes, const struct Crossing *crossing) {
  struct Graph *graph = boxes->graph;
  int i = crossing->axis[0], j = crossing->axis[1];
  Node distance = crossing->height;
  for (int k = 1; k < 3; k++) {
    Node extent = multiply(graph, boxes->box[0].half[(i + k) % 3], boxes->size[(i + 3 - k) % 3][j]);
    Node other = multiply(graph, boxes->box[1].half[(j + k) % 3], boxes->size[i][(j + 3 - k) % 3]);
    distance = subtract(graph, distance, add(graph, extent, other));
  }
  distance = multiply(graph, scale(graph, 1.0 + edge_share, distance), crossing->inverse);
  return choose_node(graph, crossing->is_skew, distance, scale(graph, -2.0, boxes->reach));
}

static struct Crossing crossing_of(struct Boxes *boxes, int i, int j) {
  struct Graph *graph = boxes->graph;
  const struct Box *first = &boxes->box[0], *second = &boxes->box[1];
  struct Vector perpendicular = vector_cross(graph, first->axis[i], second->axis[j]);
  Node height = vector_dot(graph, perpendicular, vector_subtract(graph, first->centre, second->centre));
  struct Crossing crossing = {.axis = {i, j}, .cosine = boxes->turn[i][j]};
  crossing.squared_sine =
      add(graph, square(boxes, boxes->turn[(i + 1) % 3][j]), square(boxes, boxes->turn[(i + 2) % 3][j]));
  Node excess = subtract(graph, crossing.squared_sine, graph_constant(graph, least_sine * least_sine));
  crossing.is_skew = choose_node(graph, boxes->matters, is_positive(boxes, excess), ZERO);
  boxes->matters = crossing.is_skew;
  crossing.inverse = power_number(graph, choose_node(graph, crossing.is_skew, crossing.squared_sine, ONE), -0.5);
  crossing.outward = sign_of(boxes, height, boxes->least);
  crossing.height = multiply(graph, crossing.outward, height);
  crossing.direction = vector_scale(graph, crossing.outward, perpendicular);
  crossing.distance = distance_along(boxes, &crossing);
  return crossing;
}

static void append_crossings(struct Boxes *boxes, const struct Crossing *crossing, struct ContactPoints *contacts) {
  boxes->matters = crossing->is_skew;
  for (int upper = -1; upper <= 1; upper += 2)
    for (int other = -1; other <= 1; other += 2) append_crossing(boxes, crossing, upper, other, contacts);
}

static struct Boxes boxes_of(const struct ShapePair *pair) {
  struct Graph *graph = pair->graph;
  const struct ContactSide *sides[2] = {pair->first, pair->second};
  struct Boxes boxes = {.pair = pair, .graph = graph};
  for (int own = 0; own < 2; own++) {
    struct Box *box = &boxes.box[own];
    box->centre = middle_of(pair, sides[own]);
    for (int i = 0; i < 3; i++) {
      struct Vector axis = {{ZERO, ZERO, ZERO}};
      axis.along[i] = ONE;
      box->axis[i] = rotated_by(pair, sides[own], axis);
      box->half[i] = scale(graph, 0.5, sides[own]->shape->size.along[i]);
      bool is_first = own == 0 && i == 0;
      boxes.least =
          is_first ? box->half[0] : piecewise_function(pair->scope, MINIMUM, boxes.least, box->half[i], pair->line);
    }
  }
  struct Vector apart = vector_subtract(graph, boxes.box[1].centre, boxes.box[0].centre);
  for (int i = 0; i < 3; i++) {
    boxes.box[0].other[i] = vector_dot(graph, apart, boxes.box[0].axis[i]);
    boxes.box[1].other[i] = negate(graph, vector_dot(graph, apart, boxes.box[1].axis[i]));
    for (int j = 0; j < 3; j++) boxes.turn[i][j] = vector_dot(graph, boxes.box[0].axis[i], boxes.box[1].axis[j]);
  }
  Node radii[2];
  for (int own = 0; own < 2; own++) {
    radii[own] = ZERO;
    for (int i = 0; i < 3; i++) radii[own] = add(graph, radii[own], square(&boxes, boxes.box[own].half[i]));
    radii[own] = power_number(graph, radii[own], 0.5);
  }
  boxes.reach = add(graph, radii[0], radii[1]);
  return boxes;
}

/*
 * Finds the distance of the boxes. Switching functions matter where the balls about the boxes overlap, and most of them
 * only where no face separates the boxes.
 */
static void find_distance(struct Boxes *boxes) {
  struct Graph *graph = boxes->graph;
  boxes->matters = ONE;
  struct Vector apart = vector_subtract(graph, boxes->box[1].centre, boxes->box[0].centre);
  boxes->matters = is_positive(boxes, subtract(graph, square(boxes, boxes->reach), vector_dot(graph, apart, apart)));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      boxes->size[i][j] = multiply(graph, sign_of(boxes, boxes->turn[i][j], ONE), boxes->turn[i][j]);
  for (int own = 0; own < 2; own++) boxes->face[own] = face_towards(boxes, own);
  boxes->distance = larger_of(boxes, boxes->face[0].distance, boxes->face[1].distance);
  Node is_close = is_positive(boxes, subtract(graph, scale(graph, closeness, boxes->least), boxes->distance));
  boxes->matters = is_close = choose_node(graph, boxes->matters, is_close, ZERO);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      boxes->crossing[i][j] = crossing_of(boxes, i, j);
      boxes->distance = larger_of(boxes, boxes->distance, boxes->crossing[i][j].distance);
      boxes->matters = is_close;
    }
}

void boxes_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Boxes boxes = boxes_of(pair);
  find_distance(&boxes);
  append_corners_of(&boxes, 0, contacts);
  append_corners_of(&boxes, 1, contacts);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) append_crossings(&boxes, &boxes.crossing[i][j], contacts);
  carry_by_first(pair, contacts);
}
