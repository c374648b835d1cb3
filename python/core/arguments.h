// Arguments of Python that are checked here, since the message of a type that does not fit would not name them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <chrono>
#include <glm/glm.hpp>
#include <string>

namespace simvis::python {

/// Throws InputError: "NAME is VALUE, expected ...".
[[noreturn]] void refuse(const std::string& name, nanobind::handle value, const std::string& expected);

/// A number, of any type of Python that converts to one. Throws InputError if the value is none.
double number_of(const std::string& name, nanobind::handle value, const char* expected = "a number");

/// The length of a step. Throws InputError if the value is no number of seconds above 0, or beyond the clock's range.
std::chrono::nanoseconds length_of(nanobind::handle dt_s);

/// The UTF-8 of a text. Throws InputError if the value is no text, or has half of a surrogate pair.
std::string text_of(const std::string& name, nanobind::handle value);

/// The bytes of a path: of a str, bytes or os.PathLike, as os.fsencode() has them. Throws InputError if the value is
/// none of these, or has a NUL, behind which the system would not read on.
std::string path_of(const std::string& name, nanobind::handle value);

/// A matrix of 4 x 4 numbers, row by row.
using Matrix = nanobind::ndarray<const double, nanobind::shape<4, 4>, nanobind::device::cpu>;
glm::dmat4 to_matrix(const Matrix& rows);

}  // namespace simvis::python
