// Measurements as values that other processes get: by pickle, copy.deepcopy(), simvis.map() and loaders of data.
#pragma once

#include <nanobind/nanobind.h>

namespace simvis::python {

/// What a measurement consists of, as tuples of numbers, texts and bytes, and the measurement made of it again. It has
/// everything that Python reads of one; numbers that are computed when they are read become numbers. The tuples are for
/// the same version of SimVis on a machine of the same byte order. Throws InputError for any other tuple.
///
/// Threads  with the interpreter's lock.
void bind_pickling(nanobind::module_& module);  ///< follows bind_measurements()

}  // namespace simvis::python
