#include "python/core/errors.h"

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include "python/core/free_work.h"

namespace nb = nanobind;

namespace simvis::python {
namespace {

thread_local std::optional<nb::python_error> kept, kept_cause;

struct Place {
  std::string_view file;
  int line = 0, column = 0;
};

// "FILE:LINE:COLUMN: error: ...", or only FILE, or neither.
Place place_of(std::string_view message) {
  const std::size_t end = message.find(": error: ");
  if (end == message.npos) return {};
  Place place{message.substr(0, end)};
  int* const numbers[] = {&place.column, &place.line};
  int found[] = {0, 0};
  std::size_t count = 0;
  std::string_view rest = place.file;
  while (count < 2) {
    const std::size_t colon = rest.rfind(':');
    if (colon == rest.npos) break;
    const std::string_view digits = rest.substr(colon + 1);
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), found[count]);
    if (digits.empty() || error != std::errc() || last != digits.data() + digits.size()) break;
    rest = rest.substr(0, colon);
    ++count;
  }
  if (count == 2) {
    *numbers[0] = found[0];
    *numbers[1] = found[1];
  } else if (count == 1) {
    place.line = found[0];
  }
  place.file = rest;
  return place;
}

// Messages name files as the caller did, also by bytes that are no UTF-8.
nb::str decoded(std::string_view bytes) {
  return nb::steal<nb::str>(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "surrogateescape"));
}

// KeyboardInterrupt and SystemExit end a program; no handler of errors should catch them.
bool ends_program(const nb::python_error& error) { return !error.matches(PyExc_Exception); }

// What Python code raised on the way is the cause.
void raise(const char* type, const std::exception& error) {
  const InsideModule inside;  // Python code makes the exception
  if (kept && ends_program(*kept)) {
    nb::python_error ending = std::move(*kept);
    forget_kept();
    return ending.restore();
  }
  const nb::object make = nb::module_::import_("simvis._errors").attr(type);
  const std::string_view message = error.what();
  const Place place = place_of(message);
  const nb::object raised = make(decoded(message), decoded(place.file), place.line, place.column);
  if (const auto& cause = kept_cause ? kept_cause : kept) raised.attr("__cause__") = cause->value();
  forget_kept();
  PyErr_SetObject(raised.type().ptr(), raised.ptr());
}

}  // namespace

void translate_errors() {
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (const InputError& error) {
          raise("InputError", error);
        } catch (const MachineError& error) {
          raise("MachineError", error);
        }
      },
      nullptr);
}

void keep_error(nb::python_error error) {
  if (!kept) kept.emplace(std::move(error));
}

void keep_cause(nb::python_error cause) {
  if (ends_program(cause)) return keep_error(std::move(cause));
  kept_cause.emplace(std::move(cause));
}

void forget_kept() {
  kept_cause.reset();
  kept.reset();
}

void rethrow_kept() {
  kept_cause.reset();
  if (!kept) return;
  nb::python_error error = std::move(*kept);
  kept.reset();
  throw nb::python_error(std::move(error));
}

void call_and_raise_kept(const std::function<void()>& work) {
  const auto is_empty = [] { return !kept && !kept_cause; };
  try {
    work();
  } catch (...) {
    if (is_empty()) throw;
    const nb::gil_scoped_acquire locked;
    if (kept && ends_program(*kept)) rethrow_kept();
    forget_kept();
    throw;
  }
  if (is_empty()) return;
  const nb::gil_scoped_acquire locked;
  rethrow_kept();
}

}  // namespace simvis::python
