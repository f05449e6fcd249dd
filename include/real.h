/*
 * The numbers that generated functions compute with, and what these do by a condition. An ensemble compiles the same
 * functions over numbers that hold one of each of several runs (src/ensemble/lanes.h).
 */
#ifndef REAL_H
#define REAL_H

#include <stdbool.h>

typedef double Real;

/* What a comparison of two gives. */
typedef bool Condition;
#define BOTH(first, second) ((first) && (second))

/* A constant among them. */
#define REAL(number) (number)

/* The same where an array is initialized, and a function of <math.h> there. */
#define CONSTANT(number) (number)
#define FUNCTION(name) name

/* The first where the condition holds, else the second. */
#define WHERE(condition, first, second) ((condition) ? (first) : (second))

/* Whether it holds in any of them. */
#define ANYWHERE(condition) (condition)

/* Lets the function return the number unless the condition holds. */
#define REQUIRE(condition, number)                                                                                     \
  do {                                                                                                                 \
    if (!(condition)) return (number);                                                                                 \
  } while (0)

#endif
