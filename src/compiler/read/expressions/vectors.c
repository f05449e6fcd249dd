#include "read/expressions/vectors.h"

#include <ctype.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/kinematics.h"
#include "read/expressions/parser.h"
#include "read/expressions/quantities.h"

static const char expected[] = "the name of a <particle>, <body>, <point> or <frame>, or base";

/* A vector along the base's axes, with its unit. */
struct Arrow {
  struct Vector vector;
  struct Dimension dimension;
};

static const struct Arrow no_arrow = {.vector = {{ZERO, ZERO, ZERO}}};

static struct Arrow parse_vector(struct Parser *parser);

bool is_function_of_vectors(const char *name) {
  static const char *const names[] = {"cross", "distance", "dot", "norm"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcmp(name, names[i]) == 0) return true;
  return false;
}

/* A component by its name; 0 where there is none, as of a particle in a plane. */
static Node parse_component(struct Parser *parser, const char *name, bool *is_known) {
  char *full_name = scope_full_name(parser->scope, name);
  bool is_there =
      scope_find(parser->scope, full_name) != NULL || definitions_contain(parser->scope->definitions, full_name);
  *is_known |= is_there;
  return is_there ? look_up(parser, name).node : ZERO;
}

/* Components that are called NAME.x, or NAME.vx, ...; false where there is none of them. */
static bool find_components(struct Parser *parser, const char *name, const char *prefix, struct Vector *vector) {
  bool is_known = false;
  for (int i = 0; i < 3 && !parser->failed; i++)
    vector->along[i] = parse_component(parser, format_text("%s.%s%s", name, prefix, axes[i]), &is_known);
  return is_known;
}

/* A column of a frame's rotation. */
static bool find_axis(struct Parser *parser, const char *frame, int axis, struct Vector *vector) {
  bool is_known = strcmp(frame, "base") == 0;
  if (is_known) vector->along[axis] = ONE;
  for (int i = 0; i < 3 && !parser->failed && strcmp(frame, "base") != 0; i++)
    vector->along[i] = parse_component(parser, format_text("%s.R%d%d", frame, i + 1, axis + 1), &is_known);
  return is_known;
}

/* What a name with a part at its end stands for: a point's velocity, or an axis of a frame; false for neither. */
static bool find_part(struct Parser *parser, const char *name, struct Arrow *arrow) {
  const char *part = strrchr(name, '.');
  if (part == NULL) return false;
  char *of = format_text("%.*s", (int)(part - name), name);
  bool is_axis = strlen(part) == strlen(".axisX") && strncmp(part, ".axis", 5) == 0 && strchr("XYZ", part[5]) != NULL;
  arrow->dimension = is_axis ? dimension_one : unit_of("m/s");
  if (is_axis) return find_axis(parser, of, part[5] - 'X', &arrow->vector);
  return strcmp(part, ".v") == 0 && find_components(parser, of, "v", &arrow->vector);
}

static struct Arrow parse_named_arrow(struct Parser *parser, const char *name) {
  struct Arrow arrow = no_arrow;
  arrow.dimension = unit_of("m");
  if (strcmp(name, "base") == 0 || find_components(parser, name, "", &arrow.vector)) return arrow;
  if (!parser->failed && !find_part(parser, name, &arrow))
    FAIL(parser, "%s: there is no point '%s'; expected %s", parser->place.what, name, expected);
  return arrow;
}

static struct Arrow cross_product(struct Parser *parser) {
  struct Arrow first = parse_vector(parser);
  expect_character(parser, ',', "between the two vectors of cross");
  struct Arrow second = parse_vector(parser);
  expect_character(parser, ')', "after the two vectors of cross");
  if (parser->failed) return no_arrow;
  return (struct Arrow){vector_cross(parser->graph, first.vector, second.vector),
                        dimension_multiply(first.dimension, second.dimension, 1.0)};
}

static struct Arrow parse_arrow(struct Parser *parser) {
  char buffer[32];
  if (accept_character(parser, '(')) {
    struct Arrow inner = parse_vector(parser);
    expect_character(parser, ')', "to close a parenthesis");
    return inner;
  }
  skip_space(parser);
  if (!isalpha((unsigned char)*parser->next) && *parser->next != '_')
    FAIL(parser, "%s: expected %s, or a vector such as arm.axisX, tip.v or cross(...), found %s", parser->place.what,
         expected, found(parser, buffer));
  if (parser->failed) return no_arrow;
  char *name = read_name(parser);
  const char *end = parser->next;
  if (strcmp(name, "cross") == 0 && accept_character(parser, '(')) return cross_product(parser);
  parser->next = end;
  return parser->failed ? no_arrow : parse_named_arrow(parser, name);
}

static struct Arrow sum_of_arrows(struct Parser *parser, struct Arrow a, struct Arrow b, bool is_plus) {
  for (int i = 0; i < 3 && !parser->failed; i++) {
    struct Quantity first = {.node = a.vector.along[i], .dimension = a.dimension};
    struct Quantity second = {.node = b.vector.along[i], .dimension = b.dimension};
    struct Quantity sum = (is_plus ? quantity_add : quantity_subtract)(parser, first, second);
    a.vector.along[i] = sum.node;
  }
  return a;
}

/* Parentheses nest as deep as the sums of numbers in which they stand may. */
static struct Arrow parse_vector(struct Parser *parser) {
  enum { NESTING_LIMIT = 1000 };
  if (++parser->nesting > NESTING_LIMIT)
    FAIL(parser, "%s: more than %d nested parentheses; expected fewer", parser->place.what, NESTING_LIMIT);
  if (parser->failed) return no_arrow;
  bool is_negative = accept_character(parser, '-');
  struct Arrow sum = parse_arrow(parser);
  if (is_negative) sum.vector = vector_scale(parser->graph, graph_constant(parser->graph, -1.0), sum.vector);
  while (!parser->failed) {
    bool is_plus = accept_character(parser, '+');
    if (!is_plus && !accept_character(parser, '-')) break;
    struct Arrow term = parse_arrow(parser);
    if (!parser->failed) sum = sum_of_arrows(parser, sum, term, is_plus);
  }
  parser->nesting--;
  return sum;
}

static struct Quantity norm_of(struct Graph *graph, struct Arrow arrow) {
  Node square = vector_dot(graph, arrow.vector, arrow.vector);
  return (struct Quantity){.node = power_number(graph, square, 0.5), .dimension = arrow.dimension};
}

static struct Quantity distance_of(struct Parser *parser, struct Arrow first, struct Arrow second) {
  struct Graph *graph = parser->graph;
  bool are_points = dimension_agrees(first.dimension, unit_of("m")) && dimension_agrees(second.dimension, unit_of("m"));
  if (!are_points) FAIL(parser, "%s: distance(...) is between two points; expected %s", parser->place.what, expected);
  struct Vector back = vector_scale(graph, graph_constant(graph, -1.0), first.vector);
  return norm_of(graph, (struct Arrow){vector_add(graph, second.vector, back), unit_of("m")});
}

struct Quantity parse_function_of_vectors(struct Parser *parser, const char *name) {
  static const struct Quantity nothing = {.node = ZERO};
  bool is_norm = strcmp(name, "norm") == 0;
  const char *of = strcmp(name, "distance") == 0 ? "points" : "vectors";
  if (strcmp(name, "cross") == 0)
    FAIL(parser, "%s: cross(...) is a vector; expected it in dot(...) or norm(...)", parser->place.what);
  struct Arrow first = parse_vector(parser), second = no_arrow;
  if (!is_norm) {
    expect_character(parser, ',', format_text("between the two %s of %s", of, name));
    second = parse_vector(parser);
  }
  expect_character(parser, ')', is_norm ? "after the vector of norm" : format_text("after the two %s of %s", of, name));
  if (parser->failed) return nothing;
  if (is_norm) return norm_of(parser->graph, first);
  if (*name == 'd' && name[1] == 'i') return distance_of(parser, first, second);
  return (struct Quantity){.node = vector_dot(parser->graph, first.vector, second.vector),
                           .dimension = dimension_multiply(first.dimension, second.dimension, 1.0)};
}
