#include "exchange/messages/topics.h"

#include <fnmatch.h>

#include <utility>

namespace simvis::ros {

TopicFilter::TopicFilter(std::vector<std::string> patterns)
    : patterns_(std::move(patterns)), matched_(patterns_.size(), false) {}

bool TopicFilter::wants(const std::string& topic, TopicForm form) {
  if (patterns_.empty()) return form != TopicForm::other;
  const auto [decided, is_new] = decided_.emplace(topic, false);
  if (!is_new) return decided->second;
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    if (::fnmatch(patterns_[i].c_str(), topic.c_str(), 0) != 0) continue;
    matched_[i] = true;
    decided->second = true;
  }
  return decided->second;
}

std::vector<std::string> TopicFilter::unmatched() const {
  std::vector<std::string> left;
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    if (!matched_[i]) left.push_back(patterns_[i]);
  }
  return left;
}

}  // namespace simvis::ros
