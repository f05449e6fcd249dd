/* Writes a drawing as SVG. */
#ifndef SVG_H
#define SVG_H

#include <libxml/xmlwriter.h>

#include "picture_shapes.h"

/* Writes an <svg> element; the page's style colours the classes of the looks. */
void write_sketch(xmlTextWriterPtr writer, const struct Drawing *drawing);

/* Writes an SVG file on white. Returns false if libxml2 reports an error. */
bool write_icon(xmlBufferPtr buffer, const struct Drawing *drawing);

#endif
