/* <table>: functions of one variable that are given by points. */
#ifndef TABLES_H
#define TABLES_H

#include "read/attributes.h"
#include "read/parser_state.h"

/* Declares the table of an element. */
void read_table(struct Reader *reader, xmlNodePtr node);

struct Table;

/* The table of this full name; NULL where there is none. */
const struct Table *table_named(const struct Scope *scope, const char *full_name);

/*
 * The table at an argument. As expression it is the first value and what each interval adds to it: its cubic of the way in
 * it, which min and max hold between 0 and the interval's width. So every method takes it piece by piece, as it does these.
 */
struct Quantity table_at(struct Parser *parser, const struct Table *table, const char *name, struct Quantity argument);

void tables_free(struct Names *tables);

#endif
