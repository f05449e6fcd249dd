/* Write the sections on formulas that the author gave. Each writes nothing if there are none. */
#ifndef VALUE_SECTIONS_H
#define VALUE_SECTIONS_H

#include "page.h"

void write_calculated(struct Page *page);
void write_definitions(struct Page *page);
void write_starts(struct Page *page);
void write_rates(struct Page *page);
void write_outputs(struct Page *page);

#endif
