// SimVis's exceptions as those of the Python package.
#pragma once

#include <nanobind/nanobind.h>

#include <exception>

namespace simvis::python {

/// InputError and MachineError become simvis.InputError and simvis.MachineError, with the place in the file.
void translate_errors();

/// Keeps what Python code raised while the library called it, where the library allows no exception of Python's. The
/// next call of rethrow_kept() in this thread raises it.
void keep_error(nanobind::python_error error);
/// Called with the interpreter's lock. Raises what was kept, if anything was.
void rethrow_kept();

}  // namespace simvis::python
