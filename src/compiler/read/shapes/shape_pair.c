#include "read/shapes/shape_pair.h"

#include "algebra/simplify.h"

struct Vector along_axis(const struct ContactShape *shape, Node length) {
  struct Vector vector = {{ZERO, ZERO, ZERO}};
  vector.along[shape->axis] = length;
  return vector;
}

struct Vector rotated_by(const struct ShapePair *pair, const struct ContactSide *side, struct Vector vector) {
  vector = matrix_apply(pair->graph, &side->shape->rotation, vector);
  return matrix_apply(pair->graph, &side->pose.rotation, vector);
}

struct Vector seen_by(const struct ShapePair *pair, const struct ContactSide *side, struct Vector vector) {
  vector = matrix_apply_transposed(pair->graph, &side->pose.rotation, vector);
  return matrix_apply_transposed(pair->graph, &side->shape->rotation, vector);
}

struct Vector own_axis_of(const struct ShapePair *pair, const struct ContactSide *side, int i) {
  struct Vector axis = {{ZERO, ZERO, ZERO}};
  axis.along[i] = ONE;
  return rotated_by(pair, side, axis);
}

struct Vector axis_of(const struct ShapePair *pair, const struct ContactSide *side) {
  return own_axis_of(pair, side, side->shape->axis);
}

struct Vector middle_of(const struct ShapePair *pair, const struct ContactSide *side) {
  return position_at(pair->graph, &side->pose, side->shape->offset);
}

void carry_by_first(const struct ShapePair *pair, struct ContactPoints *contacts) {
  struct Graph *graph = pair->graph;
  const struct Pose *pose = &pair->first->pose;
  contacts->carrier = pair->first;
  contacts->below = (struct Vector){{ZERO, ZERO, ZERO}};
  for (size_t i = 0; i < contacts->count; i++) {
    struct ContactPoint *point = &contacts->items[i];
    point->offset = matrix_apply_transposed(graph, &pose->rotation, vector_subtract(graph, point->point, pose->origin));
  }
}
