#include "licenses.h"

#include <string.h>

/* The file LICENSE, which the build makes a string of. */
extern const char license_text[];

/* Packing looks for the names of files here, and puts these beside. */
void licenses_write(FILE *file, const struct Program *program) {
  const struct Method *method = program->equations->method;
  const char *solver = program->solver;
  fprintf(file, "%s.fmu was made with lagrange-fmu, of which it has a part in it, under the licence below.\n",
          program->model->name);
  if (method != NULL && method->uses_library) fputs("SUNDIALS is linked into it: sundials.txt\n", file);
  if (solver != NULL && strcmp(solver, "bdf_sparse") == 0)
    fputs("KLU of SuiteSparse is linked into it: suitesparse.txt, LGPL-2.1.txt\n", file);
  fprintf(file, "\n%s", license_text);
}
