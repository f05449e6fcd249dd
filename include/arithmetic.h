/*
 * Rejects compilers' options that break IEEE 754. They would remove checks for infinities and NaN, and the error terms
 * of compensated sums.
 */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "these sources need IEEE 754 arithmetic; remove -ffast-math, -Ofast and -ffinite-math-only"
#endif
