#include "python/core/arguments.h"

#include <nanobind/stl/string.h>

#include <cmath>
#include <cstddef>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/location.h>

namespace nb = nanobind;

namespace simvis::python {

void refuse(const std::string& name, nb::handle value, const std::string& expected) {
  throw InputError(name + " is " + nb::cast<std::string>(nb::repr(value)) + ", expected " + expected);
}

double number_of(const std::string& name, nb::handle value, const char* expected) {
  const bool is_number = PyUnicode_Check(value.ptr()) == 0 && PyNumber_Check(value.ptr()) != 0;
  const double number = is_number ? PyFloat_AsDouble(value.ptr()) : 0;
  if (!is_number || (number == -1 && PyErr_Occurred() != nullptr)) {
    PyErr_Clear();
    refuse(name, value, expected);
  }
  return number;
}

std::chrono::nanoseconds length_of(nb::handle dt_s) {
  const double seconds = number_of("dt_s", dt_s, "seconds");
  const double dt_ns = std::round(seconds * 1e9);
  if (!(dt_ns >= 1 && dt_ns < 9e18)) {
    throw InputError("dt_s is " + format_number(seconds) + ", expected seconds above 0 within the clock's 292 years");
  }
  return std::chrono::nanoseconds(static_cast<std::int64_t>(dt_ns));
}

std::string text_of(const std::string& name, nb::handle value) {
  std::string text;
  if (!nb::try_cast(value, text)) refuse(name, value, "a text of whole characters");
  return text;
}

std::string path_of(const std::string& name, nb::handle value) {
  PyObject* encoded = nullptr;
  if (PyUnicode_FSConverter(value.ptr(), &encoded) == 0) {
    PyErr_Clear();
    refuse(name, value, "a path without NUL");
  }
  const auto path = nb::steal<nb::bytes>(encoded);
  return {path.c_str(), path.size()};
}

glm::dmat4 to_matrix(const Matrix& rows) {
  glm::dmat4 matrix;
  for (glm::length_t row = 0; row < 4; ++row) {
    for (glm::length_t column = 0; column < 4; ++column) {
      matrix[column][row] = rows(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
    }
  }
  return matrix;
}

}  // namespace simvis::python
