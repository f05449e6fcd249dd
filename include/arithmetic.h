/*
 * Every source needs the arithmetic of IEEE 754: checks for infinities and NaN, and sums that carry their rounding along,
 * are else optimized away.
 */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "-ffast-math makes results wrong without a word; compile without it, and without -Ofast and -ffinite-math-only"
#endif
