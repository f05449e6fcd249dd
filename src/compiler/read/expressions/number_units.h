/*
 * The units of numbers. A number is a pure number; one that stands alone takes the unit of what it is added to or compared
 * with. Where units only fit if a number that multiplies had one, a warning names it, and the reading goes on.
 */
#pragma once

#include "read/names/scope.h"

/* The factor of a product, of a quotient's divisor, and of a power. */
struct NumberFactor factor_of_product(struct NumberFactor first, struct NumberFactor second);
struct NumberFactor factor_raised(struct NumberFactor factor, double power);

/* The factor of a sum and the like: what mends one term alone mends nothing. */
struct NumberFactor factor_of_sum(struct Quantity first, struct Quantity second);

/*
 * Warns that a quantity has another unit than expected, and what its number must be instead: once for each number on a
 * line. problem: what does not fit. False, without a message, where no number could mend it.
 */
bool number_may_have_unit(struct Scope *scope, long line, struct Quantity quantity, struct Dimension expected,
                          const char *problem);
