#include "read/space/joint_ends.h"

#include "base/memory.h"
#include "names/similar.h"
#include "read/space/bodies.h"
#include "read/space/frames.h"

/* Returns a remedy for an unknown name: the most similar one, or the expected kinds. */
static const char *similar_end(const struct Reader *reader, const char *name) {
  struct SimilarName similar = {.wanted = name};
  similar_consider_all(&similar, reader->bodies);
  similar_consider_all(&similar, reader->spatial_points);
  for (size_t i = 1; i < reader->model->mechanism.frame_count; i++)
    similar_consider(&similar, reader->model->mechanism.frames[i].name);
  return suggestion(similar.best, "expected a <frame>, <body>, <point> or <particle>, or base");
}

/* Returns the full name in an attribute; NULL after reporting an error. */
static char *end_name(struct Reader *reader, xmlNodePtr node, const char *name) {
  return attribute_is(node, name, "base") ? copy_text("base") : reference_attribute(reader, node, name);
}

bool read_displaced_joint_end(struct Reader *reader, xmlNodePtr node, const char *name, struct JointEnd *end) {
  char *full_name = end_name(reader, node, name);
  if (full_name == NULL) return false;
  struct SpatialPoint point;
  const struct Body *body = find_body(reader, full_name);
  const struct ReferenceFrame *frame = &reader->model->mechanism.frames[0];
  end->has_axes = find_spatial_point(reader, full_name, &point);
  if (end->has_axes) {
    frame = &reader->model->mechanism.frames[point.frame];
    end->position = point.position;
  } else if (body != NULL) {
    for (int axis = 0; axis < 3; axis++) end->position.along[axis] = body->displaced[axis];
  } else {
    report_at(reader, node, "there is nothing named '%s' for this <%s>; %s", attribute(node, name),
              (const char *)node->name, similar_end(reader, full_name));
    return false;
  }
  end->rotation = frame->pose.rotation;
  end->frame = (size_t)(frame - reader->model->mechanism.frames);
  return true;
}

bool read_joint_end(struct Reader *reader, xmlNodePtr node, const char *name, struct JointEnd *end) {
  long line = line_of(node);
  const char *what = attribute(node, name);
  if (!read_displaced_joint_end(reader, node, name, end)) return false;
  end->position = vector_without_displacements(reader, line, what, end->position);
  end->rotation = matrix_without_displacements(reader, line, what, end->rotation);
  return true;
}

bool read_joint_end_early(struct Reader *reader, xmlNodePtr node, const char *name, struct JointEnd *end) {
  char *full_name = end_name(reader, node, name);
  struct SpatialPoint point;
  if (full_name != NULL && waits_for_element(reader, full_name)) return false;
  if (full_name != NULL && find_spatial_point(reader, full_name, &point))
    return read_joint_end(reader, node, name, end);
  *end = (struct JointEnd){.rotation = reader->model->mechanism.frames[0].pose.rotation};
  return true;
}

struct Vector angular_velocity_of_end(struct Reader *reader, xmlNodePtr node, const struct JointEnd *end) {
  const struct Pose *pose = &reader->model->mechanism.frames[end->frame].pose;
  const char *what = "the angular velocity of a frame";
  struct Vector spin = vector_without_displacements(reader, line_of(node), what, pose->angular_velocity);
  return matrix_apply(reader->model->graph, &end->rotation, spin);
}

struct Vector axis_of_end(const struct JointEnd *end, int axis) {
  return (struct Vector){
      {end->rotation.row[0].along[axis], end->rotation.row[1].along[axis], end->rotation.row[2].along[axis]}};
}

Node product_of_axes(struct Graph *graph, const struct JointEnd *from, int first, const struct JointEnd *to,
                     int second) {
  return vector_dot(graph, axis_of_end(from, first), axis_of_end(to, second));
}

Node offset_along(struct Graph *graph, const struct JointEnd *from, const struct JointEnd *to, int axis) {
  struct Vector between = vector_subtract(graph, to->position, from->position);
  return vector_dot(graph, axis_of_end(from, axis), between);
}
