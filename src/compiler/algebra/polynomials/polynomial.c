#include "algebra/polynomials/polynomial.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* A sum below this share of its summands is a rounding error of 0: some hundred rounding errors. */
static const double cancellation = 1e-13;

static struct Polynomial with_capacity(size_t count) {
  return (struct Polynomial){.terms = allocate(count, sizeof(struct Monomial))};
}

/* Marks an overflow if the coefficient is not a normal number: digits would be lost. */
static void set_coefficient(struct Polynomial *p, size_t term, double coefficient) {
  p->terms[term].coefficient = coefficient;
  p->overflow = p->overflow || !isnormal(coefficient);
}

struct Polynomial polynomial_constant(double value) {
  struct Polynomial p = with_capacity(1);
  p.count = value != 0.0;
  if (p.count > 0) set_coefficient(&p, 0, value);
  return p;
}

struct Polynomial polynomial_atom(int atom) {
  struct Polynomial p = polynomial_constant(1.0);
  p.terms[0].exponent[atom] = 1;
  return p;
}

struct Polynomial polynomial_copy(const struct Polynomial *p) {
  struct Polynomial copy = with_capacity(p->count);
  for (size_t i = 0; i < p->count; i++) copy.terms[i] = p->terms[i];
  copy.count = p->count;
  copy.overflow = p->overflow;
  return copy;
}

void polynomial_free(struct Polynomial *p) {
  release(p->terms);
  *p = (struct Polynomial){0};
}

static int compare(const struct Monomial *a, const struct Monomial *b) {
  return memcmp(a->exponent, b->exponent, sizeof a->exponent);
}

struct Polynomial polynomial_add(const struct Polynomial *a, const struct Polynomial *b, double factor) {
  struct Polynomial sum = with_capacity(a->count + b->count);
  size_t i = 0, j = 0;
  while (i < a->count || j < b->count) {
    int order = i == a->count ? -1 : j == b->count ? 1 : compare(&a->terms[i], &b->terms[j]);
    struct Monomial term = order >= 0 ? a->terms[i] : b->terms[j];
    if (order < 0) term.coefficient *= factor;
    if (order == 0) {
      double x = a->terms[i].coefficient, y = factor * b->terms[j].coefficient;
      term.coefficient = fabs(x + y) <= cancellation * (fabs(x) + fabs(y)) ? 0.0 : x + y;
    }
    i += order >= 0;
    j += order <= 0;
    if (term.coefficient == 0.0) continue;
    sum.terms[sum.count] = term;
    set_coefficient(&sum, sum.count++, term.coefficient);
  }
  sum.overflow = sum.overflow || a->overflow || b->overflow || sum.count > MONOMIAL_LIMIT;
  return sum;
}

void polynomial_scale(struct Polynomial *p, double coefficient, const uint8_t exponent[ATOM_LIMIT]) {
  for (size_t i = 0; i < p->count; i++) {
    set_coefficient(p, i, p->terms[i].coefficient * coefficient);
    for (int atom = 0; atom < ATOM_LIMIT; atom++) {
      if (p->terms[i].exponent[atom] + exponent[atom] > UINT8_MAX) p->overflow = true;
      p->terms[i].exponent[atom] = (uint8_t)(p->terms[i].exponent[atom] + exponent[atom]);
    }
  }
}

void polynomial_divide_by(struct Polynomial *p, double divisor, const uint8_t exponent[ATOM_LIMIT]) {
  polynomial_scale(p, 1.0, exponent);
  for (size_t i = 0; i < p->count; i++) set_coefficient(p, i, p->terms[i].coefficient / divisor);
}

struct Polynomial polynomial_multiply(const struct Polynomial *a, const struct Polynomial *b) {
  struct Polynomial product = with_capacity(0);
  product.overflow = a->overflow || b->overflow;
  for (size_t i = 0; i < b->count && !product.overflow; i++) {
    struct Polynomial part = polynomial_copy(a);
    polynomial_scale(&part, b->terms[i].coefficient, b->terms[i].exponent);
    struct Polynomial sum = polynomial_add(&product, &part, 1.0);
    polynomial_free(&part);
    polynomial_free(&product);
    product = sum;
  }
  return product;
}

/* True if the monomial b divides a; returns the quotient. */
static bool divide_monomial(const struct Monomial *a, const struct Monomial *b, struct Monomial *quotient) {
  for (int atom = 0; atom < ATOM_LIMIT; atom++) {
    if (a->exponent[atom] < b->exponent[atom]) return false;
    quotient->exponent[atom] = (uint8_t)(a->exponent[atom] - b->exponent[atom]);
  }
  quotient->coefficient = a->coefficient / b->coefficient;
  return true;
}

bool polynomial_divide(const struct Polynomial *a, const struct Polynomial *b, struct Polynomial *quotient) {
  struct Polynomial rest = polynomial_copy(a);
  *quotient = with_capacity(0);
  while (rest.count > 0 && !rest.overflow && quotient->count < MONOMIAL_LIMIT) {
    struct Monomial lead;
    if (!divide_monomial(&rest.terms[0], &b->terms[0], &lead)) break;
    struct Polynomial part = polynomial_copy(b), one = {.terms = &lead, .count = 1};
    polynomial_scale(&part, lead.coefficient, lead.exponent); /* overflows if lead is not normal */
    struct Polynomial smaller = polynomial_add(&rest, &part, -1.0), sum = polynomial_add(quotient, &one, 1.0);
    polynomial_free(&part);
    polynomial_free(&rest);
    polynomial_free(quotient);
    rest = smaller;
    *quotient = sum;
  }
  bool exact = rest.count == 0 && !rest.overflow;
  polynomial_free(&rest);
  if (!exact) polynomial_free(quotient);
  return exact;
}

void polynomial_take_content(struct Polynomial *p, uint8_t exponent[ATOM_LIMIT]) {
  for (int atom = 0; atom < ATOM_LIMIT; atom++) {
    exponent[atom] = p->count > 0 ? UINT8_MAX : 0;
    for (size_t i = 0; i < p->count; i++)
      if (p->terms[i].exponent[atom] < exponent[atom]) exponent[atom] = p->terms[i].exponent[atom];
    for (size_t i = 0; i < p->count; i++)
      p->terms[i].exponent[atom] = (uint8_t)(p->terms[i].exponent[atom] - exponent[atom]);
  }
}
