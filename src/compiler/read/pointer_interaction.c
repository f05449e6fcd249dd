#include "read/stages.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/variables.h"
#include "read/space/forces.h"

/* Largest number of bodies with a force, which bounds the size of the equations of long chains. */
enum { MOST_PULLED = 30 };

/* The inputs of the pointer. */
struct Pointer {
  struct Vector position; /* m, position of the pointer */
  struct Vector grabbed;  /* m, grabbed point relative to the body's position, along the body's axes */
  Node time;              /* s, ratio of damping to stiffness */
};

static Node append_pointer_input(struct Reader *reader, const char *name, const char *unit) {
  struct Variable variable = variable_create(format_text("pull.%s", name), NULL, 0);
  variable.unit = copy_text(unit);
  variable.dimension = unit_of(unit);
  variable.start = 0.0;
  return append_input(reader, variable);
}

static struct Vector append_vector(struct Reader *reader, const char *const names[3]) {
  struct Vector vector;
  for (int axis = 0; axis < 3; axis++) vector.along[axis] = append_pointer_input(reader, names[axis], "m");
  return vector;
}

/* Returns the vector from the body's position to the grabbed point; zero for a body without orientation. */
static struct Vector lever_arm_of(const struct Model *model, const struct Body *body, struct Vector grabbed) {
  struct Graph *graph = model->graph;
  if (body->is_in_frame) return matrix_apply(graph, &model->mechanism.frames[body->frame].pose.rotation, grabbed);
  if (!body->has_angle || !body->has_position[0] || !body->has_position[1]) return (struct Vector){{ZERO, ZERO, ZERO}};
  Node sine = function(graph, SINE, body->displaced[3], ZERO),
       cosine = function(graph, COSINE, body->displaced[3], ZERO);
  Node across = multiply(graph, cosine, grabbed.along[0]), along = multiply(graph, sine, grabbed.along[0]);
  across = subtract(graph, across, multiply(graph, sine, grabbed.along[1]));
  along = add(graph, along, multiply(graph, cosine, grabbed.along[1]));
  return (struct Vector){{across, along, ZERO}};
}

static struct Vector grabbed_point(const struct Model *model, const struct Body *body, struct Vector grabbed) {
  struct Vector point, lever_arm = lever_arm_of(model, body, grabbed);
  for (int axis = 0; axis < 3; axis++)
    point.along[axis] =
        body->has_position[axis] ? add(model->graph, body->displaced[axis], lever_arm.along[axis]) : ZERO;
  return point;
}

static bool moves(const struct Graph *graph, const struct Vector *point) {
  bool found = false;
  for (int axis = 0; axis < 3; axis++) found |= graph_depends_on(graph, point->along[axis], COORDINATE);
  return found;
}

/* Adds the force stiffness (pointer - point - time d point/dt) at the grabbed point. */
static void pull_body(struct Reader *reader, const struct Body *body, const struct Pointer *pointer) {
  struct Graph *graph = reader->model->graph;
  struct Vector grabbed = grabbed_point(reader->model, body, pointer->grabbed);
  if (!moves(graph, &grabbed)) return;
  Node stiffness = append_pointer_input(reader, format_text("of.%s", body->name), "N/m");
  for (int axis = 0; axis < 3; axis++) {
    Node point = without_displacements(reader, body->line, body->name, grabbed.along[axis]);
    Node behind = multiply(graph, pointer->time, total_time_derivative(reader->scope, point));
    Node away = subtract(graph, subtract(graph, pointer->position.along[axis], point), behind);
    add_force_along(reader, body->line, body->name, grabbed.along[axis], multiply(graph, stiffness, away));
  }
}

void add_pointer_interaction(struct Reader *reader) {
  static const char *const position[] = {"x", "y", "z"}, *const grabbed[] = {"u", "v", "w"};
  struct Model *model = reader->model;
  size_t count = model->mechanism.body_count, every = count / MOST_PULLED + 1;
  struct Pointer pointer = {.position = append_vector(reader, position), .grabbed = append_vector(reader, grabbed)};
  pointer.time = append_pointer_input(reader, "time", "s");
  model->forces.any = true;
  /* Includes the last body: the end of a chain is the natural part to pull. */
  for (size_t i = (count + every - 1) % every; i < count; i += every)
    pull_body(reader, &model->mechanism.bodies[i], &pointer);
}
