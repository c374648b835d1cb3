// SimVis's exceptions as those of the Python package.
#pragma once

#include <nanobind/nanobind.h>

#include <exception>
#include <functional>

namespace simvis::python {

/// InputError and MachineError become simvis.InputError and simvis.MachineError, with the place in the file.
void translate_errors();

/// Keeps what Python code raised while the library called it, where the library allows no exception of Python's. The
/// next call of rethrow_kept() in this thread raises it.
void keep_error(nanobind::python_error error);
/// Keeps the cause of an InputError that the caller throws next. It is raised with that error only: if the library
/// answers the error as a refused request, the cause is forgotten. An exception that ends a program, such as
/// KeyboardInterrupt, is raised itself in place of the InputError, and after a refused request too.
void keep_cause(nanobind::python_error cause);
/// Called with the interpreter's lock, before the library is called: forgets what was kept in this thread.
void forget_kept();
/// Called with the interpreter's lock, after the library was called. Forgets a cause, and raises what keep_error()
/// kept, if anything was.
void rethrow_kept();

/// Calls `work` in a thread of the library, without the interpreter's lock, and raises in it what Python code has
/// raised there. Nothing is left in the thread.
void call_and_raise_kept(const std::function<void()>& work);

}  // namespace simvis::python
