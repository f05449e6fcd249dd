/*
 * Points of two boxes. Convex solids touch where a corner of one is on a face of the other, or where two edges cross.
 * Each diagonal of a box has one corner on the side of the other box. Each plane through its centre and two opposite
 * edges has one edge there. So four corners of each box and 36 pairs of edges are enough, and none of these points
 * jumps while it touches. A point counts while its feature is within that of the other box; elsewhere its gap is a
 * constant. The first box is slightly smaller where features coincide, so that equal boxes on each other have 4 points.
 */
#include "read/shapes/box_points.h"

#include "algebra/simplify.h"
#include "read/shapes/box_axes.h"

/* The share of its size by which the first box is smaller where features coincide. */
static const double shrinkage = 1e-5;

/* Points with an overlap larger than that of the boxes by this share touch less. */
static const double deep_share = 0.15;

/* The sine by which a normal may leave the cone of its edge, so that both edges of a face count that lies flat. */
static const double largest_tilt = 0.02;

/*
 * Appends a point with the gap z that counts where the margins are positive. Where one is not, the next ones do not
 * matter. A box that has sunk into the top of another one overlaps by more with its sides, where it does not touch. So
 * the gap is 3 S - 2 z below S, which is the distance of the boxes and its share.
 */
static void append_point(const struct Boxes *boxes, struct ContactPoint point, Node counts, const Node *margins,
                         size_t count, struct ContactPoints *contacts) {
  struct Graph *graph = boxes->graph;
  for (size_t i = 0; i < count; i++)
    counts = choose_node(graph, counts, is_positive_where(boxes, counts, margins[i]), ZERO);
  Node deepest = scale(graph, 1.0 + deep_share, boxes->distance), above = subtract(graph, point.gap, deepest);
  Node sign = sign_where(boxes, counts, above, boxes->least);
  point.gap = choose_node(graph, sign, point.gap, subtract(graph, deepest, scale(graph, 2.0, above)));
  point.gap = choose_node(graph, counts, point.gap, boxes->least);
  point.distance = ZERO;
  contacts->items[contacts->count++] = point;
}

/* The positive end of a diagonal of a box, from its centre: along the base's axes, and along those of the other box. */
struct Diagonal {
  struct Vector end;
  Node seen[3];
};

static struct Diagonal diagonal_of(const struct Boxes *boxes, int own, const int signs[3]) {
  struct Graph *graph = boxes->graph;
  const struct Box *box = &boxes->box[own];
  struct Diagonal diagonal = {{{ZERO, ZERO, ZERO}}, {ZERO, ZERO, ZERO}};
  for (int i = 0; i < 3; i++) {
    Node half = scale(graph, signs[i], box->half[i]);
    diagonal.end = vector_add(graph, diagonal.end, vector_scale(graph, half, box->axis[i]));
    for (int k = 0; k < 3; k++)
      diagonal.seen[k] = add(graph, diagonal.seen[k], multiply(graph, half, cosine_of_axes(boxes, own, i, k)));
  }
  return diagonal;
}

/* Returns the normal of a face of a box, towards the first box. own: the box that the face is turned to. */
static struct Vector normal_of_face(const struct Boxes *boxes, int own, const struct BoxFace *face, Node outward) {
  const struct Vector *axis = boxes->box[1 - own].axis;
  struct Vector normal;
  for (int i = 0; i < 3; i++)
    normal.along[i] = along_face(boxes, face, axis[0].along[i], axis[1].along[i], axis[2].along[i]);
  return vector_scale(boxes->graph, own == 0 ? outward : negate(boxes->graph, outward), normal);
}

/* Appends the corner of a diagonal of a box that is next to the face of the other box. */
static void append_corner(const struct Boxes *boxes, int own, const int signs[3], struct ContactPoints *contacts) {
  struct Graph *graph = boxes->graph;
  const struct BoxFace *face = &boxes->face[own];
  const Node *centre = boxes->box[1 - own].other, *half = boxes->box[1 - own].half, *side = face->side;
  struct Diagonal diagonal = diagonal_of(boxes, own, signs);
  Node outward = along_face(boxes, face, side[0], side[1], side[2]);
  Node along = along_face(boxes, face, diagonal.seen[0], diagonal.seen[1], diagonal.seen[2]);
  Node upper = sign_where(boxes, boxes->is_close, along, boxes->least);
  Node end = negate(graph, multiply(graph, outward, upper)), margins[3], heights[3];
  for (int k = 0; k < 3; k++) {
    Node corner = add(graph, centre[k], multiply(graph, end, diagonal.seen[k]));
    margins[k] = margin_within(boxes, scale(graph, own == 0 ? 1.0 + shrinkage : 1.0 - shrinkage, half[k]), corner);
    heights[k] = subtract(graph, multiply(graph, side[k], centre[k]), half[k]);
  }
  Node across[2] = {along_face(boxes, face, margins[1], margins[0], margins[0]),
                    along_face(boxes, face, margins[2], margins[2], margins[1])};
  Node height = along_face(boxes, face, heights[0], heights[1], heights[2]);
  struct Vector point = vector_add(graph, boxes->box[own].centre, vector_scale(graph, end, diagonal.end));
  append_point(boxes,
               (struct ContactPoint){.point = point,
                                     .normal = normal_of_face(boxes, own, face, outward),
                                     .gap = subtract(graph, height, multiply(graph, upper, along))},
               boxes->is_close, across, 2, contacts);
}

static void append_corners_of(const struct Boxes *boxes, int own, struct ContactPoints *contacts) {
  static const int diagonals[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
  for (int i = 0; i < 4; i++) append_corner(boxes, own, diagonals[i], contacts);
}

/* The edge of a box, of two in a plane through its centre, that is next to the other box. */
struct Edge {
  Node end;    /* the sign of the edge */
  Node along;  /* m, its positive middle from the centre of the box, along the other edge */
  Node reach;  /* m, its distance from the centre along the perpendicular, times the sine */
  Node margin; /* positive where the normal is in the cone of the edge, or nearly so */
};

/* upper: on which side of the axis after the next one the edge is that is on the positive side of the next axis. */
static struct Edge edge_of(const struct Boxes *boxes, const struct BoxCrossing *crossing, int own, int upper) {
  struct Graph *graph = boxes->graph;
  const Node *half = boxes->box[own].half;
  int i = crossing->axis[own], j = crossing->axis[1 - own], first = (i + 1) % 3, second = (i + 2) % 3;
  Node along_first = cosine_of_axes(boxes, own, first, j), along_second = cosine_of_axes(boxes, own, second, j);
  Node offset = subtract(graph, scale(graph, upper, multiply(graph, half[second], along_first)),
                         multiply(graph, half[first], along_second));
  Node sign = sign_where(boxes, crossing->is_skew, offset, boxes->least);
  Node lean = scale(graph, upper, multiply(graph, along_first, along_second));
  return (struct Edge){.end = negate(graph, multiply(graph, crossing->outward, sign)),
                       .along = add(graph, multiply(graph, half[first], along_first),
                                    scale(graph, upper, multiply(graph, half[second], along_second))),
                       .reach = multiply(graph, sign, offset),
                       .margin = subtract(graph, scale(graph, largest_tilt, crossing->squared_sine), lean)};
}

/* Returns by how much a crossing is between the ends of an edge. place: along the edge, times the squared sine. */
static Node margin_of_crossing(const struct Boxes *boxes, const struct BoxCrossing *crossing, Node reach, Node place) {
  return margin_within(boxes, multiply(boxes->graph, reach, crossing->squared_sine), place);
}

/* Returns the point at a place along an edge of the first box. */
static struct Vector point_of_crossing(const struct Boxes *boxes, const struct BoxCrossing *crossing, Node end,
                                       int upper, Node place) {
  struct Graph *graph = boxes->graph;
  const struct Box *box = &boxes->box[0];
  int i = crossing->axis[0], first = (i + 1) % 3, second = (i + 2) % 3;
  struct Vector middle = vector_add(graph, vector_scale(graph, box->half[first], box->axis[first]),
                                    vector_scale(graph, scale(graph, upper, box->half[second]), box->axis[second]));
  Node distance = multiply(graph, place, power_number(graph, crossing->inverse, 2.0));
  struct Vector point = vector_add(graph, box->centre, vector_scale(graph, end, middle));
  return vector_add(graph, point, vector_scale(graph, distance, box->axis[i]));
}

/* Appends the crossing of two edges. Their nearest points follow from the vector between the middles of the edges. */
static void append_crossing(const struct Boxes *boxes, const struct BoxCrossing *crossing, int upper, int other_upper,
                            struct ContactPoints *contacts) {
  struct Graph *graph = boxes->graph;
  const struct Box *first = &boxes->box[0], *second = &boxes->box[1];
  int i = crossing->axis[0], j = crossing->axis[1];
  struct Edge edge = edge_of(boxes, crossing, 0, upper), other = edge_of(boxes, crossing, 1, other_upper);
  Node along_i = negate(graph, add(graph, first->other[i], multiply(graph, other.end, other.along)));
  Node along_j = add(graph, second->other[j], multiply(graph, edge.end, edge.along));
  Node place = subtract(graph, multiply(graph, crossing->cosine, along_j), along_i);
  Node other_place = subtract(graph, along_j, multiply(graph, crossing->cosine, along_i));
  Node reach = scale(graph, 1.0 - shrinkage, first->half[i]),
       other_reach = scale(graph, 1.0 + shrinkage, second->half[j]);
  Node margins[4] = {edge.margin, other.margin, margin_of_crossing(boxes, crossing, reach, place),
                     margin_of_crossing(boxes, crossing, other_reach, other_place)};
  Node gap = subtract(graph, crossing->height, add(graph, edge.reach, other.reach));
  append_point(boxes,
               (struct ContactPoint){.point = point_of_crossing(boxes, crossing, edge.end, upper, place),
                                     .normal = vector_scale(graph, crossing->inverse, crossing->product),
                                     .gap = multiply(graph, gap, crossing->inverse)},
               crossing->is_skew, margins, 4, contacts);
}

void boxes_contacts(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Boxes boxes = boxes_of(pair);
  for (int own = 0; own < 2; own++) append_corners_of(&boxes, own, contacts);
  for (int i = 0; i < 9; i++)
    for (int k = 0; k < 4; k++)
      append_crossing(&boxes, &boxes.crossing[i / 3][i % 3], k / 2 == 0 ? -1 : 1, k % 2 == 0 ? -1 : 1, contacts);
  carry_by_first(pair, contacts);
}
