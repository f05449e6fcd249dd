/* <table>: functions of one or two variables that are given by points. */
#ifndef TABLES_H
#define TABLES_H

#include "read/context/attributes.h"
#include "read/expressions/parser_state.h"

/* Declares the table of an element. */
void read_table(struct Reader *reader, xmlNodePtr node);

struct Table;

/* The table of this full name; NULL where there is none. */
const struct Table *table_named(const struct Scope *scope, const char *full_name);

bool table_has_two_arguments(const struct Table *table);

/* The table at its one or two arguments, an expression of pieces.h. */
struct Quantity table_at(struct Parser *parser, const struct Table *table, const char *name,
                         const struct Quantity arguments[2]);

void tables_free(struct Names *tables);

#endif
