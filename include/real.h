/*
 * The number type of generated functions, and operations that depend on conditions. An ensemble compiles the same
 * functions with a vector type, one lane for each run (src/ensemble/lanes.h).
 */
#ifndef REAL_H
#define REAL_H

#include <stdbool.h>

typedef double Real;

/* Result of a comparison. */
typedef bool Condition;
#define BOTH(first, second) ((first) && (second))

/* A constant as a Real. */
#define REAL(number) (number)

/* A constant in the initializer of an array, and a function of <math.h> there. */
#define CONSTANT(number) (number)
#define FUNCTION(name) name

/* Returns first if the condition holds, else second; in each lane. */
#define WHERE(condition, first, second) ((condition) ? (first) : (second))

/* True if the condition holds in any lane. */
#define ANYWHERE(condition) (condition)

/* Returns number from the function unless the condition holds. */
#define REQUIRE(condition, number)                                                                                     \
  do {                                                                                                                 \
    if (!(condition)) return (number);                                                                                 \
  } while (0)

#endif
