#include "mechanics/switching.h"

#include "algebra/cone.h"
#include "algebra/differentiate.h"
#include "algebra/node_list.h"
#include "algebra/rounding_bounds.h"
#include "algebra/simplify.h"
#include "base/memory.h"
#include "lagrangian.h"
#include "model/resting_velocities.h"
#include "model/time_derivative.h"

/* Appends the expressions of constraints, contacts, frictions and events, on which modes and velocities depend. */
static void append_laws(const struct Model *model, struct NodeList *roots) {
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < model->constraints.count; i++) append_node(roots, model->constraints.items[i].node);
  for (size_t i = 0; i < switches->contact_count; i++) {
    append_node(roots, switches->contacts[i].gap);
    append_node(roots, switches->contacts[i].restitution);
  }
  for (size_t i = 0; i < switches->friction_count; i++) {
    append_node(roots, switches->frictions[i].mode);
    append_node(roots, switches->frictions[i].velocity);
    append_node(roots, switches->frictions[i].stiction);
    append_node(roots, switches->frictions[i].stiction_back);
  }
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct Event *event = &switches->events[i];
    append_node(roots, event->condition);
    for (size_t j = 0; j < event->assignment_count; j++) append_node(roots, event->assignments[j].value);
  }
}

/* Collects the expressions that determine the motion. */
static struct NodeList roots_of(const struct Model *model, const struct Equations *equations) {
  struct NodeList roots = {0};
  for (size_t i = 0; i < row_count(equations); i++) append_node(&roots, equations->residual[i]);
  append_node(&roots, equations->power);
  append_nodes(&roots, equations->rates.nodes, equations->rates.count);
  append_laws(model, &roots);
  return roots;
}

/* True if the state determines the mode of a branch, and energies depend on it; the cone holds the energies. */
static bool holds_energy(const struct Model *model, const struct Branch *branch) {
  const unsigned of_state = 1u << COORDINATE | 1u << VELOCITY;
  return (branch->kinds & of_state) != 0 && cone_has(model->graph->cone, branch->mode);
}

/* Finds the branches of energies. Some only add a constant to them, so that their jumps show in no force. */
static void find_energies(const struct Model *model, const struct Equations *equations,
                          struct SwitchingExpressions *switching) {
  const struct Switches *switches = &model->switches;
  const Node energies[] = {equations->kinetic, equations->potential};
  switching->holds_energy = allocate(switches->branch_count, sizeof(bool));
  cone_collect(model->graph->cone, model->graph, energies, 2);
  for (size_t i = 0; i < switches->branch_count; i++)
    switching->holds_energy[i] = holds_energy(model, &switches->branches[i]);
}

/* Finds the branches whose modes occur in the roots, or in the indicators of such branches. */
static void find_branches(const struct Model *model, struct NodeList *roots, struct SwitchingExpressions *switching) {
  const struct Switches *switches = &model->switches;
  struct Cone *cone = model->graph->cone;
  bool *is_used = allocate(switches->branch_count, sizeof *is_used);
  for (size_t i = 0; i < switches->branch_count; i++) {
    is_used[i] = switching->holds_energy[i];
    if (is_used[i]) append_node(roots, switches->branches[i].indicator);
  }
  for (bool grown = switches->branch_count > 0; grown;) {
    grown = false;
    cone_collect(cone, model->graph, roots->nodes, roots->count);
    for (size_t i = 0; i < switches->branch_count; i++) {
      if (is_used[i] || !cone_has(cone, switches->branches[i].mode)) continue;
      is_used[i] = grown = true;
    }
    for (size_t i = 0; i < switches->branch_count && grown; i++)
      if (is_used[i]) append_node(roots, switches->branches[i].indicator);
  }
  switching->branches = allocate(switches->branch_count, sizeof(const struct Branch *));
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (!is_used[i]) continue;
    switching->holds_energy[switching->branch_count] = switching->holds_energy[i];
    switching->branches[switching->branch_count++] = &switches->branches[i];
  }
}

/* Finds the branches whose modes occur in no energy, rate of a state, law or indicator of an event. */
static void find_branches_of_forces(const struct Model *model, const struct Equations *equations,
                                    struct SwitchingExpressions *switching) {
  const struct Switches *switches = &model->switches;
  struct NodeList others = {0};
  append_node(&others, equations->kinetic);
  append_node(&others, equations->potential);
  append_nodes(&others, equations->rates.nodes, equations->rates.count);
  append_laws(model, &others);
  for (size_t i = 0; i < switches->friction_count; i++) {
    append_node(&others, switches->frictions[i].sliding);
    append_node(&others, switches->frictions[i].sliding_back);
  }
  for (size_t i = 0; i < switches->event_count; i++) {
    if (switches->events[i].passage != PASSAGE_SAMPLES) continue;
    append_node(&others, switches->events[i].sample.every);
    append_node(&others, switches->events[i].sample.offset);
  }
  for (size_t i = 0; i < switching->branch_count; i++)
    if (switching->branches[i]->is_last_sign) append_node(&others, switching->branches[i]->indicator);
  cone_collect(model->graph->cone, model->graph, others.nodes, others.count);
  switching->is_of_forces = allocate(switching->branch_count, sizeof(bool));
  for (size_t i = 0; i < switching->branch_count; i++) {
    const struct Branch *branch = switching->branches[i];
    switching->is_of_forces[i] = !branch->is_last_sign && !cone_has(model->graph->cone, branch->mode);
  }
}

/* Finds the time derivatives of nodes, which share what they have in common; ZERO for forces, whose rate is unknown. */
static void find_rates(const struct Model *model, const Node *nodes, size_t count, const Node *seeds, Node *rates) {
  for (size_t i = 0; i < count; i++)
    rates[i] = graph_depends_on(model->graph, nodes[i], ACCELERATION) ? ZERO : nodes[i];
  derivative_along(model->graph, rates, count, seeds, rates);
}

static Node rate_of(const struct Model *model, Node node, const Node *seeds) {
  Node rate;
  find_rates(model, &node, 1, seeds, &rate);
  return rate;
}

static Node indicator_of_contact(const struct Model *model, const struct Contact *contact) {
  return choose_node(model->graph, contact->mode, whole_constraint_force(model, contact->constraint), contact->gap);
}

/* Returns an expression that is positive while the force is between the limits of both directions. */
static Node stiction_margin(struct Graph *graph, const struct Friction *friction, Node force) {
  if (friction->stiction != friction->stiction_back) {
    Node forth = subtract(graph, friction->stiction, force), back = add(graph, friction->stiction_back, force);
    return multiply(graph, forth, back);
  }
  Node limit = power_number(graph, friction->stiction, 2.0);
  return subtract(graph, limit, power_number(graph, force, 2.0));
}

static Node indicator_of_friction(const struct Model *model, const struct Friction *friction) {
  struct Graph *graph = model->graph;
  if (friction->is_given) return ONE; /* its branch has the indicator */
  Node share = multiply(graph, friction->share, friction->sliding);
  Node force = add(graph, model->unknowns.forces[friction->constraint], share);
  Node left = stiction_margin(graph, friction, force);
  Node along = multiply(graph, friction->mode, friction->velocity);
  return choose_node(graph, power_number(graph, friction->mode, 2.0), along, left);
}

/* Returns the component of the velocity along the slip direction, or to the left of it. */
static Node velocity_along_slip(struct Graph *graph, const struct Friction *along, bool is_left) {
  Node first = multiply(graph, along[0].plane.slip_direction, along[is_left ? 1 : 0].velocity);
  Node second = multiply(graph, along[1].plane.slip_direction, along[is_left ? 0 : 1].velocity);
  return is_left ? subtract(graph, first, second) : add(graph, first, second);
}

/*
 * Returns the lower indicator of a friction in a plane, in units of the velocity. It falls through 0 if, while
 * sliding, the speed falls to lower. While slipping along the slip direction it does so if the velocity along it
 * falls to -lower; while sticking, if the force reaches the stiction. With a prescribed velocity at rest, it does
 * so if the speed rises to lower.
 */
static Node lower_indicator(const struct Model *model, const struct Friction *along) {
  struct Graph *graph = model->graph;
  Node lower = along->plane.lower, above = subtract(graph, divide(graph, square_of_speed(graph, along), lower), lower);
  Node left = along->is_given ? negate(graph, above) : power_number(graph, along->stiction, 2.0);
  for (int i = 0; i < 2 && !along->is_given; i++) {
    Node share = multiply(graph, along[i].sliding, along[i].plane.slip_direction);
    Node force = add(graph, model->unknowns.forces[along[i].constraint], share);
    left = subtract(graph, left, power_number(graph, force, 2.0));
  }
  Node ahead = add(graph, velocity_along_slip(graph, along, false), lower);
  Node moves = choose_node(graph, along->mode, above, ahead);
  return choose_node(graph, power_number(graph, along->mode, 2.0), moves, left);
}

/*
 * Returns the upper indicator. It falls through 0 if, while creeping, the speed rises to upper, or the velocity turns by
 * 90 degrees from the slip direction. While slipping along the slip direction it does so if the velocity perpendicular
 * to it rises to upper. With a negative upper it does so if the velocity along the slip direction falls to it.
 */
static Node upper_indicator(const struct Model *model, const struct Friction *along) {
  struct Graph *graph = model->graph;
  Node upper = along->plane.upper, ahead = velocity_along_slip(graph, along, false);
  Node aside = power_number(graph, velocity_along_slip(graph, along, true), 2.0);
  Node square = choose_node(graph, along->mode, square_of_speed(graph, along), aside);
  Node below = subtract(graph, upper, divide(graph, square, upper));
  Node creeps = divide(graph, multiply(graph, below, ahead), upper);
  Node bounded = choose_node(graph, along->mode, creeps, below);
  return choose_node(graph, upper, bounded, subtract(graph, ahead, upper));
}

static Node indicator_by_axis(const struct Model *model, const struct Friction *friction) {
  switch (friction->plane.axis) {
  case ALONG: return lower_indicator(model, friction);
  case ACROSS: return upper_indicator(model, friction - 1);
  default: return indicator_of_friction(model, friction);
  }
}

static void fill_indicators(const struct Model *model, const struct SwitchTable *counts,
                            struct SwitchingExpressions *switching) {
  switching->indicator_count = indicator_count(counts);
  switching->indicators = allocate(switching->indicator_count, sizeof(Node));
  for (size_t i = 0; i < counts->branch_count; i++) switching->indicators[i] = switching->branches[i]->indicator;
  for (size_t i = 0; i < counts->contact_count; i++)
    switching->indicators[contact_indicator(counts, i)] = indicator_of_contact(model, &model->switches.contacts[i]);
  for (size_t i = 0; i < counts->friction_count; i++)
    switching->indicators[friction_indicator(counts, i)] = indicator_by_axis(model, &model->switches.frictions[i]);
}

static void append_watched(const struct Model *model, const struct SwitchingExpressions *switching,
                           struct NodeList *list) {
  const struct Switches *switches = &model->switches;
  for (size_t i = 0; i < switching->branch_count; i++) append_node(list, switching->branches[i]->indicator);
  for (size_t i = 0; i < switches->contact_count; i++) append_node(list, switches->contacts[i].gap);
  for (size_t i = 0; i < switches->friction_count; i++) {
    append_node(list, switches->frictions[i].velocity);
    append_node(list, switches->frictions[i].stiction);
    append_node(list, switches->frictions[i].stiction_back);
  }
}

/* Bounds the rounding errors of the indicators of branches, of gaps, and of the velocities of frictions. */
static void fill_rounding_bounds(const struct Model *model, const struct SwitchTable *counts,
                                 struct SwitchingExpressions *switching) {
  Node *nodes = switching->rounding_bounds = allocate(indicator_count(counts), sizeof *nodes);
  for (size_t i = 0; i < counts->branch_count; i++) nodes[i] = switching->branches[i]->indicator;
  for (size_t i = 0; i < counts->contact_count; i++)
    nodes[contact_indicator(counts, i)] = model->switches.contacts[i].gap;
  for (size_t i = 0; i < counts->friction_count; i++)
    nodes[friction_indicator(counts, i)] = model->switches.frictions[i].velocity;
  rounding_bounds_of(model->graph, nodes, indicator_count(counts), nodes);
}

/* Appends the energies and momenta if a branch has holds_energy. */
static void append_energies(const struct Model *model, const struct Equations *equations,
                            struct SwitchingExpressions *switching, struct NodeList *list) {
  size_t n = model->coordinates.count, first = list->count;
  bool any = false;
  for (size_t i = 0; i < switching->branch_count; i++) any |= switching->holds_energy[i];
  if (!any) return;
  append_node(list, equations->kinetic);
  append_node(list, equations->potential);
  Node *momentum = allocate(n, sizeof *momentum);
  gradient_of(model->graph, model->energies.kinetic.node, VELOCITY, n, momentum);
  for (size_t i = 0; i < n && graph_depends_on(model->graph, model->energies.kinetic.node, MODE); i++)
    append_node(list, momentum[i]);
  switching->energy_count = list->count - first;
}

/* Returns the scale of the speed: over both velocities v and their v_i, the sum of |dv/dv_i| (|v_i| + nominal_i). */
static Node scale_of_plane(const struct Model *model, const struct Friction *along) {
  struct Graph *graph = model->graph;
  Node scale = ZERO;
  for (int axis = 0; axis < 2; axis++) {
    const struct Gradient gradient = gradient_by_kinds(graph, along[axis].velocity, 1u << VELOCITY);
    for (size_t i = 0; i < gradient.count; i++) {
      const struct Symbol *symbol = graph_symbol_of(graph, gradient.symbols[i]);
      double nominal = model->velocities.items[symbol->index].nominal;
      Node size = function(graph, ABSOLUTE, gradient.symbols[i], ZERO);
      size = add(graph, size, graph_constant(graph, isnan(nominal) ? 1.0 : nominal));
      Node slope = function(graph, ABSOLUTE, gradient.values[i], ZERO);
      Node term = multiply(graph, slope, size);
      scale = add(graph, scale, term);
    }
  }
  return scale;
}

static void append_planes(const struct Model *model, struct NodeList *list) {
  for (size_t i = 0; i < model->switches.friction_count; i++) {
    const struct Friction *friction = &model->switches.frictions[i];
    if (friction->plane.axis == ALONG) append_node(list, scale_of_plane(model, friction));
  }
}

/* Appends the period and the first time of each sample. */
static void append_samples(const struct Switches *switches, struct SwitchingExpressions *switching,
                           struct NodeList *list) {
  for (size_t i = 0; i < switches->event_count; i++) {
    const struct Event *event = &switches->events[i];
    if (event->passage != PASSAGE_SAMPLES) continue;
    append_node(list, event->sample.every);
    append_node(list, event->sample.offset);
    switching->sample_count++;
  }
}

static void fill_contacts(const struct Model *model, const struct SwitchTable *counts, const Node *seeds,
                          Node *values) {
  for (size_t i = 0; i < counts->contact_count; i++) {
    const struct Contact *contact = &model->switches.contacts[i];
    Node rate = rate_of(model, contact->gap, seeds);
    values[contact_slot(counts, i, CONTACT_GAP)] = contact->gap;
    values[contact_slot(counts, i, CONTACT_RATE)] = rate;
    values[contact_slot(counts, i, CONTACT_ACCELERATION)] = rate_of(model, rate, seeds);
    values[contact_slot(counts, i, CONTACT_RESTITUTION)] = contact->restitution;
  }
}

static void fill_frictions(const struct Model *model, const struct SwitchTable *counts, const Node *seeds,
                           Node *values) {
  for (size_t i = 0; i < counts->friction_count; i++) {
    const struct Friction *friction = &model->switches.frictions[i];
    values[friction_slot(counts, i, FRICTION_VELOCITY)] = friction->velocity;
    values[friction_slot(counts, i, FRICTION_RATE)] = rate_of(model, friction->velocity, seeds);
    values[friction_slot(counts, i, FRICTION_STICTION)] = friction->stiction;
    values[friction_slot(counts, i, FRICTION_FORCE)] = friction->sliding;
    values[friction_slot(counts, i, FRICTION_STICTION_BACK)] = friction->stiction_back;
    values[friction_slot(counts, i, FRICTION_FORCE_BACK)] = friction->sliding_back;
  }
}

static void fill_events(const struct Switches *switches, const struct SwitchTable *counts, Node *values) {
  size_t assignment = 0;
  for (size_t i = 0; i < counts->event_count; i++) {
    const struct Event *event = &switches->events[i];
    values[condition_slot(counts, i)] = event->condition;
    for (size_t j = 0; j < event->assignment_count; j++)
      values[assignment_slot(counts, assignment++)] = event->assignments[j].value;
  }
}

static struct SwitchTable count_switches(const struct Model *model, const struct SwitchingExpressions *switching) {
  const struct Switches *switches = &model->switches;
  struct SwitchTable counts = {.branch_count = switching->branch_count,
                               .contact_count = switches->contact_count,
                               .friction_count = switches->friction_count,
                               .event_count = switches->event_count};
  for (size_t i = 0; i < switches->event_count; i++) counts.assignment_count += switches->events[i].assignment_count;
  return counts;
}

static void fill_branches(const struct Model *model, const struct SwitchingExpressions *switching,
                          const struct SwitchTable *counts, const Node *seeds, Node *values) {
  for (size_t i = 0; i < counts->branch_count; i++) values[i] = switching->branches[i]->indicator;
  find_rates(model, values, counts->branch_count, seeds, &values[branch_rate_slot(counts, 0)]);
}

/* Appends all values, in the order of struct SwitchTable. */
static void append_values(const struct Model *model, const struct Equations *equations,
                          const struct SwitchTable *counts, struct SwitchingExpressions *switching,
                          struct NodeList *list) {
  size_t count = energy_slot(counts);
  Node *values = allocate(count, sizeof *values);
  Node *seeds = time_seeds(model, true);
  for (size_t i = 0; i < equations->rates.count; i++)
    seeds[model->graph->vertices[model->states.items[i].node].left] = equations->rates.nodes[i];
  fill_branches(model, switching, counts, seeds, values);
  fill_contacts(model, counts, seeds, values);
  fill_frictions(model, counts, seeds, values);
  fill_events(&model->switches, counts, values);
  append_nodes(list, values, count);
  append_energies(model, equations, switching, list);
  append_planes(model, list);
  append_samples(&model->switches, switching, list);
}

/* True if the friction depends on the contact force. */
static bool depends_on(const struct Model *model, const struct Friction *friction, const struct Contact *contact) {
  struct Cone *cone = model->graph->cone;
  cone_collect(cone, model->graph, &friction->sliding, 1);
  return cone_has(cone, model->unknowns.forces[contact->constraint]);
}

static void find_forces(const struct Model *model, struct SwitchingExpressions *switching) {
  const struct Switches *switches = &model->switches;
  bool *rests = allocate(switches->friction_count * switches->contact_count, sizeof *rests), any = false;
  for (size_t i = 0; i < switching->branch_count; i++) {
    switching->feels_forces |= graph_depends_on(model->graph, switching->branches[i]->indicator, ACCELERATION);
    switching->has_last_signs |= switching->branches[i]->is_last_sign;
  }
  for (size_t i = 0; i < switches->friction_count; i++) {
    switching->friction_varies |= !graph_is_constant_in_time(model->graph, switches->frictions[i].sliding) ||
                                  !graph_is_constant_in_time(model->graph, switches->frictions[i].sliding_back);
    for (size_t j = 0; j < switches->contact_count; j++)
      any |= rests[i * switches->contact_count + j] =
          depends_on(model, &switches->frictions[i], &switches->contacts[j]);
  }
  switching->rests = any ? rests : NULL;
}

/* True if the node depends on time, parameters and modes only, and varies between events. */
static bool is_of_time(const struct Model *model, Node node, Node rate) {
  const unsigned may_use = 1u << TIME | 1u << PARAMETER | 1u << MODE;
  return rate != ZERO && (model->graph->vertices[node].kinds & ~may_use) == 0;
}

/* Finds the branches of time: those that are affine between events, and then the others. */
static void find_timed(const struct Model *model, struct SwitchingExpressions *switching) {
  const Node *rates = switching->values + switching->branch_count;
  switching->timed = allocate(switching->branch_count, sizeof *switching->timed);
  for (int is_curved = 0; is_curved < 2; is_curved++) {
    for (size_t i = 0; i < switching->branch_count; i++)
      if (is_of_time(model, switching->values[i], rates[i]) &&
          graph_depends_on(model->graph, rates[i], TIME) == (is_curved == 1))
        switching->timed[switching->timed_count++] = i;
    if (is_curved == 0) switching->affine_count = switching->timed_count;
  }
}

static void fill_resting_sums(const struct Switches *switches, struct SwitchingExpressions *switching) {
  switching->resting_sums = allocate(switches->resting_count, sizeof(Node));
  for (size_t i = 0; i < switches->resting_count; i++)
    if (switches->resting[i].kind == RESTING_SUM)
      switching->resting_sums[switching->resting_sum_count++] = switches->resting[i].sum;
}

static void fill_ball_distances(const struct Switches *switches, struct SwitchingExpressions *switching) {
  switching->ball_distances = allocate(switches->ball_count, sizeof(Node));
  for (size_t i = 0; i < switches->ball_count; i++) switching->ball_distances[i] = switches->balls[i].distance;
}

struct SwitchingExpressions *switching_derive(const struct Model *model, const struct Equations *equations) {
  if (!has_switches(&model->switches) || is_motionless(model)) return NULL;
  struct SwitchingExpressions *switching = allocate(1, sizeof *switching);
  struct NodeList roots = roots_of(model, equations), watched = {0}, values = {0};
  find_energies(model, equations, switching);
  find_branches(model, &roots, switching);
  find_branches_of_forces(model, equations, switching);
  struct SwitchTable counts = count_switches(model, switching);
  switching->assignment_count = counts.assignment_count;
  fill_indicators(model, &counts, switching);
  append_watched(model, switching, &watched);
  append_values(model, equations, &counts, switching, &values);
  find_forces(model, switching);
  switching->watched = watched.nodes;
  switching->watched_count = watched.count;
  switching->values = values.nodes;
  switching->value_count = values.count;
  find_timed(model, switching);
  fill_resting_sums(&model->switches, switching);
  fill_ball_distances(&model->switches, switching);
  fill_rounding_bounds(model, &counts, switching);
  return switching->indicator_count > 0 ? switching : NULL;
}

/* Returns the sign of a branch without modes. Its indicator contains modes of earlier branches only. */
static Node sign_of_branch(const struct Model *model, const struct Branch *branch) {
  if (*branch->sign == ZERO)
    *branch->sign = function(model->graph, SIGN, without_branches(model, branch->indicator), ZERO);
  return *branch->sign;
}

Node without_branches(const struct Model *model, Node node) {
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  if (switches->branch_count == 0 || !graph_depends_on(graph, node, MODE)) return node;
  bool *is_used = allocate(switches->branch_count, sizeof *is_used);
  cone_collect(graph->cone, graph, &node, 1);
  for (size_t i = 0; i < switches->branch_count; i++) is_used[i] = cone_has(graph->cone, switches->branches[i].mode);
  Node *replacements = own_symbols(graph);
  for (size_t i = 0; i < switches->branch_count; i++)
    if (is_used[i] && !switches->branches[i].is_of_friction)
      replacements[graph->vertices[switches->branches[i].mode].left] = sign_of_branch(model, &switches->branches[i]);
  substitute(graph, &node, 1, replacements, &node);
  release(replacements);
  release(is_used);
  return node;
}

/* Replaces the forces beside constraints by 0: pages show the whole force of a contact or a friction as one symbol. */
static Node without_carried_forces(const struct Model *model, Node node) {
  struct Graph *graph = model->graph;
  const struct Switches *switches = &model->switches;
  if (switches->friction_count == 0) return node;
  Node *replacements = own_symbols(graph);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (switches->contacts[i].carried != ZERO) replacements[graph->vertices[switches->contacts[i].carried].left] = ZERO;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (switches->frictions[i].share != ZERO) replacements[graph->vertices[switches->frictions[i].share].left] = ZERO;
  substitute(graph, &node, 1, replacements, &node);
  return node;
}

/* Returns the number of nodes of an ascending list that are less than a node. */
static size_t count_below(const struct NodeList *list, Node node) {
  size_t low = 0, high = list->count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (list->nodes[middle] < node) low = middle + 1;
    else high = middle;
  }
  return low;
}

static void insert_node(struct NodeList *ascending, Node node) {
  size_t slot = count_below(ascending, node);
  append_node(ascending, node);
  for (size_t i = ascending->count - 1; i > slot; i--) ascending->nodes[i] = ascending->nodes[i - 1];
  ascending->nodes[slot] = node;
}

static bool drop_guard(void *conditions, enum Operation operation, Node left, Node right, Node *result) {
  const struct NodeList *ascending = conditions;
  size_t slot = operation == GUARD ? count_below(ascending, left) : ascending->count;
  bool drops = slot < ascending->count && ascending->nodes[slot] == left;
  if (drops) *result = right;
  return drops;
}

/* Replaces the modes of branches as without_branches() does, and that of importers by 0. */
static Node without_modes(const struct Model *model, Node node) {
  node = without_branches(model, node);
  Node importer = model->switches.importer;
  return importer != ZERO ? substitute_symbol(model->graph, node, importer, ZERO) : node;
}

/* Removes the guards that leave out what has no effect. Conditions may contain guards of earlier ones. */
static Node without_conditions(const struct Model *model, Node node) {
  const struct NodeList *conditions = &model->switches.conditions;
  struct NodeList *shown = model->switches.shown_conditions;
  if (shown == NULL) return node;
  const struct Rebuilding rebuilding = {model->graph, shown, drop_guard};
  for (size_t i = shown->count; i < conditions->count; i++)
    insert_node(shown, rebuild(&rebuilding, without_modes(model, conditions->nodes[i])));
  return rebuild(&rebuilding, node);
}

Node as_written(const struct Model *model, Node node) {
  node = without_conditions(model, without_modes(model, node));
  return without_carried_forces(model, without_rests(model, node));
}
