#include "read/space/sides.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/names/similar.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"

/* Returns a remedy for an unknown name: the most similar one, or the expected kinds. */
static const char *meant_side(const struct Reader *reader, const char *name) {
  struct Similar similar = {.wanted = name};
  similar_consider_all(&similar, reader->bodies);
  similar_consider_all(&similar, reader->spatial_points);
  for (size_t i = 1; i < reader->model->mechanism.frame_count; i++)
    similar_consider(&similar, reader->model->mechanism.frames[i].name);
  return similar.best != NULL ? format_text("did you mean '%s'?", similar.best)
                              : "expected a <frame>, <body>, <point> or <particle>, or base";
}

/* Returns the full name in an attribute; NULL after reporting an error. */
static char *side_name(struct Reader *reader, xmlNodePtr node, const char *name) {
  return attribute_is(node, name, "base") ? copy_text("base") : reference_attribute(reader, node, name);
}

bool read_displaced_side(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side) {
  char *full_name = side_name(reader, node, name);
  if (full_name == NULL) return false;
  struct SpatialPoint point;
  const struct Body *body = find_body(reader, full_name);
  const struct ReferenceFrame *frame = &reader->model->mechanism.frames[0];
  side->has_axes = find_spatial_point(reader, full_name, &point);
  if (side->has_axes) {
    frame = &reader->model->mechanism.frames[point.frame];
    side->position = point.position;
  } else if (body != NULL) {
    for (int axis = 0; axis < 3; axis++) side->position.along[axis] = body->displaced[axis];
  } else {
    report_at(reader, node, "there is nothing named '%s' for this <%s>; %s", attribute(node, name),
              (const char *)node->name, meant_side(reader, full_name));
    return false;
  }
  side->rotation = frame->pose.rotation;
  side->frame = (size_t)(frame - reader->model->mechanism.frames);
  return true;
}

bool read_side(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side) {
  long line = line_of(node);
  const char *what = attribute(node, name);
  if (!read_displaced_side(reader, node, name, side)) return false;
  side->position = vector_without_displacements(reader, line, what, side->position);
  side->rotation = matrix_without_displacements(reader, line, what, side->rotation);
  return true;
}

bool read_side_early(struct Reader *reader, xmlNodePtr node, const char *name, struct Side *side) {
  char *full_name = side_name(reader, node, name);
  struct SpatialPoint point;
  if (full_name != NULL && waits_for_element(reader, full_name)) return false;
  if (full_name != NULL && find_spatial_point(reader, full_name, &point)) return read_side(reader, node, name, side);
  *side = (struct Side){.rotation = reader->model->mechanism.frames[0].pose.rotation};
  return true;
}

struct Vector angular_velocity_of_side(struct Reader *reader, xmlNodePtr node, const struct Side *side) {
  const struct Pose *pose = &reader->model->mechanism.frames[side->frame].pose;
  const char *what = "the angular velocity of a frame";
  struct Vector spin = vector_without_displacements(reader, line_of(node), what, pose->angular_velocity);
  return matrix_apply(reader->model->graph, &side->rotation, spin);
}

struct Vector axis_of_side(const struct Side *side, int axis) {
  return (struct Vector){
      {side->rotation.row[0].along[axis], side->rotation.row[1].along[axis], side->rotation.row[2].along[axis]}};
}

Node product_of_axes(struct Graph *graph, const struct Side *from, int first, const struct Side *to, int second) {
  return vector_dot(graph, axis_of_side(from, first), axis_of_side(to, second));
}

Node offset_along(struct Graph *graph, const struct Side *from, const struct Side *to, int axis) {
  struct Vector between = vector_subtract(graph, to->position, from->position);
  return vector_dot(graph, axis_of_side(from, axis), between);
}
