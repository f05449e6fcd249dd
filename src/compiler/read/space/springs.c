#include "read/space/springs.h"

#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/context/variables.h"
#include "names/definitions.h"

static const char *const components[] = {"length", "force"};
static const char *const units[] = {"m", "N"};
enum { COMPONENT_COUNT = sizeof components / sizeof *components };

/* A spring between its two ends. */
struct Spring {
  Node stiffness, damping;
  Node stretch; /* elongation from the unstressed length */
  Node length;
};

static Node read_constant(struct Reader *reader, xmlNodePtr node, const char *name, const char *unit) {
  struct Quantity value = {.node = ZERO};
  if (expression_attribute(reader, node, name, IN_MASS, &value) && !definitions_are_waiting(reader->definitions))
    require_unit(reader, line_of_attribute(node, name), name, value, unit_of(unit));
  return value.node;
}

static struct Spring spring_of(struct Reader *reader, xmlNodePtr node, unsigned kinds) {
  struct Graph *graph = reader->model->graph;
  char *text = format_text("distance(%s, %s)", attribute(node, "from"), attribute(node, "to"));
  struct Location location = location_of(node, "the length of <spring>", kinds);
  struct Spring spring = {.stiffness = read_constant(reader, node, "stiffness", "N/m"),
                          .damping = read_constant(reader, node, "damping", "N.s/m"),
                          .length = parse_expression(reader->scope, text, location).node};
  Node relaxed = read_constant(reader, node, "length", "m");
  spring.stretch = subtract(graph, spring.length, relaxed);
  return spring;
}

void collect_spring(struct Reader *reader, xmlNodePtr node) {
  char *name = name_attribute(reader, node, "name");
  for (int i = 0; name != NULL && i < COMPONENT_COUNT; i++)
    definitions_add(reader->definitions, format_text("%s.%s", name, components[i]),
                    &(struct NamedExpression){node, components[i], reader->source, NULL});
}

struct Quantity read_spring_value(struct Reader *reader, xmlNodePtr node, const char *component) {
  struct Graph *graph = reader->model->graph;
  struct Spring spring = spring_of(reader, node, IN_OUTPUT);
  if (strcmp(component, "length") == 0) return (struct Quantity){.node = spring.length, .dimension = unit_of("m")};
  Node force = multiply(graph, spring.stiffness, spring.stretch);
  if (spring.damping != ZERO) {
    Node rate = total_time_derivative(reader->scope, spring.length);
    force = add(graph, force, multiply(graph, spring.damping, rate));
  }
  return (struct Quantity){.node = force, .dimension = unit_of("N")};
}

static void append_components(struct Reader *reader, xmlNodePtr node, const char *name) {
  for (int i = 0; i < COMPONENT_COUNT; i++) {
    char *full_name = format_text("%s.%s", name, components[i]);
    const struct Quantity *value = scope_find(reader->scope, full_name);
    if (value == NULL) continue;
    struct Variable variable = {
        .name = full_name,
        .description = format_text(i == 0 ? "%s of %s" : "%s in %s, positive in tension", components[i], name),
        .unit = copy_text(units[i]),
        .dimension = value->dimension};
    variable.node = without_displacements(reader, line_of(node), full_name, value->node);
    append_variable(&reader->model->mechanism.element_variables, variable);
  }
}

/* Returns factor value^2 / 2. */
static Node half_of_square(struct Graph *graph, Node factor, Node value) {
  return scale(graph, 0.5, multiply(graph, factor, power_number(graph, value, 2.0)));
}

void read_spring(struct Reader *reader, xmlNodePtr node) {
  struct Model *model = reader->model;
  struct Graph *graph = model->graph;
  struct Energies *energies = &model->energies;
  struct Spring spring = spring_of(reader, node, IN_ENERGY);
  if (reader->diagnostics->errors > 0) return;
  if (spring.stiffness == ZERO && spring.damping == ZERO)
    report_at(reader, node, "<spring> has neither stiffness nor damping; expected one of them");
  if (graph_is_constant(graph, spring.length))
    report_at(reader, node, "the ends '%s' and '%s' of <spring> are %g m apart at all times; expected two that move",
              attribute(node, "from"), attribute(node, "to"), graph_value(graph, spring.length));
  expect_not_negative(reader, node, "the stiffness of <spring>", spring.stiffness, false);
  expect_not_negative(reader, node, "the damping of <spring>", spring.damping, false);
  Node energy = half_of_square(graph, spring.stiffness, spring.stretch);
  add_energy(reader, node, "the energy of <spring>", energy, &energies->displaced_potential, &energies->potential);
  if (spring.damping != ZERO) {
    Node rate = total_time_derivative(reader->scope, spring.length);
    add_energy(reader, node, "the dissipation of <spring>", half_of_square(graph, spring.damping, rate),
               &energies->displaced_dissipation, &energies->dissipation);
    model->forces.any = true;
  }
  char *name = name_attribute(reader, node, "name");
  if (name != NULL) append_components(reader, node, name);
}
