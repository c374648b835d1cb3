// A type that Python code describes, and the objects that its commands make.
#pragma once

#include <nanobind/nanobind.h>

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/element.h>

namespace simvis::python {

/// A type that Python code describes. It is never destroyed: the registry refers to it for the rest of the program.
struct WrittenType {
  nanobind::object python_class;
  std::string name, summary;
  std::deque<std::string> texts;  // of the rows
  std::vector<AttributeSpec> rows;
  std::vector<std::string_view> live, values;
};

using WrittenTypes = std::map<std::string, WrittenType*, std::less<>>;

/// Reads the table of attributes. Throws InputError if it is wrong.
std::unique_ptr<WrittenType> describe_type(const nanobind::object& python_class, const std::string& name,
                                           const std::string& summary, nanobind::handle rows);

/// Keeps a text as long as the type.
std::string_view store(WrittenType& type, std::string text);

/// Adds the type to `known` and returns it. A type that is there already gets the new class, as when a cell of a
/// notebook runs again, and the result is null: the registry keeps the table, so another table is an InputError.
/// `taken`: the registry has a type of this name.
WrittenType* keep_type(WrittenTypes& known, std::unique_ptr<WrittenType> type, bool taken);

/// An object of Python that code without the interpreter's lock owns.
class Owned {
 public:
  explicit Owned(nanobind::object object) : object_(std::move(object)) {}
  ~Owned() {
    if (!Py_IsInitialized()) {
      object_.release();
      return;
    }
    const nanobind::gil_scoped_acquire locked;
    object_.reset();
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  nanobind::handle operator*() const { return object_; }

 private:
  nanobind::object object_;
};

/// What the constructor of an element or a sensor gets.
struct CreationContext {
  std::string name;
  nanobind::dict attributes;
  const ElementContext* element = nullptr;  // null: a sensor, or the constructor has returned
};

nanobind::dict values_of(const AttributeValues& values, const std::vector<AttributeSpec>& rows);

/// Makes the Python object of a command. What its constructor raises becomes an error at the command.
nanobind::object make_object(const WrittenType& type, CreationContext& creation, const Command& command);

/// While it lives, the Python code of an element's constructor or update() runs on this thread.
class SceneChange {
 public:
  SceneChange();
  ~SceneChange();
  SceneChange(const SceneChange&) = delete;
  SceneChange& operator=(const SceneChange&) = delete;

 private:
  bool before_;
};

/// Throws InputError where no SceneChange lives: the scene cannot be changed there.
void require_scene_change();

}  // namespace simvis::python
