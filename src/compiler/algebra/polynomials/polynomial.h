/*
 * Sparse polynomials with numeric coefficients in up to ATOM_LIMIT indeterminates ("atoms"), and exact division.
 *
 * polynomial_divide() is multivariate division in lexicographic order (D. Cox, J. Little, D. O'Shea: Ideals,
 * Varieties, and Algorithms, section 2.3). Each step removes the leading monomial of the remainder, so that the
 * next one is smaller. The division ends at the remainder 0, or fails at a leading monomial that b's does not
 * divide. Sums merge sorted lists, in linear time; a product of m and n terms takes O(m n^2) steps at worst.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Limits of the size of a monomial and of a polynomial: larger ones are no simpler than the expressions. */
enum { ATOM_LIMIT = 24, MONOMIAL_LIMIT = 400 };

/* coefficient times the product of the atoms to these exponents; the coefficient is not 0. */
struct Monomial {
  double coefficient;
  uint8_t exponent[ATOM_LIMIT];
};

/* Invariants: monomials in descending lexicographic order, no coefficient 0. The polynomial 0 has no monomials. */
struct Polynomial {
  struct Monomial *terms;
  size_t count;
  bool overflow; /* more than MONOMIAL_LIMIT terms, an exponent above 255, or a coefficient that is not normal */
};

struct Polynomial polynomial_constant(double value);
struct Polynomial polynomial_atom(int atom);
struct Polynomial polynomial_copy(const struct Polynomial *p);
void polynomial_free(struct Polynomial *p);

/* Returns a + factor * b. */
struct Polynomial polynomial_add(const struct Polynomial *a, const struct Polynomial *b, double factor);
struct Polynomial polynomial_multiply(const struct Polynomial *a, const struct Polynomial *b);

/* Computes the quotient a / b if the remainder is 0; else returns false. b is not 0. */
bool polynomial_divide(const struct Polynomial *a, const struct Polynomial *b, struct Polynomial *quotient);

/* Divides p by the largest monomial that divides all terms; returns its exponents. */
void polynomial_take_content(struct Polynomial *p, uint8_t exponent[ATOM_LIMIT]);

/* Multiplies p by coefficient times the monomial with these exponents. */
void polynomial_scale(struct Polynomial *p, double coefficient, const uint8_t exponent[ATOM_LIMIT]);

/* Multiplies p by the monomial, and divides by divisor. */
void polynomial_divide_by(struct Polynomial *p, double divisor, const uint8_t exponent[ATOM_LIMIT]);
