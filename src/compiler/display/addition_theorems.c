#include "display/addition_theorems.h"

#include <math.h>

#include "algebra/simplify.h"
#include "base/memory.h"

/* Longer sums are left as they are: each step compares all pairs of terms for all pairs of angles. */
enum { LENGTH_LIMIT = 80, ANGLE_LIMIT = 8 };

/* An angle, with the indices of its sine and cosine among the atoms. */
struct Angle {
  Node node;
  int sine, cosine;
};

/* Finds the angles whose sine or cosine is an atom; both become atoms. */
static int find_angles(struct Atoms *atoms, struct Angle angles[ANGLE_LIMIT]) {
  int count = 0, atom_count = atoms->count;
  for (int i = 0; i < atom_count; i++) {
    const struct Vertex vertex = atoms->graph->vertices[atoms->nodes[i]];
    if ((vertex.operation != SINE && vertex.operation != COSINE) || displayed_name(atoms, atoms->nodes[i]) != NULL)
      continue;
    int k = 0;
    while (k < count && angles[k].node != vertex.left) k++;
    if (k < count || count == ANGLE_LIMIT || atoms->count + 2 > ATOM_ROOM) continue;
    angles[count++] = (struct Angle){vertex.left, atom_index(atoms, graph_node(atoms->graph, SINE, vertex.left, ZERO)),
                                     atom_index(atoms, graph_node(atoms->graph, COSINE, vertex.left, ZERO))};
  }
  return count;
}

/* Returns the index of a term with these atoms and the coefficient +-c; the number of terms if there is none. */
static size_t find_term(const struct Terms *terms, const struct Term *wanted) {
  for (size_t i = 0; i < terms->count; i++)
    if (have_equal_atoms(&terms->items[i], wanted) &&
        fabs(fabs(terms->items[i].coefficient) - fabs(wanted->coefficient)) <= 1e-14 * fabs(wanted->coefficient))
      return i;
  return terms->count;
}

static void remove_term(struct Terms *terms, size_t i) {
  terms->items[i] = terms->items[--terms->count];
}

/* Multiplies a term by a function of a node, which may be a number or have a negative sign. */
static void multiply_by_function(struct Atoms *atoms, struct Term *term, enum Operation operation, Node angle) {
  Node base;
  term->coefficient *= coefficient_of(atoms->graph, function(atoms->graph, operation, angle, ZERO), &base);
  if (base != ONE) term->exponents[atom_index(atoms, base)] += 1.0;
}

/* Returns a + sign*b with both sums multiplied out, so that what they share cancels. */
static Node sum_of_angles(const struct Atoms *atoms, Node a, double sign, Node b) {
  Node sum = add(atoms->graph, a, scale(atoms->graph, sign, b));
  struct Atoms own = {.graph = atoms->graph, .names = atoms->names, .whole = sum, .expansion = EXPAND_ALL};
  struct Terms terms = terms_of_expression(&own, sum);
  if (!own.is_full) sum = node_of_terms(&own, &terms);
  release(terms.items);
  return sum;
}

/* Replaces term i and its counterpart, by sines and cosines of the angles a and b. */
static bool join_pair(struct Atoms *atoms, struct Terms *terms, size_t i, const struct Angle *a,
                      const struct Angle *b) {
  struct Term rest = terms->items[i];
  bool of_sines = rest.exponents[a->sine] >= 1.0 && rest.exponents[b->sine] >= 1.0;
  bool is_mixed = rest.exponents[a->sine] >= 1.0 && rest.exponents[b->cosine] >= 1.0;
  if (!of_sines && !is_mixed) return false;
  rest.exponents[a->sine] -= 1.0;
  rest.exponents[of_sines ? b->sine : b->cosine] -= 1.0;
  struct Term wanted = rest;
  wanted.exponents[a->cosine] += 1.0;
  wanted.exponents[of_sines ? b->cosine : b->sine] += 1.0;
  size_t j = find_term(terms, &wanted);
  if (j == terms->count) return false;
  double other = terms->items[j].coefficient;
  bool is_equal = (other > 0.0) == (rest.coefficient > 0.0), is_sum = of_sines != is_equal;
  if (of_sines) rest.coefficient = other;
  bool is_swapped = !is_sum && a->node > b->node;
  if (is_swapped && !of_sines) rest.coefficient = -rest.coefficient;
  Node angle = is_swapped ? sum_of_angles(atoms, b->node, -1.0, a->node)
                          : sum_of_angles(atoms, a->node, is_sum ? 1.0 : -1.0, b->node);
  multiply_by_function(atoms, &rest, of_sines ? COSINE : SINE, angle);
  remove_term(terms, i > j ? i : j);
  remove_term(terms, i > j ? j : i);
  add_to_terms(atoms, terms, &rest);
  return true;
}

/* Replaces X sin^2 + X cos^2 by X, and X - X cos^2 by X sin^2; likewise with both functions exchanged. */
static bool join_squares(struct Atoms *atoms, struct Terms *terms, size_t i, int function, int other) {
  struct Term rest = terms->items[i], wanted;
  if (rest.exponents[function] < 2.0) return false;
  rest.exponents[function] -= 2.0;
  wanted = rest;
  wanted.exponents[other] += 2.0;
  size_t j = find_term(terms, &wanted);
  bool is_one = j < terms->count && (terms->items[j].coefficient > 0.0) == (rest.coefficient > 0.0);
  if (!is_one) {
    j = find_term(terms, &rest);
    if (j == terms->count || (terms->items[j].coefficient > 0.0) == (rest.coefficient > 0.0)) return false;
    rest = wanted;
    rest.coefficient = terms->items[j].coefficient;
  }
  remove_term(terms, i > j ? i : j);
  remove_term(terms, i > j ? j : i);
  add_to_terms(atoms, terms, &rest);
  return true;
}

static bool join_any(struct Atoms *atoms, struct Terms *terms, const struct Angle *angles, int count) {
  for (size_t i = 0; i < terms->count; i++)
    for (int a = 0; a < count; a++) {
      if (join_squares(atoms, terms, i, angles[a].sine, angles[a].cosine)) return true;
      if (join_squares(atoms, terms, i, angles[a].cosine, angles[a].sine)) return true;
      for (int b = 0; b < count; b++) {
        bool is_ordered = angles[a].node < angles[b].node;
        const struct Term *term = &terms->items[i];
        if (a == b || (!is_ordered && term->exponents[angles[b].sine] >= 1.0)) continue;
        if (join_pair(atoms, terms, i, &angles[a], &angles[b])) return true;
      }
    }
  return false;
}

/* Replaces x sign(x) by abs(x), where both are atoms. */
static void join_signs(struct Atoms *atoms, struct Terms *terms) {
  for (int sign = 0; sign < atoms->count; sign++) {
    const struct Vertex vertex = atoms->graph->vertices[atoms->nodes[sign]];
    int operand = 0;
    while (operand < atoms->count && atoms->nodes[operand] != vertex.left) operand++;
    if (vertex.operation != SIGN || operand == atoms->count || displayed_name(atoms, atoms->nodes[sign]) != NULL)
      continue;
    int absolute = atom_index(atoms, function(atoms->graph, ABSOLUTE, vertex.left, ZERO));
    for (size_t i = 0; i < terms->count; i++) {
      double *exponents = terms->items[i].exponents;
      if (exponents[sign] != 1.0 || exponents[operand] < 1.0) continue;
      exponents[sign] = 0.0;
      exponents[operand] -= 1.0;
      exponents[absolute] += 1.0;
    }
  }
}

void apply_addition_theorems(struct Atoms *atoms, struct Terms *terms) {
  join_signs(atoms, terms);
  struct Angle angles[ANGLE_LIMIT];
  bool joins = true;
  while (joins && terms->count > 1 && terms->count <= LENGTH_LIMIT && !atoms->is_full) {
    int count = find_angles(atoms, angles);
    joins = count > 0 && join_any(atoms, terms, angles, count);
  }
}
