/* The tables that end the generated file: variables, results, and the system's description. */
#ifndef EMIT_TABLES_H
#define EMIT_TABLES_H

#include "write/emitter.h"

void emit_tables(const struct Emitter *emitter, const char *guid);

#endif
