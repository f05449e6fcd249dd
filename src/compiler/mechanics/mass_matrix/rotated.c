#include "mechanics/mass_matrix/rotated.h"

#include "algebra/simplify.h"

/* A rotation by an angle about one of the axes: its rows are (c, -s) and (s, c) along the two others. */
struct PlaneRotation {
  int axis, first, second;
  Node cosine, sine;
};

/* True if the matrix is a rotation about one of the axes, by an angle other than multiples of a quarter turn. */
static bool find_plane_rotation(struct Graph *graph, const struct Matrix *rotation,
                                struct PlaneRotation *plane_rotation) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    const struct Vector *row = rotation->row;
    *plane_rotation = (struct PlaneRotation){i, j, k, row[j].along[j], row[k].along[j]};
    bool is_alone = row[i].along[i] == ONE && row[i].along[j] == ZERO && row[i].along[k] == ZERO &&
                    row[j].along[i] == ZERO && row[k].along[i] == ZERO;
    bool mixes = plane_rotation->cosine != ZERO && plane_rotation->sine != ZERO;
    if (is_alone && mixes && row[k].along[k] == plane_rotation->cosine &&
        row[j].along[k] == negate(graph, plane_rotation->sine))
      return true;
  }
  return false;
}

/*
 * Rotates the four elements (a, b; d, e) along the two other axes with four products. c^2 + s^2 = 1 leaves the trace
 * a + e and the difference b - d unchanged. With x = c (b + d) - s (e - a), the result is
 * (a - s x, c x - d; c x - b, e + s x).
 */
static void rotate_block(struct Graph *graph, const struct PlaneRotation *plane_rotation, struct Matrix *matrix) {
  Node *a = &matrix->row[plane_rotation->first].along[plane_rotation->first],
       *b = &matrix->row[plane_rotation->first].along[plane_rotation->second];
  Node *d = &matrix->row[plane_rotation->second].along[plane_rotation->first],
       *e = &matrix->row[plane_rotation->second].along[plane_rotation->second];
  Node across = multiply(graph, plane_rotation->cosine, add_whole(graph, *b, *d));
  Node x = subtract(graph, across, multiply(graph, plane_rotation->sine, subtract(graph, *e, *a)));
  Node moved = multiply(graph, plane_rotation->sine, x), crossed = multiply(graph, plane_rotation->cosine, x),
       before = *b;
  *a = add_whole(graph, *a, negate(graph, moved));
  *b = subtract(graph, crossed, *d);
  *d = subtract(graph, crossed, before);
  *e = add_whole(graph, *e, moved);
}

static void rotate_pair(struct Graph *graph, const struct PlaneRotation *plane_rotation, Node *first, Node *second) {
  Node a = *first, b = *second;
  *first = subtract(graph, multiply(graph, plane_rotation->cosine, a), multiply(graph, plane_rotation->sine, b));
  *second = add(graph, multiply(graph, plane_rotation->sine, a), multiply(graph, plane_rotation->cosine, b));
}

static struct Matrix rotated_about_axis(struct Graph *graph, const struct PlaneRotation *plane_rotation,
                                        struct Matrix matrix) {
  struct Vector *row = matrix.row;
  int i = plane_rotation->axis, j = plane_rotation->first, k = plane_rotation->second;
  rotate_block(graph, plane_rotation, &matrix);
  rotate_pair(graph, plane_rotation, &row[i].along[j], &row[i].along[k]);
  rotate_pair(graph, plane_rotation, &row[j].along[i], &row[k].along[i]);
  return matrix;
}

struct Matrix matrix_rotated(struct Graph *graph, const struct Matrix *rotation, const struct Matrix *matrix) {
  struct PlaneRotation plane_rotation;
  if (find_plane_rotation(graph, rotation, &plane_rotation)) return rotated_about_axis(graph, &plane_rotation, *matrix);
  struct Matrix rows, columns;
  for (int i = 0; i < 3; i++) rows.row[i] = matrix_apply(graph, rotation, matrix->row[i]);
  rows = matrix_transposed(&rows);
  for (int i = 0; i < 3; i++) columns.row[i] = matrix_apply(graph, rotation, rows.row[i]);
  return matrix_transposed(&columns);
}
