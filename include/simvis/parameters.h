// The four arrays through which everybody reads and writes a running scene: element descriptors, parameter values,
// the change request log and the change log.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>

namespace simvis {

/// One element and its parameters: values[first_value + i] belongs to parameters[i].
struct ElementDescriptor {
  std::string name, type, insertion_point;
  std::vector<AttributeSpec> parameters;  ///< the live rows of the type's table, with this element's own limits
  std::size_t first_value = 0;
};

/// Units    those of each element's table: metres, degrees.
/// Errors   InputError; a value that is refused leaves the old one in place.
class Parameters {
 public:
  const std::vector<ElementDescriptor>& elements() const { return elements_; }
  /// All values of all elements, in one vector.
  std::span<const double> values() const { return values_; }
  /// Commands that somebody asked for, in order.
  const std::vector<std::string>& change_requests() const { return change_requests_; }
  /// Commands that were executed, in order, as they could stand in a scene file.
  const std::vector<std::string>& changes() const { return changes_; }

  /// The index in values() of a parameter. Throws InputError: unknown element or parameter, nearest name suggested.
  std::size_t index(std::string_view element, std::string_view parameter) const;
  /// Throws InputError, naming ELEMENT.PARAM, the value and what is allowed, when it is not finite or out of range.
  void set(std::size_t index, double value);
  /// What the parameter allows: unit and limits of this element's own.
  const AttributeSpec& spec(std::size_t index) const;
  /// "ELEMENT.PARAM"
  std::string name(std::size_t index) const;

  /// `values` are legal and as many as the descriptor's parameters; `first_value` is set here. Counts as no change.
  void add_element(ElementDescriptor descriptor, std::span<const double> values);
  /// Takes back the last add_element().
  void remove_last_element();
  void log_request(std::string command) { change_requests_.push_back(std::move(command)); }
  void log_change(std::string command) { changes_.push_back(std::move(command)); }
  /// Takes back the last log_change().
  void remove_last_change() { changes_.pop_back(); }

  /// Indices into elements() of those with a changed value since the last call, ascending.
  std::vector<std::size_t> drain_changed_elements();

 private:
  std::size_t element_of(std::size_t index) const;

  std::vector<ElementDescriptor> elements_;
  std::vector<double> values_;
  std::vector<std::string> change_requests_, changes_;
  std::vector<bool> element_changed_;
};

}  // namespace simvis
