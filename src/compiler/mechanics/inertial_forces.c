#include "mechanics/inertial_forces.h"

#include "algebra/differentiate.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/time_derivative.h"
#include "mechanics/virtual_work.h"

/* True if the regularized constraint is nonholonomic. */
static bool is_rate(const struct Graph *graph, Node constraint) {
  return graph_depends_on(graph, constraint, VELOCITY);
}

/* Collects m r'' and I phi'' of particles and planar bodies. Points without mass add nothing. */
static struct VirtualWork work_on_positions(const struct Model *model, const Node *seeds, enum SymbolKind kind) {
  struct Graph *graph = model->graph;
  struct VirtualWork work = {0};
  Node *rate = allocate(4 * model->mechanism.body_count, sizeof *rate);
  for (size_t i = 0; i < model->mechanism.body_count; i++)
    for (int component = 0; component < 4 && !model->mechanism.bodies[i].is_in_frame; component++)
      rate[4 * i + (size_t)component] =
          component < 3 ? model->mechanism.bodies[i].position[component].node : model->mechanism.bodies[i].angle.node;
  derivative_along(graph, rate, 4 * model->mechanism.body_count, seeds, rate);
  derivative_along(graph, rate, 4 * model->mechanism.body_count, seeds, rate);
  for (size_t i = 0; i < model->mechanism.body_count; i++) {
    const struct Body *body = &model->mechanism.bodies[i];
    for (int component = 0; component < 4 && !body->is_in_frame; component++) {
      Node inertia = component < 3 ? body->mass.node : body->inertia.node, position = body->displaced[component];
      if (kind == COORDINATE) position = component < 3 ? body->position[component].node : body->angle.node;
      virtual_work_add(&work, position, multiply(graph, inertia, rate[4 * i + (size_t)component]));
    }
  }
  for (size_t i = 0; i < model->mechanism.regularization_count && kind == COORDINATE; i++) {
    Node moved = model->mechanism.regularizations[i].constraint, acceleration = moved;
    if (is_rate(graph, moved)) continue;
    derivative_along(graph, &acceleration, 1, seeds, &acceleration);
    derivative_along(graph, &acceleration, 1, seeds, &acceleration);
    virtual_work_add(&work, moved, multiply(graph, model->mechanism.regularizations[i].inertia, acceleration));
  }
  return work;
}

/* Returns the inertial time derivative of a vector along rotating axes: v' + omega x v. */
static struct Vector rate_in_frame(struct Graph *graph, const Node *seeds, struct Derivatives *rates,
                                   struct Vector spin, struct Vector vector) {
  struct Vector carried = vector_cross(graph, spin, vector);
  derivatives_find(graph, vector.along, 3, seeds, rates, vector.along);
  return vector_add(graph, vector, carried);
}

static struct VirtualWork work_on_velocities(const struct Model *model, const Node *seeds, enum SymbolKind kind) {
  struct Graph *graph = model->graph;
  struct VirtualWork work = {0};
  struct Derivatives rates = {0};
  for (size_t i = 0; i < model->mechanism.body_count; i++) {
    const struct Body *body = &model->mechanism.bodies[i];
    if (!body->is_in_frame) continue;
    bool displaced = kind != COORDINATE;
    struct Vector velocity = displaced ? body->displaced_velocity : body->velocity;
    struct Vector spin = displaced ? body->displaced_angular_velocity : body->angular_velocity;
    struct Vector momentum = matrix_apply(graph, &body->tensor, body->angular_velocity);
    struct Vector force = {{ZERO, ZERO, ZERO}};
    if (body->mass.node != ZERO)
      force = vector_scale(graph, body->mass.node,
                           rate_in_frame(graph, seeds, &rates, body->angular_velocity, body->velocity));
    struct Vector torque = rate_in_frame(graph, seeds, &rates, body->angular_velocity, momentum);
    for (int axis = 0; axis < 3; axis++) {
      virtual_work_add(&work, velocity.along[axis], force.along[axis]);
      virtual_work_add(&work, spin.along[axis], torque.along[axis]);
    }
  }
  for (size_t i = 0; i < model->mechanism.regularization_count && kind == COORDINATE; i++) {
    Node moved = model->mechanism.regularizations[i].constraint, acceleration = moved;
    if (!is_rate(graph, moved)) continue;
    derivative_along(graph, &acceleration, 1, seeds, &acceleration);
    virtual_work_add(&work, moved, multiply(graph, model->mechanism.regularizations[i].inertia, acceleration));
  }
  return work;
}

Node *inertial_forces(const struct Model *model, const Node *seeds, enum SymbolKind kind, size_t count) {
  struct Graph *graph = model->graph;
  const struct VirtualWork positions = work_on_positions(model, seeds, kind);
  const struct VirtualWork velocities = work_on_velocities(model, seeds, kind);
  Node *force = virtual_work_along(graph, &positions, kind, count);
  if (kind != COORDINATE) {
    virtual_work_add_along_rates(graph, &velocities, kind, count, force);
    return force;
  }
  const Node *along = virtual_work_along(graph, &velocities, VELOCITY, count);
  for (size_t i = 0; i < count; i++) force[i] = add(graph, force[i], along[i]);
  return force;
}

Node energy_of_regularization(const struct Model *model) {
  struct Graph *graph = model->graph;
  Node *seeds = time_seeds(model, false), energy = ZERO;
  for (size_t i = 0; i < model->mechanism.regularization_count; i++) {
    Node rate = model->mechanism.regularizations[i].constraint;
    if (!is_rate(graph, rate)) derivative_along(graph, &rate, 1, seeds, &rate);
    Node term = multiply(graph, model->mechanism.regularizations[i].inertia, power_number(graph, rate, 2.0));
    energy = add(graph, energy, scale(graph, 0.5, term));
  }
  return energy;
}
