/*
 * A hand-written Taylor loop for theta'' = -(g/l) sin(theta), to compare with generated code: pendulum_by_hand END
 * ORDER REPEATS. Prints the seconds of the fastest repeat and the final angle.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { LENGTH = 24 };

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double simulate(double end, int order) {
  double theta[LENGTH] = {1.0}, omega[LENGTH] = {0.0}, s[LENGTH], c[LENGTH], time = 0.0;
  while (time < end) {
    s[0] = sin(theta[0]);
    c[0] = cos(theta[0]);
    for (int k = 0; k < order; k++) {
      if (k > 0) {
        double sine = 0.0, cosine = 0.0;
        for (int j = 0; j < k; j++) {
          sine += omega[j] * c[k - 1 - j];
          cosine -= omega[j] * s[k - 1 - j];
        }
        s[k] = sine / k;
        c[k] = cosine / k;
      }
      theta[k + 1] = omega[k] / (k + 1);
      omega[k + 1] = -9.81 * s[k] / (k + 1);
    }
    double last = fmax(fabs(theta[order]), fabs(omega[order]) / fmax(1.0, fabs(omega[0])));
    double before = fmax(fabs(theta[order - 1]), fabs(omega[order - 1]) / fmax(1.0, fabs(omega[0])));
    double step = exp(-fmax(log(last) / order, log(before) / (order - 1)) - 2.0 - 0.7 / (order - 1));
    if (time + step > end) step = end - time;
    double angle = theta[order], rate = omega[order];
    for (int j = order - 1; j >= 0; j--) {
      angle = angle * step + theta[j];
      rate = rate * step + omega[j];
    }
    theta[0] = angle;
    omega[0] = rate;
    time += step;
  }
  return theta[0];
}

int main(int count, char **words) {
  if (count != 4) return 2;
  double end = strtod(words[1], NULL), best = 1e300, angle = 0.0;
  int order = (int)strtol(words[2], NULL, 10);
  if (order < 2 || order >= LENGTH) return 2;
  for (long i = strtol(words[3], NULL, 10); i > 0; i--) {
    double start = seconds();
    angle = simulate(end, order);
    double taken = seconds() - start;
    if (taken < best) best = taken;
  }
  printf("%.9g %.17g\n", best, angle);
  return 0;
}
