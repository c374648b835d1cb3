#include "python/core/settings.h"

#include <nanobind/stl/string.h>

#include <chrono>
#include <limits>
#include <memory>

#include <simvis/error.h>
#include <simvis/location.h>
#include "program/options/settings.h"
#include "python/core/arguments.h"
#include "python/core/free_work.h"

namespace nb = nanobind;

namespace simvis::python {
namespace {

// The time between two checks for signals: short for a person, long for a loader that reports each part.
constexpr auto kSignalPeriod = std::chrono::milliseconds(20);

// Lets the user interrupt, and reports the progress to `called`.
ProgressCallback progress_callback(const nb::object& called) {
  // Shared without the interpreter's lock, released with it.
  const std::shared_ptr<nb::object> call(new nb::object(called), [](nb::object* object) {
    if (!Py_IsInitialized()) return;
    const nb::gil_scoped_acquire locked;
    delete object;
  });
  return [call, looked = std::chrono::steady_clock::time_point()](const Progress& progress) mutable {
    const auto now = std::chrono::steady_clock::now();
    const bool look = now - looked > kSignalPeriod;
    if (!look && call->is_none()) return;
    const nb::gil_scoped_acquire locked;
    if (look && PyErr_CheckSignals() != 0) throw nb::python_error();
    looked = now;
    if (!call->is_none()) (*call)(nb::str(progress.work.data(), progress.work.size()), progress.done, progress.total);
  };
}

bool is_text(nb::handle value) { return PyUnicode_Check(value.ptr()) != 0; }

void read(const std::string& name, nb::handle value, bool* field) {
  if (PyBool_Check(value.ptr()) == 0) refuse(name, value, "True or False");
  *field = value.ptr() == Py_True;
}

void read(const std::string& name, nb::handle value, double* field) { *field = number_of(name, value); }

template <typename Whole>
void read_whole(const std::string& name, nb::handle value, Whole* field) {
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  const unsigned long long number = index.is_valid() ? PyLong_AsUnsignedLongLong(index.ptr()) : 0;
  constexpr Whole kMax = std::numeric_limits<Whole>::max();
  if (PyErr_Occurred() != nullptr || number > kMax) {
    PyErr_Clear();
    refuse(name, value, "a whole number from 0 to " + std::to_string(kMax));
  }
  *field = static_cast<Whole>(number);
}

void read(const std::string& name, nb::handle value, unsigned* field) { read_whole(name, value, field); }
void read(const std::string& name, nb::handle value, std::uint64_t* field) { read_whole(name, value, field); }

void read(const std::string& name, nb::handle value, std::string* field) { *field = text_of(name, value); }

/// Calls `add` with each key, a text, and its value. None has no keys.
template <typename Add>
void read_mapping(const std::string& name, nb::handle value, const Add& add) {
  if (value.is_none()) return;
  nb::dict entries;
  if (PyDict_Update(entries.ptr(), value.ptr()) != 0) {
    PyErr_Clear();
    refuse(name, value, "a mapping");
  }
  for (const auto& [key, each] : entries) {
    add(text_of(name + ": a name", key), each);
  }
}

void read(const std::string& name, nb::handle value, std::vector<std::string>* field) {
  if (value.is_none()) return;
  if (is_text(value) || PySequence_Check(value.ptr()) == 0) refuse(name, value, "a list of names");
  for (const nb::handle each : nb::borrow<nb::sequence>(value)) field->push_back(text_of(name, each));
}

void read(const std::string& name, nb::handle value, std::vector<AttributeOverride>* field) {
  read_mapping(name, value, [&](const std::string& key, nb::handle text) {
    std::optional<std::string> attribute;
    if (!text.is_none() && !is_text(text)) {
      refuse("override " + in_quotes(key), text,
             "the text of an attribute, such as " + in_quotes(nb::cast<std::string>(nb::str(text))));
    }
    if (!text.is_none()) attribute = text_of("override " + in_quotes(key), text);
    field->push_back(named_override(key, attribute));
  });
}

void read(const std::string& name, nb::handle value, std::vector<PackageFolder>* field) {
  read_mapping(name, value, [&](const std::string& key, nb::handle folder) {
    field->push_back({key, path_of("package " + in_quotes(key), folder)});
  });
}

void read(const std::string& name, nb::handle value, ProgressCallback* field) {
  if (!value.is_none() && PyCallable_Check(value.ptr()) == 0) refuse(name, value, "a function");
  *field = progress_callback(nb::borrow(value));
}

SimulationDesc read_settings(const nb::kwargs& values) {
  SimulationDesc desc;
  for (const SettingSpec& setting : simulation_settings()) {
    const std::string name(setting.name);
    const nb::object value = values[name.c_str()];
    if (setting.is_absent != nullptr && value.is_none()) {
      *setting.is_absent(desc) = true;
      continue;
    }
    if (setting.is_path) {
      *std::get<std::string*>(setting.field(desc)) = path_of(name, value);
      continue;
    }
    std::visit([&](auto* field) { read(name, value, field); }, setting.field(desc));
  }
  return desc;
}

// The type in Python and the default as it is written there.
nb::tuple type_and_default(bool* value) { return nb::make_tuple("bool", *value ? "True" : "False"); }
nb::tuple type_and_default(double* value) { return nb::make_tuple("float", nb::repr(nb::float_(*value))); }
nb::tuple type_and_default(unsigned* value) { return nb::make_tuple("int", std::to_string(*value)); }
nb::tuple type_and_default(std::uint64_t* value) { return nb::make_tuple("int", std::to_string(*value)); }
nb::tuple type_and_default(std::string* value) { return nb::make_tuple("str", "\"" + *value + "\""); }
nb::tuple type_and_default(std::vector<std::string>*) { return nb::make_tuple("Sequence[str] | None", "None"); }
nb::tuple type_and_default(std::vector<AttributeOverride>*) {
  return nb::make_tuple("Mapping[str, str | None] | None", "None");
}
nb::tuple type_and_default(std::vector<PackageFolder>*) {
  return nb::make_tuple("Mapping[str, str | os.PathLike[str]] | None", "None");
}
nb::tuple type_and_default(ProgressCallback*) {
  return nb::make_tuple("Callable[[str, int, int], None] | None", "None");
}

nb::list setting_table() {
  nb::list rows;
  SimulationDesc defaults;
  for (const SettingSpec& setting : simulation_settings()) {
    const nb::tuple typed = std::visit([](auto* field) { return type_and_default(field); }, setting.field(defaults));
    nb::dict row;
    row["name"] = std::string(setting.name);
    row["type"] = nb::cast<std::string>(typed[0]) + (setting.is_absent == nullptr ? "" : " | None");
    row["default"] = typed[1];
    row["text"] = std::string(setting.text);
    row["absent"] = std::string(setting.absent);
    rows.append(row);
  }
  return rows;
}

}  // namespace

void bind_settings(nb::module_& module) {
  BoundClass<SimulationDesc>(module, "Settings", "The settings of a simulation.")
      .def(
          "__init__",
          [](SimulationDesc* self, const nb::kwargs& values) { new (self) SimulationDesc(read_settings(values)); },
          nb::sig("def __init__(self, **values: object) -> None"));
  module.def("setting_table", &setting_table, "The settings: name, type, default, text, and what None means.",
             nb::sig("def setting_table() -> list[dict[str, str]]"));
}

}  // namespace simvis::python
