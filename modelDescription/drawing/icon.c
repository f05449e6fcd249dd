#include "icon.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* Points of a circle; parallels of an ellipsoid; objects up to which particles are dots. */
enum { ROUND = 24, RINGS = 13, MOST_DOTS = 60 };

/* The icon under construction. */
struct Icon {
  const struct StartScene *scene;
  struct Drawing drawing; /* in m */
  double size;            /* of the system in the picture, in m */
};

/* A form with three axes: its centre, unit vectors along them, and half of its size along each, in m. */
struct Solid {
  double middle[3], axis[3][3], half[3];
};

static struct PicturePoint projected(const struct View *view, const double position[3]) {
  struct PicturePoint point = {0.0, 0.0};
  for (int i = 0; i < 3; i++) {
    point.right += view->right[i] * position[i];
    point.up += view->up[i] * position[i];
  }
  return point;
}

/* Appends a polyline, or a dot if it has one point. */
static void append_path(struct Icon *icon, enum Look look, const struct PicturePoint *points, size_t count) {
  append_shape(&icon->drawing, look, count == 1, points, count);
}

static struct PicturePoint point_of_object(const struct StartScene *scene, size_t object) {
  const Node *position = scene->samples.objects[object].position;
  return projected(&scene->view,
                   (double[]){scene->values[position[0]], scene->values[position[1]], scene->values[position[2]]});
}

static struct PicturePoint point_of_end(const struct StartScene *scene, const struct LineEnd *end) {
  const double *values = scene->line_values;
  return projected(&scene->view,
                   (double[]){values[end->position[0]], values[end->position[1]], values[end->position[2]]});
}

/* Appends the outline of a box, an ellipsoid, or a cylinder about one of its axes, as rings of points. */
static void append_solid(struct Icon *icon, enum Look look, const struct Solid *solid, enum ShapeType type, int axis) {
  const double pi = acos(-1.0);
  bool is_round = type == SHAPE_SPHERE || type == SHAPE_ELLIPSOID;
  int rings = is_round ? RINGS : 2, corners = type == SHAPE_BOX ? 4 : ROUND, count = rings * corners;
  struct PicturePoint points[RINGS * ROUND];
  for (int i = 0; i < count; i++) {
    int ring = i / corners;
    double share = (double)ring / (rings - 1) - 0.5, angle = 2.0 * pi * (i % corners + 0.5) / corners;
    double out = is_round ? cos(pi * share) : type == SHAPE_BOX ? sqrt(2.0) : 1.0, along[3], position[3];
    along[axis] = is_round ? sin(pi * share) : 2.0 * share;
    along[(axis + 1) % 3] = out * cos(angle);
    along[(axis + 2) % 3] = out * sin(angle);
    for (int k = 0; k < 3; k++) {
      position[k] = solid->middle[k];
      for (int j = 0; j < 3; j++) position[k] += along[j] * solid->half[j] * solid->axis[j][k];
      if (!isfinite(position[k])) return;
    }
    points[i] = projected(&icon->scene->view, position);
  }
  append_hull(&icon->drawing, look, look != LINK, points, (size_t)count);
}

/* Sets the pose of the frame or particle that a shape is in. */
static void set_pose(const struct StartScene *scene, const struct ContactShape *shape, double origin[3],
                     double rotation[3][3]) {
  const struct Pose *pose = &scene->model->mechanism.frames[shape->frame].pose;
  const struct Body *body = shape->particle != NO_PARTICLE ? &scene->model->mechanism.bodies[shape->particle] : NULL;
  double angle = body != NULL && body->has_angle ? scene->values[body->angle.node] : 0.0;
  const double in_plane[3][3] = {{cos(angle), -sin(angle), 0.0}, {sin(angle), cos(angle), 0.0}, {0.0, 0.0, 1.0}};
  for (int i = 0; i < 3; i++) {
    origin[i] = scene->values[body != NULL ? body->position[i].node : pose->origin.along[i]];
    for (int j = 0; j < 3; j++)
      rotation[i][j] = body != NULL ? in_plane[i][j] : scene->values[pose->rotation.row[i].along[j]];
  }
}

/* Appends a shape: a plane as a thin plate, a mesh not at all. */
static void append_shape_of(struct Icon *icon, const struct ContactShape *shape) {
  const double *values = icon->scene->values;
  bool is_plane = shape->type == SHAPE_PLANE, is_sized = shape->type == SHAPE_BOX || shape->type == SHAPE_ELLIPSOID;
  struct Solid solid = {.half = {0.0, 0.0, 0.0}};
  double rotation[3][3];
  if (shape->is_hidden || shape->type == SHAPE_MESH) return;
  set_pose(icon->scene, shape, solid.middle, rotation);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      solid.middle[i] += rotation[i][j] * values[shape->offset.along[j]];
      for (int k = 0; k < 3; k++) solid.axis[k][i] += rotation[i][j] * values[shape->rotation.row[j].along[k]];
    }
    solid.half[i] = is_sized ? 0.5 * values[shape->size.along[i]] : is_plane ? 0.5 * icon->size : values[shape->radius];
  }
  if (!is_sized && shape->type != SHAPE_SPHERE) solid.half[shape->axis] = 0.5 * values[shape->length];
  if (is_plane) solid.half[shape->axis] = 0.0;
  append_solid(icon, is_plane ? GROUND : SOLID, &solid, is_plane ? SHAPE_BOX : shape->type, shape->axis);
}

static bool has_shape(const struct Model *model, const struct Body *body) {
  bool has = false;
  for (size_t i = 0; i < model->mechanism.shape_count; i++) {
    const struct ContactShape *shape = &model->mechanism.shapes[i];
    bool is_in_frame = body->is_in_frame && body->frame != BASE_FRAME && shape->frame == body->frame;
    bool is_drawn = !shape->is_hidden && shape->type != SHAPE_PLANE && shape->type != SHAPE_MESH && shape->in != NULL;
    has |= is_drawn && (strcmp(shape->in, body->name) == 0 || is_in_frame);
  }
  return has;
}

/* Appends a body without a shape: a box of its moments of inertia in space, a bar in the plane, a dot for a particle. */
static void append_body(struct Icon *icon, const struct Body *body, struct PicturePoint at) {
  const double *values = icon->scene->values, mass = values[body->mass.node];
  const struct Matrix *orientation = &icon->scene->model->mechanism.frames[body->frame].pose.rotation;
  struct Solid solid;
  double trace = 0.0, half = sqrt(3.0 * values[body->inertia.node] / mass);
  double right = half * cos(values[body->angle.node]), up = half * sin(values[body->angle.node]);
  for (int i = 0; i < 3; i++) trace += values[body->tensor.row[i].along[i]];
  for (int i = 0; i < 3; i++) {
    solid.middle[i] = values[body->position[i].node];
    solid.half[i] = sqrt(fmax(1.5 * (trace - 2.0 * values[body->tensor.row[i].along[i]]) / mass, 0.0));
    for (int k = 0; k < 3; k++) solid.axis[k][i] = values[orientation->row[i].along[k]];
  }
  if (body->has_angle && isfinite(right + up) && !has_described_lines(&icon->scene->model->drawing))
    append_path(icon, BAR, (struct PicturePoint[]){{at.right - right, at.up - up}, {at.right + right, at.up + up}}, 2);
  else if (trace > 0.0) append_solid(icon, SOLID, &solid, SHAPE_BOX, 2);
  else if (mass > 0.0 && !body->has_angle && icon->scene->samples.object_count <= MOST_DOTS)
    append_path(icon, PARTICLE, &at, 1);
}

/* Appends a rod with a radius. */
static void append_thick(struct Icon *icon, struct PicturePoint from, struct PicturePoint to, double radius) {
  double length = hypot(to.right - from.right, to.up - from.up);
  double right = radius * (to.up - from.up) / length, up = -radius * (to.right - from.right) / length;
  if (isfinite(right + up))
    append_hull(&icon->drawing, SOLID, true,
                (struct PicturePoint[]){{from.right + right, from.up + up},
                                        {to.right + right, to.up + up},
                                        {to.right - right, to.up - up},
                                        {from.right - right, from.up - up}},
                4);
}

/* Appends a circle about the first end of a line through the second. */
static void append_circle(struct Icon *icon, const struct DrawnLine *line) {
  struct Solid disk = {.axis = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  double square = 0.0;
  for (int i = 0; i < 3; i++) {
    disk.middle[i] = icon->scene->line_values[line->ends[0].position[i]];
    double out = icon->scene->line_values[line->ends[1].position[i]] - disk.middle[i];
    square += i == line->axis ? 0.0 : out * out;
  }
  for (int i = 0; i < 3; i++) disk.half[i] = i == line->axis ? 0.0 : sqrt(square);
  append_solid(icon, LINK, &disk, SHAPE_CYLINDER, line->axis);
}

/* Appends a line of <line>; all but rods with a radius, circles and supports as simple lines. */
static void append_drawn_line(struct Icon *icon, const struct DrawnLine *line) {
  struct PicturePoint from = point_of_end(icon->scene, &line->ends[0]);
  struct PicturePoint to = has_two_ends(line) ? point_of_end(icon->scene, &line->ends[1]) : from;
  double foot = 0.08 * icon->size;
  enum Look look = line->kind == LINE_GROUND ? GROUND : LINK;
  if (!isfinite(from.right + from.up + to.right + to.up)) return;
  if (line->kind == LINE_PIVOT) {
    append_hull(&icon->drawing, GROUND, true,
                (struct PicturePoint[]){
                    from, {from.right - 0.6 * foot, from.up - foot}, {from.right + 0.6 * foot, from.up - foot}},
                3);
    append_path(icon, JOINT, &from, 1);
  } else if (line->kind == LINE_HOOP || line->kind == LINE_WHEEL) append_circle(icon, line);
  else if (line->kind == LINE_ROD && line->radius_formula != NULL)
    append_thick(icon, from, to, icon->scene->line_values[line->radius]);
  else append_path(icon, look, (struct PicturePoint[]){from, to}, 2);
}

/* Appends a line from a planar body, or from another object, to its joint. */
static void append_joint(struct Icon *icon, const struct SceneJoint *joint) {
  const struct SceneObject *body = &icon->scene->samples.objects[joint->of];
  double angle = icon->scene->values[body->angle], x = joint->coordinates[0], y = joint->coordinates[1];
  struct PicturePoint from = point_of_object(icon->scene, joint->of);
  struct PicturePoint to = {from.right + x * cos(angle) - y * sin(angle), from.up + x * sin(angle) + y * cos(angle)};
  append_path(icon, LINK, (struct PicturePoint[]){from, to}, 2);
  append_path(icon, JOINT, &to, 1);
}

/* Appends rods and joints, which are shown only without lines of the author. */
static void append_guesses(struct Icon *icon) {
  const struct StartScene *scene = icon->scene;
  struct PicturePoint origin = {0.0, 0.0};
  for (size_t i = 0; i < scene->connections.rod_count; i++)
    append_path(icon, LINK,
                (struct PicturePoint[]){point_of_object(scene, scene->connections.rods[i].from),
                                        point_of_object(scene, scene->connections.rods[i].to)},
                2);
  for (size_t i = 0; i < scene->connections.joint_count; i++) append_joint(icon, &scene->connections.joints[i]);
  append_path(icon, JOINT, &origin, 1);
}

/* Returns the extent of all objects and lines. */
static double size_of(const struct StartScene *scene) {
  struct Drawing points = {.count = 0};
  for (size_t i = 0; i < scene->samples.object_count; i++) {
    struct PicturePoint point = point_of_object(scene, i);
    bool is_seen = i > 0 || !has_described_lines(&scene->model->drawing);
    if (is_seen && isfinite(point.right + point.up)) append_shape(&points, JOINT, true, &point, 1);
  }
  for (size_t i = 0; i < 2 * scene->model->drawing.count; i++) {
    const struct DrawnLine *line = &scene->model->drawing.lines[i / 2];
    struct PicturePoint point = point_of_end(scene, &line->ends[has_two_ends(line) ? i % 2 : 0]);
    if (isfinite(point.right + point.up)) append_shape(&points, JOINT, true, &point, 1);
  }
  struct Rectangle all = rectangle_of(&points);
  return fmax(fmax(all.most.right - all.least.right, all.most.up - all.least.up), 0.0);
}

static void append_mechanism(struct Icon *icon) {
  const struct Model *model = icon->scene->model;
  const struct SampledPositions *samples = &icon->scene->samples;
  icon->size = size_of(icon->scene);
  if (!has_described_lines(&model->drawing) && samples->object_count > 1) append_guesses(icon);
  for (size_t i = 0; i < model->drawing.count; i++) append_drawn_line(icon, &model->drawing.lines[i]);
  for (size_t i = 0; i < model->mechanism.shape_count; i++) append_shape_of(icon, &model->mechanism.shapes[i]);
  for (size_t i = samples->object_count; i-- > 1;) {
    struct PicturePoint point = point_of_object(icon->scene, i);
    const struct Body *body = samples->objects[i].body;
    if (!isfinite(point.right + point.up)) continue;
    if (body != NULL && !has_shape(model, body)) append_body(icon, body, point);
  }
}

/* Appends a block with an arrow on each side. */
static void append_block(struct Icon *icon) {
  struct PicturePoint corners[] = {{-1.2, -1.2}, {1.2, -1.2}, {1.2, 1.2}, {-1.2, 1.2}};
  icon->drawing.count = 0;
  append_hull(&icon->drawing, SOLID, true, corners, 4);
  for (int side = 0; side < 2; side++) {
    double from = side == 0 ? -1.9 : 1.2, to = from + 0.7;
    append_path(icon, SIGNAL, (struct PicturePoint[]){{from, 0}, {to, 0}, {to - 0.14, 0.1}, {to, 0}, {to - 0.14, -0.1}},
                5);
  }
  fit_drawing(&icon->drawing);
}

struct Drawing icon_of(const struct StartScene *scene) {
  struct Icon icon = {.scene = scene};
  append_mechanism(&icon);
  if (!fit_drawing(&icon.drawing)) append_block(&icon);
  return icon.drawing;
}

struct Drawing flange_icon(void) {
  struct PicturePoint centre = {PICTURE_SIZE / 2.0, PICTURE_SIZE / 2.0};
  struct Drawing drawing = {.count = 0};
  append_shape(&drawing, RIM, true, &centre, 1);
  append_shape(&drawing, FLANGE, true, &centre, 1);
  return drawing;
}
