/* A drawing as SVG. */
#ifndef SVG_H
#define SVG_H

#include <libxml/xmlwriter.h>

#include "shapes.h"

/* An <svg> in a page, whose style gives the classes of the looks their colours. */
void write_sketch(xmlTextWriterPtr writer, const struct Drawing *drawing);

/* A file of its own, on white paper. False where libxml2 reports an error. */
bool write_icon(xmlBufferPtr buffer, const struct Drawing *drawing);

#endif
