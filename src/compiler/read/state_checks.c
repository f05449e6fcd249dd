#include "read/stages.h"

#include "algebra/differentiate.h"
#include "base/memory.h"

/* An element that needs a derivative of a state. */
struct DerivativeNeed {
  const struct Reader *reader;
  long line;
  const char *what; /* such as "the position of 'bob'" */
  bool is_second;
};

static const struct Variable *state_of(const struct Model *model, Node symbol) {
  return &model->states.items[graph_symbol_of(model->graph, symbol)->index];
}

/* Returns the first symbol of these kinds in a node; NULL for none. */
static const struct Symbol *first_of(const struct Model *model, Node node, unsigned kinds) {
  const struct Gradient gradient = gradient_by_kinds(model->graph, node, kinds);
  return gradient.count > 0 ? graph_symbol_of(model->graph, gradient.symbols[0]) : NULL;
}

static void report_missing(const struct DerivativeNeed *need, const struct Variable *state, const struct Variable *of,
                           const struct Symbol *symbol, const char *remedy) {
  const char *way =
      of == state ? "whose rate depends on" : format_text("which depends on the rate of '%s', and so on", of->name);
  report_error(need->reader->diagnostics, need->line,
               "%s needs the %s derivative of the state '%s', %s '%s'; expected %s", need->what,
               need->is_second ? "second" : "time", state->name, way, symbol->name, remedy);
}

/* A rate with accelerations or forces would make the equations of motion depend on their own results. */
static bool follows_first(const struct DerivativeNeed *need, const struct Variable *state, const struct Variable *of) {
  const struct Symbol *symbol = first_of(need->reader->model, of->rate, KIND(ACCELERATION) | KIND(REACTION));
  if (symbol != NULL)
    report_missing(need, state, of, symbol, "a rate of coordinates, velocities, states, inputs and time");
  return symbol == NULL;
}

/* The time derivative of a rate contains accelerations and derivatives of inputs. */
static bool follows_second(const struct DerivativeNeed *need, const struct Variable *state) {
  const struct Model *model = need->reader->model;
  const struct Symbol *velocity = first_of(model, state->rate, KIND(VELOCITY));
  if (velocity != NULL) {
    report_missing(need, state, state, velocity,
                   "a rate of coordinates, states and time, as of a second <state> that follows the velocity");
    return false;
  }
  const struct Gradient inputs = gradient_by_kinds(model->graph, state->rate, KIND(INPUT));
  for (size_t i = 0; i < inputs.count; i++) {
    const struct Symbol *input = graph_symbol_of(model->graph, inputs.symbols[i]);
    if (model->prescribed.input_rates[input->index] != ZERO) continue;
    report_missing(need, state, state, input, "derivatives=\"1\" of this <input>");
    return false;
  }
  const struct Gradient others = gradient_by_kinds(model->graph, state->rate, KIND(STATE));
  for (size_t i = 0; i < others.count; i++)
    if (!follows_first(need, state, state_of(model, others.symbols[i]))) return false;
  return true;
}

/* Notes that a state moves a mass, so that moving the state takes work. */
static void note_moving_state(const struct DerivativeNeed *need, Node node) {
  struct Model *model = need->reader->model;
  model->prescribed.states_move |= graph_depends_on(model->graph, node, STATE);
}

static void require_derivatives(const struct DerivativeNeed *need, Node node) {
  const struct Model *model = need->reader->model;
  const struct Gradient states = gradient_by_kinds(model->graph, node, KIND(STATE));
  for (size_t i = 0; i < states.count; i++) {
    const struct Variable *state = state_of(model, states.symbols[i]);
    if (!follows_first(need, state, state) || (need->is_second && !follows_second(need, state))) return;
  }
}

/* In a <kinetic>, the rate of a state must not depend on coordinates, whose momentum it would change. */
static void require_free_rates(const struct DerivativeNeed *need, Node node) {
  const struct Model *model = need->reader->model;
  const struct Gradient states = gradient_by_kinds(model->graph, node, KIND(STATE));
  for (size_t i = 0; i < states.count; i++) {
    const struct Variable *state = state_of(model, states.symbols[i]);
    const struct Symbol *symbol = first_of(model, state->rate, KIND(COORDINATE) | KIND(VELOCITY));
    if (symbol != NULL)
      report_missing(need, state, state, symbol,
                     "a <particle> or <body> for what the state moves, or a rate of states, inputs and time");
  }
}

static void check_bodies(const struct Reader *reader) {
  const struct Mechanism *mechanism = &reader->model->mechanism;
  for (size_t i = 0; i < mechanism->body_count; i++) {
    const struct Body *body = &mechanism->bodies[i];
    struct DerivativeNeed need = {reader, body->line, format_text("the position of '%s'", body->name), true};
    const struct Pose *pose = &mechanism->frames[body->frame].pose;
    for (int component = 0; component < 4; component++) {
      bool has_mass = (component < 3 ? body->mass.node : body->inertia.node) != ZERO;
      if (!has_mass || body->is_in_frame) continue;
      require_derivatives(&need, body->displaced[component]);
      note_moving_state(&need, body->displaced[component]);
    }
    for (int axis = 0; axis < 3 && body->is_in_frame; axis++) {
      require_derivatives(&need, body->offset.along[axis]);
      require_derivatives(&need, pose->origin.along[axis]);
      note_moving_state(&need, pose->origin.along[axis]);
      for (int column = 0; column < 3; column++) require_derivatives(&need, pose->rotation.row[axis].along[column]);
      note_moving_state(&need, pose->rotation.row[axis].along[0]);
    }
  }
}

void check_moving_states(const struct Reader *reader) {
  const struct Model *model = reader->model;
  if (model->states.count == 0 || reader->diagnostics->errors > 0) return;
  check_bodies(reader);
  const struct DerivativeNeed of_energy = {reader, 0, "the kinetic energy", false};
  require_derivatives(&of_energy, model->energies.explicit_kinetic.node);
  require_free_rates(&of_energy, model->energies.explicit_kinetic.node);
  note_moving_state(&of_energy, model->energies.explicit_kinetic.node);
  for (size_t i = 0; i < model->constraints.count; i++) {
    const struct Variable *constraint = &model->constraints.items[i];
    bool is_second = !graph_depends_on(model->graph, constraint->node, VELOCITY);
    const struct DerivativeNeed need = {reader, constraint->line, format_text("the constraint '%s'", constraint->name),
                                        is_second};
    require_derivatives(&need, constraint->node);
  }
}
