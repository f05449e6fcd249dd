#include "derivation.h"

#include "algebra/differentiate.h"
#include "algebra/polynomials/rational.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "freedom.h"
#include "mechanics/switching.h"
#include "model/time_derivative.h"

/* Most coordinates and bodies of a system whose derivation is shown, so that a page stays small. */
enum { COORDINATE_LIMIT = 5, BODY_LIMIT = 6 };

/* Most coordinates for which the accelerations are solved for in fractions. */
enum { SOLVED_LIMIT = 3 };

/* Data that all steps use; arrays have one element for each coordinate. */
struct Derivation {
  struct Page *page;
  const struct Model *model;
  const struct Equations *equations;
  const char *lagrangian_name, *reaction_name, *force_name; /* L, R and Q, or words if the system has these */
  Node lagrangian, *momentum, *gradient, *momentum_rate, *force;
};

static const char *coordinate_name(const struct Derivation *derivation, size_t i) {
  return derivation->model->coordinates.items[i].name;
}

static const char *velocity_name(const struct Derivation *derivation, size_t i) {
  return derivation->model->velocities.items[i].name;
}

/* Returns a symbol, such as Q, with the name of a coordinate as its index. */
static char *symbol_along(const struct Derivation *derivation, const char *symbol, size_t i) {
  return format_text("%s[%s]", symbol, coordinate_name(derivation, i));
}

/* Finds dL/dv, dL/dq, d/dt dL/dv and the generalized forces Q, which include those of the dissipation. */
static struct Derivation derivation_of(struct Page *page) {
  const struct Model *model = page->model;
  struct Graph *graph = model->graph;
  size_t n = model->coordinates.count;
  struct Derivation derivation = {.page = page,
                                  .model = model,
                                  .equations = page->equations,
                                  .lagrangian_name = page_symbol(model, "L", "Lagrangian"),
                                  .reaction_name = page_symbol(model, "R", "reaction"),
                                  .force_name = page_symbol(model, "Q", "force"),
                                  .momentum = allocate(n, sizeof(Node)),
                                  .gradient = allocate(n, sizeof(Node)),
                                  .momentum_rate = allocate(n, sizeof(Node)),
                                  .force = allocate(n, sizeof(Node))};
  derivation.lagrangian =
      as_written(model, subtract(graph, model->energies.kinetic.node, model->energies.potential.node));
  gradient_of(graph, derivation.lagrangian, VELOCITY, n, derivation.momentum);
  gradient_of(graph, derivation.lagrangian, COORDINATE, n, derivation.gradient);
  derivative_along(graph, derivation.momentum, n, time_seeds(model, true), derivation.momentum_rate);
  gradient_of(graph, model->energies.dissipation.node, VELOCITY, n, derivation.force);
  for (size_t i = 0; i < n; i++)
    derivation.force[i] = as_written(model, subtract(graph, model->forces.along[i].node, derivation.force[i]));
  return derivation;
}

static void write_freedom(const struct Derivation *derivation) {
  const struct Model *model = derivation->model;
  size_t constraints = permanent_constraint_count(model), rank = constraint_rank(model, derivation->equations);
  size_t given = model->prescribed.motion_count, free_count = model->coordinates.count - given;
  page_step(derivation->page, "Degrees of freedom");
  char *text = format_text("Coordinates: %zu.", model->coordinates.count);
  if (given > 0) text = format_text("%s Prescribed ones: %zu.", text, given);
  if (constraints > 0) text = format_text("%s Constraints: %zu.", text, constraints);
  if (rank < constraints) text = format_text("%s Independent ones at the start: %zu.", text, rank);
  text = format_text("%s Degrees of freedom: %zu.", text, free_count - (rank < free_count ? rank : free_count));
  if (model->switches.contact_count > 0) text = format_text("%s Each closed contact takes one away.", text);
  page_paragraph(derivation->page, text);
}

/* Writes a position, or an angle, and its time derivative. */
static void write_position(const struct Derivation *derivation, const char *name, Node position) {
  struct Graph *graph = derivation->model->graph;
  Node rate;
  derivative_along(graph, &position, 1, time_seeds(derivation->model, true), &rate);
  page_step_equation(derivation->page, name, as_written(derivation->model, position));
  page_step_equation(derivation->page, format_text("der(%s)", name), as_written(derivation->model, rate));
}

static void write_body(const struct Derivation *derivation, const struct Body *body, const char *name) {
  for (int k = 0; k < 3; k++) {
    if (body->is_in_frame)
      page_step_equation(derivation->page, format_text("%s.v_%s", name, axes[k]), body->velocity.along[k]);
    else if (body->has_position[k])
      write_position(derivation, format_text("%s.%s", name, axes[k]), body->position[k].node);
  }
  for (int k = 0; k < 3 && body->is_in_frame; k++)
    page_step_equation(derivation->page, format_text("%s.omega_%s", name, axes[k]), body->angular_velocity.along[k]);
  if (!body->is_in_frame && body->has_angle)
    write_position(derivation, format_text("%s.angle", name), body->angle.node);
}

static void write_bodies(const struct Derivation *derivation) {
  const struct Mechanism *mechanism = &derivation->model->mechanism;
  size_t shown = mechanism->body_count < BODY_LIMIT ? mechanism->body_count : BODY_LIMIT;
  bool has_frames = false;
  if (shown == 0) return;
  page_step(derivation->page, "Positions and velocities");
  for (size_t i = 0; i < shown; i++) {
    const struct Body *body = &mechanism->bodies[i];
    has_frames |= body->is_in_frame;
    write_body(derivation, body, body->name != NULL ? body->name : format_text("mass[%zu]", i + 1));
  }
  page_rest(derivation->page, mechanism->body_count, shown, "bodies");
  if (has_frames)
    page_paragraph(derivation->page, "The velocity v of the centre of mass and the angular velocity ω of a body in a "
                                     "frame are along the frame's axes.");
}

static void write_partial_derivatives(const struct Derivation *derivation) {
  const char *name = derivation->lagrangian_name;
  page_step(derivation->page, "The Lagrangian and its derivatives");
  page_step_equation(derivation->page, name, derivation->lagrangian);
  for (size_t i = 0; i < derivation->equations->count; i++) {
    page_step_equation(derivation->page, format_text("diff(%s, %s)", name, velocity_name(derivation, i)),
                       derivation->momentum[i]);
    page_step_equation(derivation->page, format_text("diff(%s, %s)", name, coordinate_name(derivation, i)),
                       derivation->gradient[i]);
  }
  for (size_t i = 0; i < derivation->equations->count; i++)
    page_step_equation(derivation->page, format_text("der(diff(%s, %s))", name, velocity_name(derivation, i)),
                       derivation->momentum_rate[i]);
}

static void write_lagrange(const struct Derivation *derivation) {
  struct Page *page = derivation->page;
  const char *name = derivation->lagrangian_name;
  bool constrained = derivation->model->constraints.count > 0, has_forces = false;
  page_step(page, "Lagrange's equations");
  for (size_t i = 0; i < derivation->equations->count; i++) has_forces |= derivation->force[i] != ZERO;
  for (size_t i = 0; i < derivation->equations->count; i++) {
    char *left = format_text("der(diff(%s, %s)) - diff(%s, %s)", name, velocity_name(derivation, i), name,
                             coordinate_name(derivation, i));
    if (constrained) left = format_text("%s + %s", left, derivation->reaction_name);
    page_step_texts(page, left, has_forces ? symbol_along(derivation, derivation->force_name, i) : "0");
  }
  for (size_t i = 0; i < derivation->equations->count && has_forces; i++)
    page_step_equation(page, symbol_along(derivation, derivation->force_name, i), derivation->force[i]);
  page_paragraph(page, "Carried out, they are the equations of motion above.");
  if (constrained)
    page_paragraph(page,
                   format_text("Here %s is the sum over the constraints of λ times the derivative by the coordinate, "
                               "or by its velocity for a constraint on velocities.",
                               derivation->reaction_name));
}

/* Writes the elements of M and h in M(q) q'' + h(q, q', t) = Q. */
static void write_matrix_form(const struct Derivation *derivation) {
  const struct Model *model = derivation->model;
  struct Page *page = derivation->page;
  size_t n = derivation->equations->count;
  page_step(page, model->constraints.count > 0 ? "The form M(q) q″ + h(q, q′, t) + Jᵀλ = Q"
                                               : "The form M(q) q″ + h(q, q′, t) = Q");
  for (size_t i = 0; i < n; i++)
    for (size_t j = i; j < n; j++) {
      Node element = as_written(model, inertia_element(derivation->equations->inertia, i, j));
      if (element != ZERO) page_step_equation(page, format_text("M%zu%zu", i + 1, j + 1), element);
    }
  for (size_t i = 0; i < n; i++) {
    Node bias = subtract(model->graph, derivation->force[i], as_written(model, derivation->equations->right_side[i]));
    page_step_equation(page, format_text("h%zu", i + 1), bias);
  }
  page_paragraph(page, "M is symmetric; elements that are not listed are 0.");
}

/* Solves for two accelerations by Cramer's rule, whose determinants have no common factors as those of elimination. */
static void solve_pair(struct Display *display, const Node *m, const Node *right, Node *solution) {
  struct Graph *graph = display->graph;
  Node products[] = {subtract(graph, multiply(graph, m[0], m[3]), multiply(graph, m[1], m[2])),
                     subtract(graph, multiply(graph, m[3], right[0]), multiply(graph, m[1], right[1])),
                     subtract(graph, multiply(graph, m[0], right[1]), multiply(graph, m[2], right[0]))};
  for (int i = 0; i < 3; i++) products[i] = display_node(display, products[i]);
  for (int i = 0; i < 2; i++) solution[i] = divide(graph, products[i + 1], products[0]);
}

/*
 * Returns the accelerations as reduced fractions of displayed forms, in which cos(a - b) is one function; NULL for
 * large systems.
 */
static Node *fractions_of_accelerations(const struct Derivation *derivation) {
  struct Display *display = derivation->page->display;
  const struct Equations *equations = derivation->equations;
  size_t n = equations->count;
  Node *matrix = allocate(n * n, sizeof *matrix), *right = allocate(n, sizeof *right),
       *solution = allocate(n, sizeof *solution);
  if (n > SOLVED_LIMIT || derivation->model->constraints.count > 0) return NULL;
  for (size_t i = 0; i < n; i++) {
    right[i] = display_node(display, as_written(derivation->model, equations->right_side[i]));
    for (size_t j = 0; j < n; j++)
      matrix[i * n + j] =
          display_node(display, as_written(derivation->model, inertia_element(equations->inertia, i, j)));
  }
  if (n == 2) solve_pair(display, matrix, right, solution);
  return n == 2 || solve_fractions(display->graph, n, matrix, 1, right, solution) ? solution : NULL;
}

static void write_state_space(const struct Derivation *derivation) {
  const struct Model *model = derivation->model;
  const struct Equations *equations = derivation->equations;
  const Node *accelerations = fractions_of_accelerations(derivation);
  page_step(derivation->page, "State space x′ = f(x, u)");
  for (size_t i = 0; i < equations->count; i++)
    page_step_texts(derivation->page, format_text("der(%s)", coordinate_name(derivation, i)),
                    velocity_name(derivation, i));
  for (size_t i = 0; i < equations->count && accelerations != NULL; i++)
    page_step_equation(derivation->page, format_text("der(%s)", velocity_name(derivation, i)), accelerations[i]);
  if (accelerations == NULL)
    page_paragraph(derivation->page,
                   model->constraints.count > 0
                       ? "The accelerations and λ solve the equations of motion together with the second time "
                         "derivatives of the constraints; they are computed numerically in each evaluation."
                       : "The accelerations solve M q″ = Q - h; they are computed numerically in each evaluation.");
  page_paragraph(derivation->page,
                 "An equilibrium near the start, with A, B, C, D and eigenvalues there as numbers, is a "
                 "section of the live page, and comes from: lagrange-fmu show FILE --linear");
}

static bool conserves_energy(const struct Page *page) {
  const struct Model *model = page->model;
  Node whole = subtract(model->graph, model->energies.kinetic.node, model->energies.potential.node);
  return !model->forces.any && !model->energies.has_prescribed && model->prescribed.constraint == NULL &&
         page->summary->is_autonomous && !graph_depends_on(model->graph, whole, INPUT);
}

/* True if the momentum dL/dv of a coordinate is conserved: a cyclic coordinate on which nothing else acts. */
static bool is_cyclic(const struct Derivation *derivation, size_t i) {
  struct Graph *graph = derivation->model->graph;
  return !derivation->model->prescribed.motions[i].is_prescribed && is_unconstrained(derivation->equations, i) &&
         simplify_fraction(graph, derivation->gradient[i]) == ZERO &&
         simplify_fraction(graph, derivation->force[i]) == ZERO;
}

static void write_conserved(const struct Derivation *derivation) {
  struct Page *page = derivation->page;
  size_t count = 0;
  page_step(page, "Conserved quantities");
  if (conserves_energy(page)) {
    count++;
    page_step_equation(page, page_symbol(derivation->model, "E", "energy"),
                       add(page->model->graph, page->summary->kinetic, page->summary->potential));
  }
  for (size_t i = 0; i < derivation->equations->count; i++) {
    if (!is_cyclic(derivation, i)) continue;
    count++;
    page_step_equation(page, symbol_along(derivation, page_symbol(derivation->model, "p", "momentum"), i),
                       derivation->momentum[i]);
  }
  if (count == 0) page_paragraph(page, "Neither the energy nor the momentum of a coordinate is constant.");
  else if (page->model->switches.event_count + page->model->switches.contact_count > 0)
    page_paragraph(page, "They are constant between events.");
}

static void write_steps(struct Page *page) {
  struct Derivation derivation = derivation_of(page);
  page_fold(page, "step by step");
  write_freedom(&derivation);
  write_bodies(&derivation);
  write_partial_derivatives(&derivation);
  write_lagrange(&derivation);
  write_matrix_form(&derivation);
  write_state_space(&derivation);
  write_conserved(&derivation);
  page_end_fold(page);
}

void write_derivation(struct Page *page) {
  const struct Equations *equations = page->equations;
  if (page->model->linearized || equations->count == 0) return;
  bool is_large = equations->count > COORDINATE_LIMIT || inertia_has_trees(equations->inertia);
  page_heading(page, "Derivation");
  if (is_large)
    page_paragraph(page,
                   "The steps are shown for systems of at most 5 coordinates whose bodies form no tree of joints.");
  else write_steps(page);
}
