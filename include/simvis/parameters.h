// The four arrays through which programs read and write a running scene: element descriptors, parameter values,
// the change request log and the change log.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/export.h>
#include <simvis/state_archive.h>

namespace simvis {

/// One element and its parameters: values[first_value + i] belongs to parameters[i].
struct ElementDescriptor {
  std::string name,                       ///< the element's name
      type,                               ///< its type
      insertion_point;                    ///< where it was inserted
  std::vector<AttributeSpec> parameters;  ///< the live rows of the type's table, with this element's own limits
  std::size_t first_value = 0;            ///< index of its first value in Parameters::values()
  bool removed = false;                   ///< it keeps its place and its indices, which no other element gets
};

/// The parameters of all elements of a scene, and the logs of its changes.
///
/// Units     those of each element's table: metres, degrees.
/// Errors    InputError. A value that is refused leaves the old one in place.
/// Lifetime  returned references and spans are valid until an element is added or removed (see Simulation::execute()).
/// Threads   as the simulation: one thread at a time.
class SIMVIS_API Parameters {
 public:
  const std::vector<ElementDescriptor>& elements() const {
    return elements_;
  }  ///< in the order in which they were made
  /// All values of all elements, in one vector.
  std::span<const double> values() const { return values_; }
  /// The texts of commands that were requested, in order, including refused ones.
  const std::vector<std::string>& change_requests() const { return change_requests_; }
  /// Commands that were executed, in order, in the form of a scene file: with the names of the whole scene and absolute
  /// file names. Executed one after the other, or together, they make the same scene.
  const std::vector<std::string>& changes() const { return changes_; }

  /// The index of a parameter in values(). Throws InputError for an unknown element or parameter; the nearest name is
  /// suggested.
  std::size_t index(std::string_view element, std::string_view parameter) const;
  /// Sets a value. Throws InputError if there is no such index, if its element was removed, or if the value is not
  /// finite or out of range; the message then says ELEMENT.PARAM, the value and what is allowed.
  void set(std::size_t index, double value);
  /// Unit and limits of the parameter, as this element allows them. Throws InputError if there is no such index.
  const AttributeSpec& spec(std::size_t index) const;
  /// "ELEMENT.PARAM". Throws InputError if there is no such index.
  std::string name(std::size_t index) const;
  /// Whether the element of this parameter was removed. Throws InputError if there is no such index.
  bool is_removed(std::size_t index) const { return elements_[element_of(index)].removed; }

  /// Adds an element. `values` are within the limits, and as many as the descriptor's parameters; `first_value` is set
  /// here. The new element is not marked as changed.
  void add_element(ElementDescriptor descriptor, std::span<const double> values);
  /// Reverts the last add_element().
  void remove_last_element();
  /// Marks an element as removed, or as there again. Its index exists (asserted).
  void mark_removed(std::size_t element, bool removed);
  /// Tells index() the name of something else in the scene, for its message: `kind` is "sensor" or "part", static text.
  void add_other(std::string name, std::string_view kind);
  void remove_other(std::string_view name, std::string_view kind);                           ///< reverts add_other()
  void log_request(std::string command) { change_requests_.push_back(std::move(command)); }  ///< appends a request
  void log_change(std::string command) { changes_.push_back(std::move(command)); }           ///< appends a change
  /// Reverts the last log_change().
  void remove_last_change() { changes_.pop_back(); }

  /// Indices into elements() of the elements whose values changed since the last call, ascending.
  std::vector<std::size_t> drain_changed_elements();
  /// Writes all values, and which elements drain_changed_elements() would return, or replaces them. Throws InputError
  /// for a value that set() refuses.
  void archive(StateArchive& state);

 private:
  std::size_t element_of(std::size_t index) const;

  std::vector<ElementDescriptor> elements_;
  std::vector<double> values_;
  std::vector<std::string> change_requests_, changes_;
  std::vector<bool> element_changed_;
  // What is not an element and yet has a name.
  struct Other {
    std::string name;
    std::string_view kind;
  };
  std::vector<Other> others_;
};

}  // namespace simvis
