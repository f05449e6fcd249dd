/* Sparse polynomials with numeric coefficients in at most ATOM_LIMIT atoms, and exact division. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ATOM_LIMIT = 24, MONOMIAL_LIMIT = 400 };

struct Monomial {
  double coefficient;
  uint8_t exponent[ATOM_LIMIT];
};

/* Monomials in descending lexicographic order, none with a coefficient of 0; no monomials is the polynomial 0. */
struct Polynomial {
  struct Monomial *terms;
  size_t count;
  bool
      overflow; /* too many monomials, too high powers, or coefficients that are no normal numbers: no meaningful value */
};

struct Polynomial polynomial_constant(double value);
struct Polynomial polynomial_atom(int atom);
struct Polynomial polynomial_copy(const struct Polynomial *p);
void polynomial_free(struct Polynomial *p);

/* a + factor * b */
struct Polynomial polynomial_add(const struct Polynomial *a, const struct Polynomial *b, double factor);
struct Polynomial polynomial_multiply(const struct Polynomial *a, const struct Polynomial *b);

/* The quotient, and true where b divides a without remainder; b is not 0. */
bool polynomial_divide(const struct Polynomial *a, const struct Polynomial *b, struct Polynomial *quotient);

/* Takes the largest monomial that divides all terms out of p and gives its exponents. */
void polynomial_take_content(struct Polynomial *p, uint8_t exponent[ATOM_LIMIT]);

/* Multiplies by coefficient and the monomial of these exponents. */
void polynomial_scale(struct Polynomial *p, double coefficient, const uint8_t exponent[ATOM_LIMIT]);

/* The same with a divisor. */
void polynomial_divide_by(struct Polynomial *p, double divisor, const uint8_t exponent[ATOM_LIMIT]);
