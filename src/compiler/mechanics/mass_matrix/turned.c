#include "mechanics/mass_matrix/turned.h"

#include "algebra/simplify.h"

/* A rotation by an angle about one of the axes: its rows are (c, -s) and (s, c) along the two others. */
struct PlainTurn {
  int axis, first, second;
  Node cosine, sine;
};

/* True if the matrix is a rotation about one of the axes, by an angle other than multiples of a quarter turn. */
static bool find_plain_turn(struct Graph *graph, const struct Matrix *rotation, struct PlainTurn *turn) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    const struct Vector *row = rotation->row;
    *turn = (struct PlainTurn){i, j, k, row[j].along[j], row[k].along[j]};
    bool is_alone = row[i].along[i] == ONE && row[i].along[j] == ZERO && row[i].along[k] == ZERO &&
                    row[j].along[i] == ZERO && row[k].along[i] == ZERO;
    bool mixes = turn->cosine != ZERO && turn->sine != ZERO;
    if (is_alone && mixes && row[k].along[k] == turn->cosine && row[j].along[k] == negate(graph, turn->sine))
      return true;
  }
  return false;
}

/*
 * Rotates the four elements (a, b; d, e) along the two other axes with four products. c^2 + s^2 = 1 leaves the trace
 * a + e and the difference b - d unchanged. With x = c (b + d) - s (e - a), the result is
 * (a - s x, c x - d; c x - b, e + s x).
 */
static void turn_block(struct Graph *graph, const struct PlainTurn *turn, struct Matrix *matrix) {
  Node *a = &matrix->row[turn->first].along[turn->first], *b = &matrix->row[turn->first].along[turn->second];
  Node *d = &matrix->row[turn->second].along[turn->first], *e = &matrix->row[turn->second].along[turn->second];
  Node across = multiply(graph, turn->cosine, add_whole(graph, *b, *d));
  Node x = subtract(graph, across, multiply(graph, turn->sine, subtract(graph, *e, *a)));
  Node moved = multiply(graph, turn->sine, x), crossed = multiply(graph, turn->cosine, x), before = *b;
  *a = add_whole(graph, *a, negate(graph, moved));
  *b = subtract(graph, crossed, *d);
  *d = subtract(graph, crossed, before);
  *e = add_whole(graph, *e, moved);
}

static void turn_pair(struct Graph *graph, const struct PlainTurn *turn, Node *first, Node *second) {
  Node a = *first, b = *second;
  *first = subtract(graph, multiply(graph, turn->cosine, a), multiply(graph, turn->sine, b));
  *second = add(graph, multiply(graph, turn->sine, a), multiply(graph, turn->cosine, b));
}

static struct Matrix turned_about_axis(struct Graph *graph, const struct PlainTurn *turn, struct Matrix matrix) {
  struct Vector *row = matrix.row;
  int i = turn->axis, j = turn->first, k = turn->second;
  turn_block(graph, turn, &matrix);
  turn_pair(graph, turn, &row[i].along[j], &row[i].along[k]);
  turn_pair(graph, turn, &row[j].along[i], &row[k].along[i]);
  return matrix;
}

struct Matrix matrix_turned(struct Graph *graph, const struct Matrix *rotation, const struct Matrix *matrix) {
  struct PlainTurn turn;
  if (find_plain_turn(graph, rotation, &turn)) return turned_about_axis(graph, &turn, *matrix);
  struct Matrix rows, columns;
  for (int i = 0; i < 3; i++) rows.row[i] = matrix_apply(graph, rotation, matrix->row[i]);
  rows = matrix_transposed(&rows);
  for (int i = 0; i < 3; i++) columns.row[i] = matrix_apply(graph, rotation, rows.row[i]);
  return matrix_transposed(&columns);
}
