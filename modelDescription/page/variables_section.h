/* Writes the table of variables, up to ROW_LIMIT rows. */
#ifndef VARIABLES_SECTION_H
#define VARIABLES_SECTION_H

#include "page.h"

void write_variables(struct Page *page);

#endif
