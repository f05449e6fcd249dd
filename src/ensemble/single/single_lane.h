/* What is done lane by lane, with the functions that FMUs have for one run. */
#ifndef SINGLE_LANE_H
#define SINGLE_LANE_H

/* series_power() of include/series.h */
double single_power(int k, double n, const double *a, const double *c);

/* A function of include/series_limit.h: what it leaves of the step; rules take of the arguments what they need. */
typedef double SingleLimit(int order, double step, const double *u, const double *other, double number);

SingleLimit single_limit_exponential, single_limit_hyperbolic, single_limit_tanh, single_limit_tangent;
SingleLimit single_limit_positive, single_limit_quotient, single_limit_root, single_limit_whole_power;
SingleLimit single_limit_division, single_limit_power, single_limit_sign, single_limit_angle;

#endif
