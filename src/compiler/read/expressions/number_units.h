/*
 * Units of numbers. A number is dimensionless; a number alone adopts the unit of the quantity that it is added to or
 * compared with. If two units would agree provided that a numeric factor had a unit, a warning names the number and
 * parsing continues.
 */
#pragma once

#include "names/scope.h"

/* Return the numeric factor of a product, and of a power or divisor. */
struct NumberFactor factor_of_product(struct NumberFactor first, struct NumberFactor second);
struct NumberFactor factor_raised(struct NumberFactor factor, double power);

/*
 * Returns the numeric factor of a sum, apart from terms that are plain numbers. There is none unless both terms have
 * one: a unit on one term would not repair the sum.
 */
struct NumberFactor factor_of_sum(struct Quantity first, struct Quantity second);

/*
 * Warns that a quantity has another unit than expected, and suggests a unit for its numeric factor: once per number and
 * line. problem: the first half of the message. Returns false without a message if the quantity has no numeric factor.
 */
bool number_may_have_unit(struct Scope *scope, long line, struct Quantity quantity, struct Dimension expected,
                          const char *problem);
