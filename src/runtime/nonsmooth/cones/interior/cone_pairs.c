#include "nonsmooth/cones/interior/cone_pairs.h"

#include <math.h>

double length_of_tail(const double *pair, size_t size) {
  return size == 2 ? fabs(pair[1]) : hypot(pair[1], pair[2]);
}

/* Returns a^2 - |b|^2 of (a, b), which is positive inside of the cone. */
static double cone_determinant(const double *pair, size_t size) {
  double length = length_of_tail(pair, size);
  return (pair[0] - length) * (pair[0] + length);
}

struct Scaling scaling_of(const double *s, const double *y, size_t size) {
  double of_s = sqrt(cone_determinant(s, size)), of_y = sqrt(cone_determinant(y, size)), product = 0.0;
  struct Scaling scaling = {.factor = of_y / of_s};
  for (size_t i = 0; i < size; i++) product += s[i] / of_s * (y[i] / of_y);
  double gamma = sqrt(0.5 * (1.0 + product));
  for (size_t i = 0; i < size; i++) scaling.v[i] = ((i == 0 ? 1.0 : -1.0) * s[i] / of_s + y[i] / of_y) / (2.0 * gamma);
  return scaling;
}

/* Returns the square root of a scaling, which is one of v = u o u. */
static struct Scaling root_of(const struct Scaling *scaling) {
  struct Scaling root = {.factor = sqrt(scaling->factor)};
  double size = sqrt(2.0 * (1.0 + scaling->v[0]));
  for (size_t i = 0; i < CONE_SIZE; i++) root.v[i] = (scaling->v[i] + (i == 0 ? 1.0 : 0.0)) / size;
  return root;
}

static struct Scaling inverse_of(const struct Scaling *scaling) {
  return (struct Scaling){.v = {scaling->v[0], -scaling->v[1], -scaling->v[2]}, .factor = 1.0 / scaling->factor};
}

double scaling_element(const struct Scaling *scaling, size_t i, size_t j) {
  double reflection = i != j ? 0.0 : i == 0 ? 1.0 : -1.0;
  return (2.0 * scaling->v[i] * scaling->v[j] - reflection) * scaling->factor;
}

void scale_pair(const struct Scaling *scaling, size_t size, const double *vector, double *scaled) {
  for (size_t i = 0; i < size; i++) {
    scaled[i] = 0.0;
    for (size_t j = 0; j < size; j++) scaled[i] += scaling_element(scaling, i, j) * vector[j];
  }
}

/* Fills mu e - a o b. */
static void fill_centered(double mu, const double *a, const double *b, size_t size, double *centered) {
  centered[0] = mu;
  for (size_t i = 0; i < size; i++) centered[0] -= a[i] * b[i];
  for (size_t i = 1; i < size; i++) centered[i] = -a[0] * b[i] - b[0] * a[i];
}

/* Replaces b by the solution x of a o x = b. */
static void divide_by(const double *a, size_t size, double *b) {
  double sum = a[0] * b[0];
  for (size_t i = 1; i < size; i++) sum -= a[i] * b[i];
  b[0] = sum / cone_determinant(a, size);
  for (size_t i = 1; i < size; i++) b[i] = (b[i] - b[0] * a[i]) / a[0];
}

/* With a = Q^(1/2) ds and b = Q^(-1/2) dy, t is Q^(1/2) x, where Q^(1/2) s o x = mu e - a o b. */
void fill_target(const struct Scaling *scaling, size_t size, const double *s, const double *ds, const double *dy,
                 double mu, double *target) {
  struct Scaling root = root_of(scaling), inverse = inverse_of(&root);
  double a[CONE_SIZE], b[CONE_SIZE], x[CONE_SIZE];
  scale_pair(&root, size, ds, a);
  scale_pair(&inverse, size, dy, b);
  fill_centered(mu, a, b, size, x);
  scale_pair(&root, size, s, a);
  divide_by(a, size, x);
  scale_pair(&root, size, x, target);
}

double longest_step_in_cone(const double *pair, const double *change, size_t size) {
  double b = pair[0] * change[0], length = INFINITY;
  for (size_t i = 1; i < size; i++) b -= pair[i] * change[i];
  double a = cone_determinant(change, size), c = cone_determinant(pair, size), root = b * b - a * c;
  if ((a < 0.0 || b < 0.0) && root >= 0.0 && sqrt(root) > b) length = c / (sqrt(root) - b);
  if (change[0] < 0.0) length = fmin(length, -pair[0] / change[0]);
  return length;
}
