/* The table of all variables, or of very many of them. */
#ifndef VARIABLES_SECTION_H
#define VARIABLES_SECTION_H

#include "page.h"

void write_variables(struct Page *page);

#endif
