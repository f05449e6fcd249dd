#include "read/space/frames.h"

#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/variables.h"
#include "names/definitions.h"
#include "names/similar.h"
#include "read/space/rotations.h"

static const char *const frame_components[] = {"x",   "y",   "z",   "R11", "R12", "R13", "R21",
                                               "R22", "R23", "R31", "R32", "R33", NULL};
static const char *const point_components[] = {"x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az", NULL};
static const char *const particle_components[] = {"x", "y", "z", "vx", "vy", "vz", NULL};
static const char *const planar_components[] = {"x", "y", "z", "angle", NULL};
static const char *const body_components[] = {"x",      "y",      "z",      "vx",     "vy", "vz", "omegaX", "omegaY",
                                              "omegaZ", "alphaX", "alphaY", "alphaZ", "wx", "wy", "wz",     NULL};

bool is_spatial(xmlNodePtr node) {
  if (is_element(node, "frame") || is_element(node, "point")) return true;
  return (is_element(node, "body") || is_element(node, "particle")) && has_attribute(node, "in");
}

static const char *const *components_of(xmlNodePtr node) {
  if (!is_spatial(node)) return planar_components;
  if (is_element(node, "frame")) return frame_components;
  if (is_element(node, "point")) return point_components;
  return is_element(node, "particle") ? particle_components : body_components;
}

/* Returns the time derivatives of the components. */
static struct Vector derivative_of(struct Scope *scope, struct Vector vector) {
  for (int i = 0; i < 3; i++) vector.along[i] = total_time_derivative(scope, vector.along[i]);
  return vector;
}

static void append_frame(struct Reader *reader, const char *name, struct ReferenceFrame frame) {
  struct Model *model = reader->model;
  size_t *index = allocate(1, sizeof *index);
  *index = model->mechanism.frame_count;
  model->mechanism.frames =
      make_room(model->mechanism.frames, model->mechanism.frame_count, sizeof *model->mechanism.frames);
  frame.name = copy_text(name);
  model->mechanism.frames[model->mechanism.frame_count++] = frame;
  names_set(reader->frames, name, index);
}

void frames_begin(struct Reader *reader) {
  reader->frames = names_create();
  reader->spatial_points = names_create();
  append_frame(reader, "base", (struct ReferenceFrame){.pose = pose_of_base()});
}

void declare_frame(struct Reader *reader, xmlNodePtr node) {
  xmlNodePtr rotation = quaternion_of(node);
  for (xmlNodePtr step = node->children; step != NULL; step = step->next)
    if (is_element(step, "rotate")) check_rotation(reader, step);
  if (rotation == NULL) return;
  char *name = name_attribute(reader, node, "name");
  if (name == NULL) return;
  struct Variable norm = {.name = format_text("%s.norm", name),
                          .description = format_text("norm of the quaternion of %s", name),
                          .unit = copy_text("1"),
                          .dimension = dimension_one,
                          .is_norm = true,
                          .line = scope_line(reader->scope, line_of(rotation))};
  reader->present->number = reader->model->constraints.count;
  append_variable(&reader->model->constraints, norm);
}

/*
 * Returns the name under which a whole frame, or a whole point or body, is collected. Its blank keeps it apart from
 * names of authors.
 */
static char *whole_name(bool is_frame, const char *name) {
  return format_text("%s %s", is_frame ? "frame" : "point", name);
}

static void collect(struct Reader *reader, xmlNodePtr node, char *name, const char *attribute) {
  /* Units of work charged for each named expression. */
  enum { DEFINITION_WORK = 400 };
  graph_work(reader->model->graph, DEFINITION_WORK);
  definitions_add(reader->definitions, name, &(struct NamedExpression){node, attribute, reader->source, NULL});
}

static bool is_base(struct Reader *reader, xmlNodePtr node, const char *name) {
  if (strcmp(name, "base") != 0) return false;
  report_at(reader, node, "the name 'base' belongs to the frame at rest; expected another name");
  return true;
}

void collect_frame(struct Reader *reader, xmlNodePtr node, const char *name) {
  if (!is_base(reader, node, name)) collect(reader, node, whole_name(true, name), "");
}

/* True if a frame, or a point or body in a frame, of this name was collected. */
static bool is_collected(const struct Reader *reader, bool is_frame, const char *name) {
  char *whole = whole_name(is_frame, name);
  return definitions_contain(reader->definitions, whole);
}

/* True if a frame, point or body of this name was collected, which is reported. */
static bool is_taken(struct Reader *reader, xmlNodePtr node, const char *name) {
  bool taken = is_collected(reader, true, name) || is_collected(reader, false, name);
  if (taken)
    report_at(reader, node, "a frame, point or body named '%s' is already defined; expected another name", name);
  return taken;
}

void collect_spatial(struct Reader *reader, xmlNodePtr node, const char *name) {
  const char *const *components = components_of(node);
  if (is_base(reader, node, name) || is_taken(reader, node, name)) return;
  collect(reader, node, whole_name(is_element(node, "frame"), name), "");
  for (size_t i = 0; components[i] != NULL; i++)
    collect(reader, node, format_text("%s.%s", name, components[i]), components[i]);
}

/* Returns the full name of the frame that an attribute names, "base" if it is missing; NULL after an error. */
static char *frame_name(struct Reader *reader, xmlNodePtr node, const char *attribute_name) {
  char *text = attribute(node, attribute_name);
  bool is_in_base = text == NULL || strcmp(text, "base") == 0;
  return is_in_base ? copy_text("base") : reference_attribute(reader, node, attribute_name);
}

/* Reports a name that is not a frame. The error of a frame that was collected has already been reported. */
static void report_unknown_frame(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct SimilarName similar = {.wanted = name};
  if (definitions_are_waiting(reader->definitions) || is_collected(reader, true, name)) return;
  similar_consider_all(&similar, reader->frames);
  report_at(reader, node, "there is no frame '%s'; %s", name,
            suggestion(similar.best, "expected the name of a <frame>"));
}

const struct ReferenceFrame *find_frame(const struct Reader *reader, const char *name) {
  const size_t *index = names_find(reader->frames, name);
  if (index != NULL) return &reader->model->mechanism.frames[*index];
  const struct SpatialPoint *point = names_find(reader->spatial_points, name);
  return point != NULL && point->is_body ? &reader->model->mechanism.frames[point->frame] : NULL;
}

const struct ReferenceFrame *frame_of_attribute(struct Reader *reader, xmlNodePtr node, const char *name) {
  char *frame_named = frame_name(reader, node, name);
  const struct ReferenceFrame *frame = frame_named != NULL ? find_frame(reader, frame_named) : NULL;
  if (frame == NULL && frame_named != NULL) report_unknown_frame(reader, node, frame_named);
  return frame;
}

/* Returns the frame that an element is in. NULL after an error, or if the current definition waits for it. */
static const struct ReferenceFrame *parent_of(struct Reader *reader, xmlNodePtr node) {
  char *name = frame_name(reader, node, "in");
  if (name == NULL) return NULL;
  char *whole = whole_name(true, name);
  const size_t *index = names_find(reader->frames, name);
  bool waits = index == NULL && definitions_wait_for(reader->definitions, whole);
  if (index == NULL && !waits) report_unknown_frame(reader, node, name);
  return index != NULL ? &reader->model->mechanism.frames[*index] : NULL;
}

/* Reads a length along each axis from the attributes x, y and z, and its time derivative. */
static void read_offset(struct Reader *reader, xmlNodePtr node, struct Vector *offset, struct Vector *rate) {
  for (int i = 0; i < 3; i++) {
    struct Quantity length = {.node = ZERO};
    if (expression_attribute(reader, node, axes[i], IN_POSITION, &length) &&
        !definitions_are_waiting(reader->definitions))
      require_unit(reader, line_of_attribute(node, axes[i]), axes[i], length, unit_of("m"));
    offset->along[i] = length.node;
    rate->along[i] = total_time_derivative(reader->scope, length.node);
  }
}

static void translate(struct Reader *reader, xmlNodePtr node, struct Pose *pose) {
  struct Vector offset, rate;
  read_offset(reader, node, &offset, &rate);
  pose_translate(reader->model->graph, pose, offset, rate);
}

/* Returns a component of a planar body. The current definition waits for one that has not been read. */
static Node planar_component(struct Reader *reader, xmlNodePtr node, const char *body, const char *component) {
  if (!has_attribute(node, component)) return ZERO;
  char *name = format_text("%s.%s", body, component);
  const struct Quantity *value = scope_find(reader->scope, name);
  if (value == NULL) definitions_wait_for(reader->definitions, name);
  return value != NULL ? value->node : ZERO;
}

static void append_step(struct Graph *graph, struct ReferenceFrame *frame, const struct Pose *step) {
  APPEND(frame->steps, frame->step_count, *step);
  pose_follow(graph, &frame->pose, step);
}

/* Appends the translation to the centre of mass and the rotation by the angle. */
static void append_steps_of_planar_body(struct Reader *reader, xmlNodePtr node, const char *name,
                                        struct ReferenceFrame *frame) {
  struct Graph *graph = reader->model->graph;
  struct Pose translation = pose_of_base(), rotation = pose_of_base();
  struct Vector origin = {{planar_component(reader, node, name, "x"), planar_component(reader, node, name, "y"),
                           planar_component(reader, node, name, "z")}};
  Node angle = planar_component(reader, node, name, "angle");
  pose_translate(graph, &translation, origin, derivative_of(reader->scope, origin));
  pose_rotate(graph, &rotation, (struct Vector){{ZERO, ZERO, ONE}}, angle, total_time_derivative(reader->scope, angle));
  append_step(graph, frame, &translation);
  append_step(graph, frame, &rotation);
}

/* Appends the translations and rotations of a frame that begins with the pose of its parent. */
static void read_steps(struct Reader *reader, xmlNodePtr node, const char *name, struct ReferenceFrame *frame) {
  struct Graph *graph = reader->model->graph;
  if (frame->is_of_body) append_steps_of_planar_body(reader, node, name, frame);
  for (xmlNodePtr element = node->children; element != NULL; element = element->next) {
    bool is_translation = is_element(element, "translate");
    if (!is_translation && !is_element(element, "rotate")) continue;
    struct Pose step = pose_of_base();
    if (is_translation) translate(reader, element, &step);
    else rotate(reader, element, &step);
    append_step(graph, frame, &step);
  }
}

static void read_frame(struct Reader *reader, xmlNodePtr node, const char *name) {
  const struct ReferenceFrame *parent = parent_of(reader, node);
  if (parent == NULL) return;
  struct ReferenceFrame frame = {.parent = (size_t)(parent - reader->model->mechanism.frames),
                                 .is_of_body = is_element(node, "body"),
                                 .pose = parent->pose};
  read_steps(reader, node, name, &frame);
  if (definitions_are_waiting(reader->definitions)) return;
  struct Model *model = reader->model;
  for (int i = 0; i < 3; i++) {
    model->prescribed.inputs_move |= graph_depends_on(model->graph, frame.pose.origin.along[i], INPUT);
    for (int j = 0; j < 3; j++)
      model->prescribed.inputs_move |= graph_depends_on(model->graph, frame.pose.rotation.row[i].along[j], INPUT);
  }
  if (names_find(reader->frames, name) == NULL) append_frame(reader, name, frame);
}

static void read_point(struct Reader *reader, xmlNodePtr node, const char *name) {
  struct Graph *graph = reader->model->graph;
  const struct ReferenceFrame *frame = parent_of(reader, node);
  if (frame == NULL) return;
  struct SpatialPoint *point = allocate(1, sizeof *point);
  struct Vector rate;
  read_offset(reader, node, &point->offset, &rate);
  point->is_body = is_element(node, "body");
  point->frame = (size_t)(frame - reader->model->mechanism.frames);
  point->position = position_at(graph, &frame->pose, point->offset);
  point->velocity = velocity_at(graph, &frame->pose, point->offset, rate);
  bool is_new = !definitions_are_waiting(reader->definitions) && names_find(reader->spatial_points, name) == NULL;
  if (is_new) names_set(reader->spatial_points, name, point);
}

bool find_spatial_point(const struct Reader *reader, const char *name, struct SpatialPoint *point) {
  const struct SpatialPoint *known = names_find(reader->spatial_points, name);
  const struct ReferenceFrame *frame = known == NULL ? find_frame(reader, name) : NULL;
  if (known != NULL) *point = *known;
  else if (frame != NULL)
    *point = (struct SpatialPoint){.frame = (size_t)(frame - reader->model->mechanism.frames),
                                   .position = frame->pose.origin,
                                   .velocity = frame->pose.velocity};
  return known != NULL || frame != NULL;
}

bool waits_for_element(struct Reader *reader, const char *name) {
  char *frame = whole_name(true, name), *point = whole_name(false, name);
  return definitions_wait_for(reader->definitions, frame) || definitions_wait_for(reader->definitions, point);
}

static struct Vector acceleration_of(struct Scope *scope, const struct Pose *pose, struct Vector velocity) {
  struct Graph *graph = scope->graph;
  struct Vector turning = vector_cross(graph, pose->angular_velocity, velocity);
  return vector_add(graph, derivative_of(scope, velocity), turning);
}

/* Returns the vector that a component such as "vx" or "omegaX" belongs to. */
static struct Vector vector_of(struct Scope *scope, const struct Pose *pose, const struct SpatialPoint *point,
                               const char *component) {
  struct Graph *graph = scope->graph;
  if (strncmp(component, "omega", 5) == 0) return pose->angular_velocity;
  if (component[0] == 'w') return matrix_apply(graph, &pose->rotation, pose->angular_velocity);
  if (strncmp(component, "alpha", 5) == 0) return derivative_of(scope, pose->angular_velocity);
  if (component[0] == 'v') return matrix_apply(graph, &pose->rotation, point->velocity);
  if (component[0] == 'a') return matrix_apply(graph, &pose->rotation, acceleration_of(scope, pose, point->velocity));
  return point->position;
}

static const char *unit_of_component(const char *component) {
  if (component[0] == 'R') return "1";
  if (strcmp(component, "angle") == 0) return "rad";
  if (strncmp(component, "omega", 5) == 0 || component[0] == 'w') return "rad/s";
  if (strncmp(component, "alpha", 5) == 0) return "rad/s2";
  return component[0] == 'v' ? "m/s" : component[0] == 'a' ? "m/s2" : "m";
}

static Node read_component(struct Reader *reader, const char *name, const char *component) {
  struct SpatialPoint point;
  if (!find_spatial_point(reader, name, &point)) return ZERO; /* the error has been reported */
  const struct Pose *pose = &reader->model->mechanism.frames[point.frame].pose;
  if (component[0] == 'R') return pose->rotation.row[component[1] - '1'].along[component[2] - '1'];
  char axis = component[strlen(component) - 1];
  struct Vector vector = vector_of(reader->scope, pose, &point, component);
  return vector.along[axis >= 'x' ? axis - 'x' : axis - 'X'];
}

struct Quantity read_spatial(struct Reader *reader, xmlNodePtr node, const char *name, const char *attribute) {
  struct Quantity value = {.node = ZERO};
  bool is_frame = is_element(node, "frame") || !is_spatial(node);
  if (*attribute == '\0') {
    const char *of = strchr(name, ' ') + 1;
    if (is_frame) read_frame(reader, node, of);
    else read_point(reader, node, of);
    return value;
  }
  char *of = format_text("%.*s", (int)(strlen(name) - strlen(attribute) - 1), name), *whole = whole_name(is_frame, of);
  if (!definitions_wait_for(reader->definitions, whole)) value.node = read_component(reader, of, attribute);
  value.dimension = unit_of(unit_of_component(attribute));
  return value;
}

static char *description_of(const char *name, const char *component) {
  if (strcmp(component, "angle") == 0) return format_text("angle of %s", name);
  char axis = component[strlen(component) - 1];
  const char *what = strncmp(component, "omega", 5) == 0   ? "angular velocity"
                     : strncmp(component, "alpha", 5) == 0 ? "angular acceleration"
                     : component[0] == 'v'                 ? "velocity"
                     : component[0] == 'a'                 ? "acceleration"
                                                           : "position";
  if (component[0] == 'R')
    return format_text("component along the base's %c of the %c axis of %s", "xyz"[component[1] - '1'],
                       "xyz"[component[2] - '1'], name);
  if (axis < 'x') return format_text("%s of %s along its own %c axis", what, name, axis - 'X' + 'x');
  return format_text("%c %s of %s", axis, what, name);
}

void append_element_variables(struct Reader *reader, xmlNodePtr node, const char *name) {
  const char *const *components = components_of(node);
  for (size_t i = 0; components[i] != NULL; i++) {
    char *full_name = format_text("%s.%s", name, components[i]);
    const struct Quantity *value = scope_find(reader->scope, full_name);
    if (value == NULL || components[i][0] == 'w') continue; /* for expressions only; omegaX, ... are the same vector */
    struct Variable variable = {.name = full_name,
                                .description = description_of(name, components[i]),
                                .unit = copy_text(unit_of_component(components[i])),
                                .dimension = value->dimension,
                                .node = without_displacements(reader, line_of(node), full_name, value->node)};
    append_variable(&reader->model->mechanism.element_variables, variable);
  }
}

static bool is_inside(const struct Model *model, size_t frame, size_t outer) {
  while (frame != outer && frame != 0) frame = model->mechanism.frames[frame].parent;
  return frame == outer;
}

/* Returns the mean of the moments of inertia that the quaternion rotates, which keeps M well conditioned. */
static Node inertia_of_norm(const struct Model *model, size_t frame) {
  struct Graph *graph = model->graph;
  Node sum = ZERO;
  for (size_t i = 0; i < model->mechanism.body_count; i++) {
    const struct Body *body = &model->mechanism.bodies[i];
    if (!body->is_in_frame || !is_inside(model, body->frame, frame)) continue;
    for (int axis = 0; axis < 3; axis++) {
      Node lever_arm = body->frame == frame ? body->offset.along[axis] : ZERO;
      if (!graph_is_constant_in_time(graph, lever_arm)) lever_arm = ZERO;
      Node moment = multiply(graph, body->mass.node, power_number(graph, lever_arm, 2.0));
      sum = add(graph, sum, add(graph, body->tensor.row[axis].along[axis], moment));
    }
  }
  return scale(graph, 1.0 / 3.0, sum);
}

void add_regularization_of_norm(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  if (quaternion_of(node) == NULL) return;
  char *name = name_attribute(reader, node, "name");
  const size_t *frame = name != NULL ? names_find(reader->frames, name) : NULL;
  if (frame != NULL) {
    const struct Variable *norm = &model->constraints.items[reader->present->number];
    APPEND(model->mechanism.regularizations, model->mechanism.regularization_count,
           (struct Regularization){norm->node, inertia_of_norm(model, *frame)});
  }
}
