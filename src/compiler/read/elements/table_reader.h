/* <table>: functions of one or two arguments, interpolated between points. */
#pragma once

#include "read/context/attributes.h"

/* Declares the table of an element. */
void read_table(struct Reader *reader, xmlNodePtr node);
