#include "system_drawing.h"

#include <math.h>

#include "base/memory.h"
#include "line_drawing.h"
#include "scene/configurations.h"
#include "scene/connections.h"
#include "scene/surfaces.h"
#include "shape_drawing.h"
#include "solids.h"

/*
 * Objects up to which unconnected ones get a line from the origin, and up to which particles are large dots. Bodies up
 * to which each has its name beside it.
 */
enum { MOST_WAYS = 8, MOST_DOTS = 60, MOST_LABELS = 8 };

/* The visible parts of the system at its start values. */
struct VisibleParts {
  struct SampledPositions samples;
  struct Connections connections;
  struct Surfaces surfaces;
  double *values;      /* of all nodes, in SI units */
  double *line_values; /* of the nodes of the lines' graph; NULL without lines, when rods and joints are guessed */
  struct View view;
  bool is_in_space;
};

/* Axes of the picture: of the plane of x and y, of that of x and z, or none in space. */
enum Plane { IN_XY, IN_XZ, IN_SPACE };

/*
 * Returns the view: planar systems with x to the right and y or z up; others oblique from above, with gravity
 * downwards.
 */
static struct View view_of(const struct Model *model, enum Plane plane) {
  const double azimuth = -1.1, elevation = 0.35;
  struct View view = {{1, 0, 0}, {0, 1, 0}};
  int up = 2;
  for (int axis = 0; axis < 3; axis++)
    if (model->mechanism.gravity.along[axis] != ZERO) up = axis;
  if (plane == IN_XZ) return (struct View){{1, 0, 0}, {0, 0, 1}};
  if (plane == IN_XY) return view;
  int first = (up + 1) % 3, second = (up + 2) % 3;
  view.right[up] = 0.0;
  view.right[first] = -sin(azimuth);
  view.right[second] = cos(azimuth);
  view.up[up] = cos(elevation);
  view.up[first] = -sin(elevation) * cos(azimuth);
  view.up[second] = -sin(elevation) * sin(azimuth);
  return view;
}

static struct PicturePoint picture_point_of(const struct VisibleParts *visible, size_t object) {
  const Node *position = visible->samples.objects[object].position;
  const double *values = visible->values;
  return projected(&visible->view, (double[]){values[position[0]], values[position[1]], values[position[2]]});
}

/* Returns the position of a point given in the axes of a planar body, or relative to another object. */
static struct PicturePoint point_on_picture(const struct VisibleParts *visible, size_t object, double x, double y) {
  const struct SceneObject *body = &visible->samples.objects[object];
  double angle = body->is_planar ? visible->values[body->angle] : 0.0;
  struct PicturePoint point = picture_point_of(visible, object);
  return (struct PicturePoint){point.right + x * cos(angle) - y * sin(angle),
                               point.up + x * sin(angle) + y * cos(angle)};
}

/* Appends a planar body as a uniform bar of its moment of inertia m l^2/12. */
static void append_bar(struct Drawing *drawing, const struct Body *body, struct PicturePoint middle,
                       const double *values) {
  double half = sqrt(3.0 * values[body->inertia.node] / values[body->mass.node]), angle = values[body->angle.node];
  double right = half * cos(angle), up = half * sin(angle);
  if (isfinite(right) && isfinite(up))
    append_line(drawing, BAR, (struct PicturePoint){middle.right - right, middle.up - up},
                (struct PicturePoint){middle.right + right, middle.up + up});
}

/* Returns the projection of a point onto the surface. */
static struct PicturePoint projection_onto(const struct SceneSurface *surface, struct PicturePoint point) {
  double height =
      (point.right - surface->point[0]) * surface->normal[0] + (point.up - surface->point[1]) * surface->normal[1];
  return (struct PicturePoint){point.right - height * surface->normal[0], point.up - height * surface->normal[1]};
}

/* Appends a hatched line, as long as the objects above it; short for a stop. */
static void append_surface(struct Drawing *drawing, const struct SceneSurface *surface, double size) {
  enum { HATCHES = 12 };
  double half = surface->is_stop ? 0.12 * size : 0.4 * size;
  double along[2] = {surface->normal[1], -surface->normal[0]}, low = -half, high = half;
  for (size_t i = 0; i < drawing->count && !surface->is_stop; i++)
    for (size_t j = 0; j < drawing->shapes[i].count; j++) {
      struct PicturePoint foot = projection_onto(surface, drawing->shapes[i].points[j]);
      double offset = (foot.right - surface->point[0]) * along[0] + (foot.up - surface->point[1]) * along[1];
      low = fmin(low, offset - 0.12 * size);
      high = fmax(high, offset + 0.12 * size);
    }
  double depth = 0.05 * size;
  int hatches = surface->is_stop ? HATCHES / 3 : HATCHES;
  for (int i = 0; i <= hatches; i++) {
    double offset = low + (high - low) * i / hatches;
    struct PicturePoint at = {surface->point[0] + offset * along[0], surface->point[1] + offset * along[1]};
    struct PicturePoint behind = {at.right - depth * (surface->normal[0] + along[0]),
                                  at.up - depth * (surface->normal[1] + along[1])};
    append_line(drawing, GROUND, at, behind);
  }
  append_line(drawing, GROUND,
              (struct PicturePoint){surface->point[0] + low * along[0], surface->point[1] + low * along[1]},
              (struct PicturePoint){surface->point[0] + high * along[0], surface->point[1] + high * along[1]});
}

/* Appends a square of a plane in space around its point. */
static void append_plane(struct Drawing *drawing, const struct View *view, const struct SceneSurface *surface,
                         double size) {
  double first[3] = {0.0, 0.0, 0.0}, second[3], corner[3];
  struct PicturePoint corners[5];
  int least = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(surface->normal[i]) < fabs(surface->normal[least])) least = i;
  first[(least + 1) % 3] = surface->normal[(least + 2) % 3];
  first[(least + 2) % 3] = -surface->normal[(least + 1) % 3];
  double length = hypot(hypot(first[0], first[1]), first[2]), half = surface->is_stop ? 0.12 * size : 0.4 * size;
  for (int i = 0; i < 3; i++) first[i] /= length;
  for (int i = 0; i < 3; i++)
    second[i] = surface->normal[(i + 1) % 3] * first[(i + 2) % 3] - surface->normal[(i + 2) % 3] * first[(i + 1) % 3];
  for (int k = 0; k < 5; k++) {
    double a = k == 1 || k == 2 ? half : -half, b = k == 2 || k == 3 ? half : -half;
    for (int i = 0; i < 3; i++) corner[i] = surface->point[i] + a * first[i] + b * second[i];
    corners[k] = projected(view, corner);
  }
  append_shape(drawing, GROUND, true, corners, 4);
  append_shape(drawing, GROUND, false, corners, 5);
}

static bool is_particle(const struct SceneObject *object) {
  return object->body != NULL && !object->is_planar && !is_solid(object->body);
}

/* True if a rod or a joint connects the object, or if it is not a particle. */
static bool is_attached(const struct VisibleParts *visible, size_t object) {
  const struct Connections *connections = &visible->connections;
  bool attached = !is_particle(&visible->samples.objects[object]);
  for (size_t k = 0; k < connections->rod_count; k++)
    attached |= connections->rods[k].from == object || connections->rods[k].to == object;
  for (size_t k = 0; k < connections->joint_count; k++) attached |= connections->joints[k].with == object;
  return attached;
}

/* Appends the base's axes, and lines from the origin to unconnected objects. */
static void append_axes(struct Drawing *drawing, const struct VisibleParts *visible, double size) {
  struct PicturePoint origin = {0.0, 0.0};
  for (int axis = 0; axis < (visible->is_in_space ? 3 : 2); axis++) {
    double tip[3] = {0.0, 0.0, 0.0};
    tip[axis] = 0.3 * size;
    append_line(drawing, AXIS, origin, projected(&visible->view, tip));
  }
  for (size_t i = 1; i < visible->samples.object_count && visible->samples.object_count <= MOST_WAYS; i++)
    if (!is_attached(visible, i)) append_line(drawing, AXIS, origin, picture_point_of(visible, i));
}

/* Appends the solids, rods and bars, and the lines from bodies to their joints; dots are drawn over them. */
static void append_bodies(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model) {
  const struct SampledPositions *samples = &visible->samples;
  const struct Connections *connections = &visible->connections;
  for (size_t i = 0; i < model->mechanism.shape_count; i++)
    append_drawn_shape(drawing, &visible->view, model, &model->mechanism.shapes[i], visible->values);
  for (size_t i = 0; i < samples->object_count; i++)
    if (samples->objects[i].body != NULL && is_solid(samples->objects[i].body) &&
        !has_drawn_shape(model, samples->objects[i].body))
      append_solid(drawing, &visible->view, model, samples->objects[i].body, visible->values);
  if (has_described_lines(&model->drawing)) return;
  for (size_t i = 0; i < connections->rod_count; i++)
    append_line(drawing, LINK, picture_point_of(visible, connections->rods[i].from),
                picture_point_of(visible, connections->rods[i].to));
  for (size_t i = 0; i < connections->joint_count; i++)
    append_line(drawing, LINK, picture_point_of(visible, connections->joints[i].of),
                point_on_picture(visible, connections->joints[i].of, connections->joints[i].coordinates[0],
                                 connections->joints[i].coordinates[1]));
  for (size_t i = 0; i < samples->object_count; i++)
    if (samples->objects[i].is_planar)
      append_bar(drawing, samples->objects[i].body, picture_point_of(visible, i), visible->values);
}

static void append_pivot(struct Drawing *drawing, struct PicturePoint point) {
  append_shape(drawing, BASE, true, &point, 1);
  append_shape(drawing, HOLE, true, &point, 1);
}

/* Appends dots and joints; the origin last, on top. With lines, only dots of particles that have no shape. */
static void append_points(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model) {
  const struct SampledPositions *samples = &visible->samples;
  bool is_guessed = !has_described_lines(&model->drawing);
  for (size_t i = samples->object_count; i-- > 1;) {
    const struct SceneObject *object = &samples->objects[i];
    struct PicturePoint point = picture_point_of(visible, i);
    bool is_ball = is_particle(object) && object->body->mass.node != ZERO && samples->object_count <= MOST_DOTS;
    bool is_shown = is_guessed || (is_ball && !has_drawn_shape(model, object->body));
    if (!object->is_planar && is_shown) append_shape(drawing, is_ball ? PARTICLE : JOINT, true, &point, 1);
  }
  if (!is_guessed) return;
  for (size_t i = 0; i < visible->connections.joint_count; i++) {
    const struct SceneJoint *joint = &visible->connections.joints[i];
    append_pivot(drawing, point_on_picture(visible, joint->of, joint->coordinates[0], joint->coordinates[1]));
  }
  append_pivot(drawing, picture_point_of(visible, 0));
}

/* True if no earlier contact has the same plane. */
static bool is_first(const struct Surfaces *surfaces, size_t surface) {
  const struct SceneSurface *last = &surfaces->items[surface];
  bool is_new = true;
  for (size_t i = 0; i < surface && !last->is_stop; i++) {
    const struct SceneSurface *other = &surfaces->items[i];
    double away = 0.0;
    for (int axis = 0; axis < 3; axis++)
      away = fmax(away,
                  fmax(fabs(last->point[axis] - other->point[axis]), fabs(last->normal[axis] - other->normal[axis])));
    is_new &= other->is_stop || away > 1e-9;
  }
  return is_new;
}

/* Returns the surface with its point nearest to the object's start position. */
static struct SceneSurface surface_at_contact(const struct VisibleParts *visible, struct SceneSurface met) {
  const Node *position = visible->samples.objects[met.object].position;
  double height = 0.0;
  if (met.is_stop) return met;
  for (int axis = 0; axis < 3; axis++) height += (visible->values[position[axis]] - met.point[axis]) * met.normal[axis];
  for (int axis = 0; axis < 3; axis++) met.point[axis] = visible->values[position[axis]] - height * met.normal[axis];
  return met;
}

static void append_surfaces(struct Drawing *drawing, const struct VisibleParts *visible, double size) {
  for (size_t i = 0; i < visible->surfaces.count; i++) {
    struct SceneSurface surface = surface_at_contact(visible, visible->surfaces.items[i]);
    if (!is_first(&visible->surfaces, i)) continue;
    if (visible->is_in_space) append_plane(drawing, &visible->view, &surface, size);
    else append_surface(drawing, &surface, size);
  }
}

static void append_drawing(struct Drawing *drawing, const struct Drawing *other) {
  for (size_t i = 0; i < other->count; i++) {
    const struct PictureShape *shape = &other->shapes[i];
    append_shape(drawing, shape->look, shape->is_filled, shape->points, shape->count);
  }
}

static bool is_finite(const struct Rectangle *all) {
  return isfinite(all->least.right) && isfinite(all->least.up) && isfinite(all->most.right) && isfinite(all->most.up);
}

/* Drawings of lines may lie in the plane of x and z; surfaces and joints that are guessed need space for z. */
static enum Plane plane_of(const struct VisibleParts *visible, const struct Model *model) {
  bool has_y = false, has_z = false;
  for (size_t i = 0; i < visible->samples.object_count; i++) {
    has_y |= visible->samples.objects[i].position[1] != ZERO;
    has_z |= visible->samples.objects[i].position[2] != ZERO;
  }
  for (size_t i = 0; i < 2 * model->drawing.count; i++) {
    has_y |= model->drawing.lines[i / 2].ends[i % 2].position[1] != ZERO;
    has_z |= model->drawing.lines[i / 2].ends[i % 2].position[2] != ZERO;
  }
  if (!has_z) return IN_XY;
  return has_y || !has_described_lines(&model->drawing) ? IN_SPACE : IN_XZ;
}

static struct VisibleParts visible_parts_of(const struct Model *model) {
  struct Configurations everything = configurations_of(model, NULL);
  struct VisibleParts visible = {.samples = sample_positions(model, true, NULL),
                                 .values = values_at(&everything, NULL)};
  visible.connections = find_connections(&visible.samples);
  visible.surfaces = find_surfaces(&visible.samples);
  if (visible.values == NULL) visible.values = graph_evaluate(model->graph, start_values(model));
  visible.line_values = values_of_lines(model, visible.values);
  enum Plane plane = plane_of(&visible, model);
  visible.is_in_space = plane != IN_XY;
  visible.view = view_of(model, plane);
  return visible;
}

/* Appends the ends of lines as dots, which gives the drawing its size. */
static void append_ends(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model) {
  for (size_t i = 0; i < 2 * model->drawing.count; i++) {
    const struct DrawnLine *line = &model->drawing.lines[i / 2];
    double position[3];
    if (i % 2 == 1 && !has_two_ends(line)) continue;
    position_of_end(&line->ends[i % 2], visible->line_values, position);
    struct PicturePoint point = projected(&visible->view, position);
    if (isfinite(point.right) && isfinite(point.up)) append_shape(drawing, JOINT, true, &point, 1);
  }
}

static double size_of(const struct Rectangle *all) {
  return fmax(all->most.right - all->least.right, all->most.up - all->least.up);
}

/* Appends the planes among the shapes, below the last object. */
static void append_planes(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model,
                          double size) {
  for (size_t i = 0; i < model->mechanism.shape_count; i++) {
    struct SceneSurface surface = {.object = visible->samples.object_count - 1};
    if (!find_drawn_plane(model, &model->mechanism.shapes[i], visible->values, surface.point, surface.normal)) continue;
    surface = surface_at_contact(visible, surface);
    if (visible->is_in_space) append_plane(drawing, &visible->view, &surface, size);
    else append_surface(drawing, &surface, size);
  }
}

static void append_lines(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model,
                         double size) {
  for (size_t i = 0; i < model->drawing.count; i++)
    append_drawn_line(drawing, &visible->view, &model->drawing.lines[i], visible->line_values, size);
}

/* Draws the author's lines, and shapes on them. Returns false if there are none. */
static bool draw_lines(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model) {
  struct Drawing bodies = {.count = 0};
  append_bodies(&bodies, visible, model);
  append_points(&bodies, visible, model);
  struct Drawing extent = {.count = 0};
  append_drawing(&extent, &bodies);
  append_ends(&extent, visible, model);
  struct Rectangle all = rectangle_of(&extent);
  if (!is_finite(&all)) return false;
  append_planes(drawing, visible, model, size_of(&all));
  append_lines(drawing, visible, model, size_of(&all));
  append_drawing(drawing, &bodies);
  return true;
}

/* Draws rods, joints and surfaces that are found by samples. Returns false if there is nothing to see. */
static bool draw_guesses(struct Drawing *drawing, const struct VisibleParts *visible, const struct Model *model) {
  struct Drawing visible_objects = {.count = 0};
  append_bodies(&visible_objects, visible, model);
  append_points(&visible_objects, visible, model);
  struct Rectangle all = rectangle_of(&visible_objects);
  if (visible->samples.object_count <= 1 || !is_finite(&all)) return false;
  append_surfaces(&visible_objects, visible, size_of(&all));
  append_axes(drawing, visible, size_of(&all));
  append_lines(drawing, visible, model, size_of(&all));
  append_drawing(drawing, &visible_objects);
  return true;
}

/* Appends the names of the bodies, unless they are many, and the directions of the axes. */
static void annotate(struct Drawing *drawing, const struct VisibleParts *visible) {
  const struct SampledPositions *samples = &visible->samples;
  size_t bodies = 0;
  for (size_t i = 1; i < samples->object_count; i++) bodies += samples->objects[i].body != NULL;
  for (size_t i = 1; i < samples->object_count && bodies <= MOST_LABELS; i++)
    if (samples->objects[i].body != NULL) append_label(drawing, samples->objects[i].name, picture_point_of(visible, i));
  for (int axis = 0; axis < 3; axis++) {
    double direction[3] = {0.0, 0.0, 0.0};
    direction[axis] = 1.0;
    drawing->axes[axis] = projected(&visible->view, direction);
  }
}

static bool draw_mechanism(struct Drawing *drawing, const struct Model *model) {
  struct VisibleParts visible = visible_parts_of(model);
  bool has_drawn = has_described_lines(&model->drawing) && draw_lines(drawing, &visible, model);
  bool is_seen = has_drawn || draw_guesses(drawing, &visible, model);
  annotate(drawing, &visible);
  release_positions(&visible.samples);
  release(visible.values);
  release(visible.line_values);
  return is_seen && fit_drawing(drawing);
}

/* Appends arrows at the block, one for each variable up to MOST_SIGNALS. */
static void append_signals(struct Drawing *drawing, size_t count, double from) {
  enum { MOST_SIGNALS = 6 };
  size_t shown = count < MOST_SIGNALS ? count : MOST_SIGNALS;
  for (size_t i = 0; i < shown; i++) {
    double up = 1.0 - 2.0 * ((double)i + 0.5) / (double)shown, tip = from + 0.7;
    append_line(drawing, SIGNAL, (struct PicturePoint){from, up}, (struct PicturePoint){tip, up});
    append_shape(drawing, SIGNAL, false,
                 (struct PicturePoint[]){{tip - 0.14, up + 0.1}, {tip, up}, {tip - 0.14, up - 0.1}}, 3);
  }
}

static void draw_block(struct Drawing *drawing, const struct Model *model) {
  const struct PicturePoint corners[5] = {{-1.2, -1.2}, {1.2, -1.2}, {1.2, 1.2}, {-1.2, 1.2}, {-1.2, -1.2}};
  *drawing = (struct Drawing){.count = 0};
  append_shape(drawing, BOX, true, corners, 4);
  append_shape(drawing, BOX, false, corners, 5);
  append_signals(drawing, model->inputs.count, -1.9);
  append_signals(drawing, model->outputs.count + model->coordinates.count, 1.2);
  fit_drawing(drawing);
  drawing->pixels = 0.0;
}

struct Drawing drawing_of(const struct Model *model) {
  struct Drawing drawing = {.count = 0};
  if (!draw_mechanism(&drawing, model)) draw_block(&drawing, model);
  return drawing;
}
