#include "scenegraph/name_set.h"

namespace simvis {

void NameSet::claim(const CommandAttribute& name) {
  const auto [found, is_new] = places_.emplace(name.value, name.where);
  if (is_new) return;
  const std::string first = to_string(found->second);
  fail_at(name.where, "the name " + in_quotes(name.value) + " is already taken" +
                          (first.empty() ? "" : " by the " + std::string(kind_) + " at " + first) +
                          ", expected a name that no other " + std::string(kind_) + " has");
}

}  // namespace simvis
