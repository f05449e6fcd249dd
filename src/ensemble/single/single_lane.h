/* Functions that are applied lane by lane, compiled for one run. */
#pragma once

/* Returns a coefficient as series_power() of include/series.h. */
double single_power(int k, double n, const double *a, const double *c);

/* A function of include/series_limit.h: returns the shortened step. Each rule uses the arguments that it needs. */
typedef double SingleLimit(int order, double step, const double *u, const double *other, double number);

SingleLimit single_limit_exponential, single_limit_hyperbolic, single_limit_bounded, single_limit_tanh,
    single_limit_tangent;
SingleLimit single_limit_positive, single_limit_quotient, single_limit_root, single_limit_whole_power;
SingleLimit single_limit_division, single_limit_power, single_limit_sign, single_limit_angle;
