// Names of topics, and which of them are wanted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scenegraph/language/topic_name.h"

namespace simvis::ros {

using simvis::topic_name;

/// Whether a topic holds what no other topic holds, holds it in another form, or gets one message after the last frame.
enum class TopicForm : std::uint8_t { own, other, at_end };

/// The topics that a recording has.
class TopicFilter {
 public:
  /// Patterns in which * stands for any text and ? for any character. Without patterns, all topics but those of another
  /// form.
  explicit TopicFilter(std::vector<std::string> patterns);

  bool wants(const std::string& topic, TopicForm form = TopicForm::own);
  /// The patterns that no topic has matched so far.
  std::vector<std::string> unmatched() const;

 private:
  std::vector<std::string> patterns_;
  std::vector<bool> matched_;            // by pattern
  std::map<std::string, bool> decided_;  // by topic
};

}  // namespace simvis::ros
