// A set of unique names of one kind, such as parts or elements.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include <simvis/command.h>

namespace simvis {

/// The names of one kind that are in use, and the places that claimed them.
class NameSet {
 public:
  /// `kind` is the noun for messages: "part", "element". The text must outlive this object.
  explicit NameSet(std::string_view kind) : kind_(kind) {}

  /// Throws InputError at the attribute if the name is taken; the message names the place that has it.
  void claim(const CommandAttribute& name);

  /// Makes a claimed name free again.
  void release(const std::string& name) { places_.erase(name); }

  /// Whether the name is taken.
  bool contains(const std::string& name) const { return places_.contains(name); }

  /// Takes a name that no command gave. A name that is already taken stays so.
  void reserve(std::string name) { places_.emplace(std::move(name), Location{}); }

 private:
  std::string_view kind_;
  std::map<std::string, Location> places_;
};

}  // namespace simvis
