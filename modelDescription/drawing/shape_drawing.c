#include "shape_drawing.h"

#include <math.h>
#include <string.h>

static bool is_drawn(const struct ContactShape *shape) {
  return !shape->is_hidden && shape->type != SHAPE_PLANE && shape->type != SHAPE_MESH;
}

bool has_drawn_shape(const struct Model *model, const struct Body *body) {
  bool has = false;
  for (size_t i = 0; i < model->mechanism.shape_count; i++) {
    const struct ContactShape *shape = &model->mechanism.shapes[i];
    bool is_of_frame = body->is_in_frame && body->frame != BASE_FRAME && shape->frame == body->frame;
    has |= is_drawn(shape) && shape->in != NULL && (strcmp(shape->in, body->name) == 0 || is_of_frame);
  }
  return has;
}

/* Sets the pose of the frame or particle that the shape is in; values of a planar body have its angle. */
static void set_pose(const struct Model *model, const struct ContactShape *shape, const double *values,
                     double origin[3], double rotation[3][3]) {
  const struct Pose *pose = &model->mechanism.frames[shape->frame].pose;
  const struct Body *body = shape->particle != NO_PARTICLE ? &model->mechanism.bodies[shape->particle] : NULL;
  double angle = body != NULL && body->has_angle ? values[body->angle.node] : 0.0;
  const double in_plane[3][3] = {{cos(angle), -sin(angle), 0.0}, {sin(angle), cos(angle), 0.0}, {0.0, 0.0, 1.0}};
  for (int i = 0; i < 3; i++) {
    origin[i] = values[body != NULL ? body->position[i].node : pose->origin.along[i]];
    for (int j = 0; j < 3; j++) rotation[i][j] = body != NULL ? in_plane[i][j] : values[pose->rotation.row[i].along[j]];
  }
}

static struct Solid solid_of_shape(const struct Model *model, const struct ContactShape *shape, const double *values) {
  struct Solid solid;
  double rotation[3][3];
  set_pose(model, shape, values, solid.middle, rotation);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) solid.middle[i] += rotation[i][j] * values[shape->offset.along[j]];
    for (int axis = 0; axis < 3; axis++) {
      solid.axis[axis][i] = 0.0;
      for (int j = 0; j < 3; j++) solid.axis[axis][i] += rotation[i][j] * values[shape->rotation.row[j].along[axis]];
    }
    bool is_sized = shape->type == SHAPE_BOX || shape->type == SHAPE_ELLIPSOID;
    solid.half[i] = is_sized ? 0.5 * values[shape->size.along[i]] : values[shape->radius];
  }
  if (shape->type == SHAPE_CYLINDER || shape->type == SHAPE_CAPSULE)
    solid.half[shape->axis] = 0.5 * values[shape->length];
  return solid;
}

void append_drawn_shape(struct Drawing *drawing, const struct View *view, const struct Model *model,
                        const struct ContactShape *shape, const double *values) {
  if (!is_drawn(shape)) return;
  struct Solid solid = solid_of_shape(model, shape, values);
  double sum = 0.0;
  for (int i = 0; i < 3; i++) sum += solid.middle[i] + solid.half[i] + solid.axis[0][i] + solid.axis[1][i];
  if (!isfinite(sum)) return;
  if (shape->type == SHAPE_SPHERE || shape->type == SHAPE_ELLIPSOID) append_ellipsoid(drawing, view, &solid);
  else if (shape->type == SHAPE_BOX) append_box(drawing, view, &solid);
  else append_cylinder(drawing, view, &solid, shape->axis);
}

bool find_drawn_plane(const struct Model *model, const struct ContactShape *shape, const double *values,
                      double point[3], double normal[3]) {
  if (shape->is_hidden || shape->type != SHAPE_PLANE) return false;
  struct Solid solid = solid_of_shape(model, shape, values);
  bool is_finite = true;
  for (int i = 0; i < 3; i++) {
    point[i] = solid.middle[i];
    normal[i] = solid.axis[shape->axis][i];
    is_finite &= isfinite(point[i]) && isfinite(normal[i]);
  }
  return is_finite;
}
