/*
 * The start of the simulation: constraints fulfilled, modes found, impacts and events at the start behind it. What is read in
 * initialization mode is that of this start; what is set are the values that it is found from.
 */
#ifndef START_H
#define START_H

#include "instance/instance.h"

/* Brings the instance from the values that were set to the start; an error, logged, where there is none. */
enum Status start_find(struct Instance *instance, const char *function);

/*
 * Gives an instance in initialization mode the values of the start, to be read alone, until start_hide() gives it back those
 * that were set. Where there is no start, a warning says once why, and the values stay as they were set. In other modes
 * nothing happens.
 */
void start_show(struct Instance *instance, const char *function);
void start_hide(struct Instance *instance);

/* Numbers of workspace that an instance needs to show it. */
size_t start_work_count(void);

#endif
