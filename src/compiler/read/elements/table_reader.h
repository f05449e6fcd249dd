/* <table>: functions of one or two variables that are given by points. */
#ifndef TABLE_READER_H
#define TABLE_READER_H

#include "read/context/attributes.h"

/* Declares the table of an element. */
void read_table(struct Reader *reader, xmlNodePtr node);

#endif
