#include <simvis/parameters.h>

#include <algorithm>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/assert.h"

namespace simvis {

std::size_t Parameters::index(std::string_view element, std::string_view parameter) const {
  const auto found = std::ranges::find_if(
      elements_, [&](const ElementDescriptor& each) { return !each.removed && each.name == element; });
  if (found == elements_.end()) {
    const auto other = std::ranges::find(others_, element, &Other::name);
    if (other != others_.end()) {
      throw InputError("there is no element " + in_quotes(element) + ": it is a " + std::string(other->kind) +
                       ", whose attributes are fixed, expected an element");
    }
    std::vector<std::string_view> known;
    for (const ElementDescriptor& descriptor : elements_) {
      if (!descriptor.removed) known.push_back(descriptor.name);
    }
    throw InputError("there is no element " + in_quotes(element) + suggestion(element, known));
  }
  const auto row = std::ranges::find(found->parameters, parameter, &AttributeSpec::name);
  if (row == found->parameters.end()) {
    std::vector<std::string_view> known;
    std::string list;
    for (const AttributeSpec& spec : found->parameters) {
      known.push_back(spec.name);
      list += (list.empty() ? "" : ", ") + std::string(spec.name);
    }
    throw InputError("element " + in_quotes(element) + " has no parameter " + in_quotes(parameter) +
                     suggestion(parameter, known) +
                     (list.empty() ? " (it has none)" : " (expected one of: " + list + ")"));
  }
  return found->first_value + static_cast<std::size_t>(row - found->parameters.begin());
}

std::size_t Parameters::element_of(std::size_t index) const {
  if (index >= values_.size()) {
    throw InputError("there is no parameter of index " + std::to_string(index) + ", expected one below " +
                     std::to_string(values_.size()));
  }
  // The last element that starts at or before the index. An element without parameters has the same start as the next.
  const auto after = std::ranges::upper_bound(elements_, index, {}, &ElementDescriptor::first_value);
  return static_cast<std::size_t>(after - elements_.begin()) - 1;
}

const AttributeSpec& Parameters::spec(std::size_t index) const {
  const ElementDescriptor& element = elements_[element_of(index)];
  return element.parameters[index - element.first_value];
}

void Parameters::set(std::size_t index, double value) {
  const std::size_t element = element_of(index);
  if (elements_[element].removed) throw InputError(name(index) + ": the element was removed");
  const std::string wrong = check_number(spec(index), value);
  if (!wrong.empty()) throw InputError(name(index) + ": " + wrong);
  value = std::clamp(value, spec(index).min, spec(index).max);  // see AttributeSpec::rounding
  if (values_[index] == value) return;
  values_[index] = value;
  element_changed_[element] = true;
}

std::string Parameters::name(std::size_t index) const {
  return elements_[element_of(index)].name + "." + std::string(spec(index).name);
}

void Parameters::add_element(ElementDescriptor descriptor, std::span<const double> values) {
  SIMVIS_ASSERT(descriptor.parameters.size() == values.size());
  descriptor.first_value = values_.size();
  elements_.push_back(std::move(descriptor));
  values_.insert(values_.end(), values.begin(), values.end());
  element_changed_.push_back(false);
}

void Parameters::remove_last_element() {
  SIMVIS_ASSERT(!elements_.empty());
  values_.resize(elements_.back().first_value);
  elements_.pop_back();
  element_changed_.pop_back();
}

void Parameters::mark_removed(std::size_t element, bool removed) {
  SIMVIS_ASSERT(element < elements_.size());
  elements_[element].removed = removed;
  element_changed_[element] = false;
}

void Parameters::remove_other(std::string_view name, std::string_view kind) {
  const auto found =
      std::ranges::find_if(others_, [&](const Other& each) { return each.name == name && each.kind == kind; });
  SIMVIS_ASSERT(found != others_.end());
  others_.erase(found);
}

void Parameters::add_other(std::string name, std::string_view kind) { others_.push_back({std::move(name), kind}); }

std::vector<std::size_t> Parameters::drain_changed_elements() {
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < element_changed_.size(); ++i) {
    if (element_changed_[i]) changed.push_back(i);
    element_changed_[i] = false;
  }
  return changed;
}

// Values of removed elements, which keep their places here, count only where as many were removed.
void Parameters::archive(StateArchive& state) {
  std::vector<double> live, removed;
  for (const ElementDescriptor& each : elements_) {
    const auto first = values_.begin() + static_cast<std::ptrdiff_t>(each.first_value);
    std::vector<double>& values = each.removed ? removed : live;
    values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(each.parameters.size()));
  }
  const std::size_t live_count = live.size(), removed_count = removed.size();
  state(live, removed);
  state.require(live.size() == live_count);
  std::vector<double> all = values_;
  std::size_t next_live = 0, next_removed = 0;
  for (std::size_t element = 0; element < elements_.size(); ++element) {
    const ElementDescriptor& each = elements_[element];
    for (std::size_t i = 0; i < each.parameters.size(); ++i) {
      double& value = all[each.first_value + i];
      if (each.removed) {
        if (removed.size() == removed_count) value = removed[next_removed++];
        continue;
      }
      value = live[next_live++];
      state.require(check_number(each.parameters[i], value).empty());
    }
    if (each.removed) continue;
    bool is_changed = element_changed_[element];
    state(is_changed);
    element_changed_[element] = is_changed;
  }
  values_ = std::move(all);
}

}  // namespace simvis
