#pragma once
// Owners of cairo's handles, and cairo's errors as exceptions. Only for the sources of this folder:
// the public headers do not show cairo.

#include <cairo.h>

#include <memory>
#include <string>

#include "taut/picture/image.h"

namespace taut::detail {

struct CairoDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using CairoContext = std::unique_ptr<cairo_t, CairoDeleter>;

// An opaque drawing surface in memory. Throws InputError when cairo cannot make one of this size
// (its limit is 32767 pixels a side).
CairoSurface make_canvas(int width, int height);

// A copy of the image as a cairo surface.
CairoSurface to_cairo(const Image& image);

// The surface as the bytes of a PNG file. Throws InputError with cairo's reason.
std::string encode_png(cairo_surface_t* surface);

// Throws InputError("WHAT: cairo's reason") unless status is success.
void check_cairo(cairo_status_t status, const char* what);

}  // namespace taut::detail
