#include "read/expressions/constructs.h"

#include <ctype.h>
#include <string.h>

#include "algebra/simplify.h"
#include "base/memory.h"
#include "model/kinematics.h"
#include "read/expressions/parser.h"
#include "read/expressions/quantities.h"

static const char expected[] = "the name of a <particle>, <body>, <point> or <frame>, or base";

/* A vector along the base's axes, with the unit of its components. */
struct VectorQuantity {
  struct Vector vector;
  struct Dimension dimension;
};

static const struct VectorQuantity no_arrow = {.vector = {{ZERO, ZERO, ZERO}}};

static struct VectorQuantity parse_vector(struct Parser *parser);

bool is_function_of_vectors(const char *name) {
  static const char *const names[] = {"cross", "distance", "dot", "norm"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcmp(name, names[i]) == 0) return true;
  return false;
}

/* Returns a component by its name, or 0 if it does not exist, as z in the plane. Sets is_known if it exists. */
static Node parse_component(struct Parser *parser, const char *name, bool *is_known) {
  char *full_name = scope_full_name(parser->scope, name);
  bool is_there =
      scope_find(parser->scope, full_name) != NULL || definitions_contain(parser->scope->definitions, full_name);
  *is_known |= is_there;
  return is_there ? look_up(parser, name).node : ZERO;
}

/* Sets the vector of the components NAME.x, NAME.vx or the like. Returns false if none of them exists. */
static bool find_components(struct Parser *parser, const char *name, const char *prefix, struct Vector *vector) {
  bool is_known = false;
  for (int i = 0; i < 3 && !parser->failed; i++)
    vector->along[i] = parse_component(parser, format_text("%s.%s%s", name, prefix, axes[i]), &is_known);
  return is_known;
}

/* Sets a column of a frame's rotation matrix. Returns false if there is no such frame. */
static bool find_axis(struct Parser *parser, const char *frame, int axis, struct Vector *vector) {
  bool is_known = strcmp(frame, "base") == 0;
  if (is_known) vector->along[axis] = ONE;
  for (int i = 0; i < 3 && !parser->failed && strcmp(frame, "base") != 0; i++)
    vector->along[i] = parse_component(parser, format_text("%s.R%d%d", frame, i + 1, axis + 1), &is_known);
  return is_known;
}

/* Sets the vector that NAME.axisX, NAME.v or NAME.omega stands for. Returns false for other names. */
static bool find_part(struct Parser *parser, const char *name, struct VectorQuantity *vector_value) {
  const char *part = strrchr(name, '.');
  if (part == NULL) return false;
  char *of = format_text("%.*s", (int)(part - name), name);
  bool is_axis = strlen(part) == strlen(".axisX") && strncmp(part, ".axis", 5) == 0 && strchr("XYZ", part[5]) != NULL;
  bool is_turning = strcmp(part, ".omega") == 0;
  vector_value->dimension = is_axis ? dimension_one : unit_of(is_turning ? "rad/s" : "m/s");
  if (is_axis) return find_axis(parser, of, part[5] - 'X', &vector_value->vector);
  if (is_turning) return find_components(parser, of, "w", &vector_value->vector);
  return strcmp(part, ".v") == 0 && find_components(parser, of, "v", &vector_value->vector);
}

static struct VectorQuantity parse_named_vector(struct Parser *parser, const char *name) {
  struct VectorQuantity vector_value = no_arrow;
  vector_value.dimension = unit_of("m");
  if (strcmp(name, "base") == 0 || find_components(parser, name, "", &vector_value.vector)) return vector_value;
  if (!parser->failed && !find_part(parser, name, &vector_value))
    FAIL(parser, "%s: there is no point '%s'; expected %s", parser->location.what, name, expected);
  return vector_value;
}

static struct VectorQuantity cross_product(struct Parser *parser) {
  struct VectorQuantity first = parse_vector(parser);
  expect_character(parser, ',', "between the two vectors of cross");
  struct VectorQuantity second = parse_vector(parser);
  expect_character(parser, ')', "after the two vectors of cross");
  if (parser->failed) return no_arrow;
  return (struct VectorQuantity){vector_cross(parser->graph, first.vector, second.vector),
                                 dimension_multiply(first.dimension, second.dimension, 1.0)};
}

static struct VectorQuantity parse_vector_value(struct Parser *parser) {
  char buffer[32];
  if (accept_character(parser, '(')) {
    struct VectorQuantity inner = parse_vector(parser);
    expect_character(parser, ')', "to close a parenthesis");
    return inner;
  }
  skip_space(parser);
  if (!isalpha((unsigned char)*parser->next) && *parser->next != '_')
    FAIL(parser, "%s: expected %s, or a vector such as arm.axisX, tip.v or cross(...), found %s", parser->location.what,
         expected, found(parser, buffer));
  if (parser->failed) return no_arrow;
  char *name = read_name(parser);
  const char *end = parser->next;
  if (strcmp(name, "cross") == 0 && accept_character(parser, '(')) return cross_product(parser);
  parser->next = end;
  return parser->failed ? no_arrow : parse_named_vector(parser, name);
}

/* True if a scalar comes next: a literal, a call other than cross, or a name with a scalar value. */
static bool is_number_ahead(struct Parser *parser) {
  skip_space(parser);
  const char *begin = parser->next;
  if (isdigit((unsigned char)*begin) || *begin == '.') return true;
  if (parser->failed || (!isalpha((unsigned char)*begin) && *begin != '_')) return false;
  char *name = read_name(parser);
  if (parser->failed) return false;
  bool is_call = accept_character(parser, '(');
  parser->next = begin;
  if (is_call) return strcmp(name, "cross") != 0;
  char *full_name = scope_full_name(parser->scope, name);
  return find_quantity(parser, name) != NULL || definitions_contain(parser->scope->definitions, full_name);
}

static struct VectorQuantity scaled_by(struct Parser *parser, struct VectorQuantity vector_value,
                                       struct Quantity factor, bool is_product) {
  struct Quantity scaled = {.node = ZERO};
  for (int i = 0; i < 3 && !parser->failed; i++) {
    struct Quantity component = {.node = vector_value.vector.along[i], .dimension = vector_value.dimension};
    scaled = (is_product ? quantity_multiply : quantity_divide)(parser, component, factor);
    vector_value.vector.along[i] = scaled.node;
  }
  vector_value.dimension = scaled.dimension;
  return vector_value;
}

/* Parses the scalar factors in front of a vector and returns their product. */
static struct Quantity parse_factors(struct Parser *parser) {
  struct Quantity product = parse_power(parser);
  while (!parser->failed) {
    bool is_quotient = accept_character(parser, '/');
    if (!is_quotient && !accept_character(parser, '*')) {
      FAIL(parser, "%s: a number is no vector; expected * and a vector after it, or %s", parser->location.what,
           expected);
      break;
    }
    if (!is_quotient && !is_number_ahead(parser)) break;
    struct Quantity factor = parse_power(parser);
    if (!parser->failed) product = (is_quotient ? quantity_divide : quantity_multiply)(parser, product, factor);
  }
  return product;
}

static struct VectorQuantity parse_scaled(struct Parser *parser) {
  bool is_scaled = is_number_ahead(parser);
  struct Quantity before = {.node = ONE};
  if (is_scaled) before = parse_factors(parser);
  struct VectorQuantity vector_value = parse_vector_value(parser);
  if (is_scaled && !parser->failed) vector_value = scaled_by(parser, vector_value, before, true);
  while (!parser->failed) {
    bool is_product = accept_character(parser, '*');
    if (!is_product && !accept_character(parser, '/')) break;
    struct Quantity factor = parse_power(parser);
    if (!parser->failed) vector_value = scaled_by(parser, vector_value, factor, is_product);
  }
  return vector_value;
}

static struct VectorQuantity sum_of_vectors(struct Parser *parser, struct VectorQuantity a, struct VectorQuantity b,
                                            bool is_plus) {
  for (int i = 0; i < 3 && !parser->failed; i++) {
    struct Quantity first = {.node = a.vector.along[i], .dimension = a.dimension};
    struct Quantity second = {.node = b.vector.along[i], .dimension = b.dimension};
    struct Quantity sum = (is_plus ? quantity_add : quantity_subtract)(parser, first, second);
    a.vector.along[i] = sum.node;
  }
  return a;
}

/* Parses a sum of vectors. Parentheses count toward the same nesting limit as those of scalars. */
static struct VectorQuantity parse_vector(struct Parser *parser) {
  enum { NESTING_LIMIT = 1000 }; /* as in parser.c */
  if (++parser->nesting > NESTING_LIMIT)
    FAIL(parser, "%s: parentheses are nested more than %d deep; expected fewer", parser->location.what, NESTING_LIMIT);
  if (parser->failed) return no_arrow;
  bool is_negative = accept_character(parser, '-');
  struct VectorQuantity sum = parse_scaled(parser);
  if (is_negative) sum.vector = vector_scale(parser->graph, graph_constant(parser->graph, -1.0), sum.vector);
  while (!parser->failed) {
    bool is_plus = accept_character(parser, '+');
    if (!is_plus && !accept_character(parser, '-')) break;
    struct VectorQuantity term = parse_scaled(parser);
    if (!parser->failed) sum = sum_of_vectors(parser, sum, term, is_plus);
  }
  parser->nesting--;
  return sum;
}

static struct Quantity norm_of(struct Graph *graph, struct VectorQuantity vector_value) {
  Node square = vector_dot(graph, vector_value.vector, vector_value.vector);
  return (struct Quantity){.node = power_number(graph, square, 0.5), .dimension = vector_value.dimension};
}

static struct Quantity distance_of(struct Parser *parser, struct VectorQuantity first, struct VectorQuantity second) {
  struct Graph *graph = parser->graph;
  bool are_points = dimension_agrees(first.dimension, unit_of("m")) && dimension_agrees(second.dimension, unit_of("m"));
  if (!are_points)
    FAIL(parser, "%s: distance(...) is between two points; expected %s", parser->location.what, expected);
  struct Vector back = vector_scale(graph, graph_constant(graph, -1.0), first.vector);
  return norm_of(graph, (struct VectorQuantity){vector_add(graph, second.vector, back), unit_of("m")});
}

struct Quantity parse_function_of_vectors(struct Parser *parser, const char *name) {
  static const struct Quantity nothing = {.node = ZERO};
  bool is_norm = strcmp(name, "norm") == 0;
  const char *of = strcmp(name, "distance") == 0 ? "points" : "vectors";
  if (strcmp(name, "cross") == 0)
    FAIL(parser, "%s: cross(...) is a vector; expected it in dot(...) or norm(...)", parser->location.what);
  struct VectorQuantity first = parse_vector(parser), second = no_arrow;
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
