/*
 * Random numbers without a state: functions of a seed and a whole number, equal bit for bit on every machine. The
 * generator is the counter-based Philox4x32-10 (J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw: Parallel random
 * numbers: as easy as 1, 2, 3, SC 2011).
 */
#ifndef RANDOM_NUMBERS_H
#define RANDOM_NUMBERS_H

#include <math.h>
#include <stdint.h>

/* Replaces the counter by its 128 random bits: ten rounds of Philox. */
static inline void random_block(uint32_t counter[4], const uint32_t key[2]) {
  uint32_t first = key[0], second = key[1];
  for (int round = 0; round < 10; round++) {
    uint64_t low = (uint64_t)0xD2511F53u * counter[0], high = (uint64_t)0xCD9E8D57u * counter[2];
    uint32_t next = (uint32_t)(high >> 32) ^ counter[1] ^ first;
    counter[2] = (uint32_t)(low >> 32) ^ counter[3] ^ second;
    counter[0] = next;
    counter[1] = (uint32_t)high;
    counter[3] = (uint32_t)low;
    first += 0x9E3779B9u;
    second += 0xBB67AE85u;
  }
}

/* Returns the nearest whole number as bits of a two's complement; 0 from 2^62 on. */
static inline uint64_t random_bits_of(double x) {
  double nearest = floor(x + 0.5);
  return fabs(nearest) < 0x1p62 ? (uint64_t)(int64_t)nearest : 0;
}

/* Returns 64 random bits for a seed and a number k. Streams are independent of each other. */
static inline uint64_t random_word(double seed, double k, uint32_t stream) {
  uint64_t number = random_bits_of(k), of_seed = random_bits_of(seed);
  uint32_t counter[4] = {(uint32_t)number, (uint32_t)(number >> 32), stream, 0};
  const uint32_t key[2] = {(uint32_t)of_seed, (uint32_t)(of_seed >> 32)};
  random_block(counter, key);
  return (uint64_t)counter[0] << 32 | counter[1];
}

/* Returns a multiple of 2^-53 in [0, 1), all equally likely. */
static inline double random_uniform(double seed, double k) {
  return (double)(random_word(seed, k, 0) >> 11) * 0x1p-53;
}

/* Returns x y. The compiler cannot fuse it with an addition, which would round differently on some machines. */
static inline double random_product(double x, double y) {
  volatile double product = x * y;
  return product;
}

/*
 * Returns the natural logarithm of a positive number, to a few rounding errors: the series of 2 atanh((m - 1)/(m + 1))
 * up to degree 23, for a mantissa m in [0.7, 1.42).
 */
static inline double random_logarithm(double x) {
  int exponent;
  double m = frexp(x, &exponent);
  if (m < 0x1.6a09e667f3bcdp-1) {
    m *= 2.0;
    exponent--;
  }
  double ratio = (m - 1.0) / (m + 1.0), square = random_product(ratio, ratio), sum = 0.0;
  for (int n = 23; n > 0; n -= 2) sum = random_product(sum, square) + 1.0 / n;
  return random_product(exponent, 0x1.62e42fefa39efp-1) + random_product(2.0 * ratio, sum);
}

/* Returns the polynomial with 8 coefficients, that of x^7 first, by Horner's rule. */
static inline double random_polynomial(const double coefficients[8], double x) {
  double sum = coefficients[0];
  for (int i = 1; i < 8; i++) sum = random_product(sum, x) + coefficients[i];
  return sum;
}

/* Returns the normal quantile of a probability in (0, 1), to 16 digits (M. J. Wichura: Algorithm AS 241, 1988). */
static inline double random_quantile(double probability) {
  static const double above[3][8] = {
      {2.5090809287301226727e3, 3.3430575583588128105e4, 6.7265770927008700853e4, 4.5921953931549871457e4,
       1.3731693765509461125e4, 1.9715909503065514427e3, 1.3314166789178437745e2, 3.3871328727963666080e0},
      {7.74545014278341407640e-4, 2.27238449892691845833e-2, 2.41780725177450611770e-1, 1.27045825245236838258e0,
       3.64784832476320460504e0, 5.76949722146069140550e0, 4.63033784615654529590e0, 1.42343711074968357734e0},
      {2.01033439929228813265e-7, 2.71155556874348757815e-5, 1.24266094738807843860e-3, 2.65321895265761230930e-2,
       2.96560571828504891230e-1, 1.78482653991729133580e0, 5.46378491116411436990e0, 6.65790464350110377720e0}};
  static const double below[3][8] = {
      {5.2264952788528545610e3, 2.8729085735721942674e4, 3.9307895800092710610e4, 2.1213794301586595867e4,
       5.3941960214247511077e3, 6.8718700749205790830e2, 4.2313330701600911252e1, 1.0},
      {1.05075007164441684324e-9, 5.47593808499534494600e-4, 1.51986665636164571966e-2, 1.48103976427480074590e-1,
       6.89767334985100004550e-1, 1.67638483018380384940e0, 2.05319162663775882187e0, 1.0},
      {2.04426310338993978564e-15, 1.42151175831644588870e-7, 1.84631831751005468180e-5, 7.86869131145613259100e-4,
       1.48753612908506148525e-2, 1.36929880922735805310e-1, 5.99832206555887937690e-1, 1.0}};
  double centred = probability - 0.5, tail = centred < 0.0 ? probability : 1.0 - probability;
  if (fabs(centred) <= 0.425) {
    double r = 0.180625 - random_product(centred, centred);
    return random_product(centred, random_polynomial(above[0], r) / random_polynomial(below[0], r));
  }
  double r = sqrt(-random_logarithm(tail));
  int part = r <= 5.0 ? 1 : 2;
  r -= part == 1 ? 1.6 : 5.0;
  double size = random_polynomial(above[part], r) / random_polynomial(below[part], r);
  return centred < 0.0 ? -size : size;
}

/* Returns a standard normal number, at most 8.2 in size: the quantile at the middle of an interval of 2^-52. */
static inline double random_gauss(double seed, double k) {
  return random_quantile(((double)(random_word(seed, k, 1) >> 12) + 0.5) * 0x1p-52);
}

#endif
