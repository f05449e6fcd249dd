#include "lane_limit.h"

/* Returns the sum over k >= 1 of |u_k| step^k; even and odd powers are two independent chains. */
static Lanes excursion(const Lanes *u, int order, Lanes step) {
  Lanes square = step * step, even = {0}, odd = {0};
  int k = order;
  if (k % 2 == 0) even = lanes_absolute(u[k--]);
  for (; k > 1; k -= 2) {
    odd = odd * square + lanes_absolute(u[k]);
    even = even * square + lanes_absolute(u[k - 1]);
  }
  odd = odd * square + lanes_absolute(u[1]);
  return step * odd + square * even;
}

static void take_lane(double *row, const Lanes *rows, int order, int lane) {
  for (int k = 0; rows != NULL && k <= order; k++) row[k] = rows[k][lane];
}

void lane_limit(struct SeriesLimit *limit, SingleLimit *rule, Lanes bound, const Lanes *u, const Lanes *other,
                Lanes number) {
  Mask may_hide = ~(excursion(u, limit->order, limit->step) <= bound);
  if (!any_lane(may_hide)) return;
  for (int i = 0; i < LANES; i++) {
    if (!may_hide[i]) continue;
    double row[SERIES_LENGTH], other_row[SERIES_LENGTH];
    take_lane(row, u, limit->order, i);
    take_lane(other_row, other, limit->order, i);
    double step = rule(limit->order, limit->step[i], row, other_row, number[i]);
    if (step < limit->step[i]) limit->shortened[i] = -1;
    limit->step[i] = step;
  }
}

Lanes lane_series_power(int k, Lanes n, const Lanes *a, const Lanes *c) {
  Lanes coefficient = {0};
  for (int i = 0; i < LANES; i++) {
    double base[SERIES_LENGTH], power[SERIES_LENGTH];
    take_lane(base, a, k, i);
    take_lane(power, c, k - 1, i);
    coefficient[i] = single_power(k, n[i], base, power);
  }
  return coefficient;
}
