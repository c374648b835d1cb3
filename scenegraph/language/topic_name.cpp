#include "scenegraph/language/topic_name.h"

namespace simvis {
namespace {

bool is_topic_digit(char c) { return c >= '0' && c <= '9'; }
bool is_topic_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

bool is_topic_name(std::string_view text) {
  if (text.size() < 2 || text.front() != '/' || text.back() == '/') return false;
  char before = 'a';
  for (const char c : text) {
    if (c == '/' && before == '/') return false;
    if (is_topic_digit(c) && before == '/') return false;
    if (c != '/' && c != '_' && !is_topic_digit(c) && !is_topic_letter(c)) return false;
    before = c;
  }
  return true;
}

std::string topic_name(std::string_view name, std::string_view what) {
  std::string topic = "/";
  for (const char c : name) {
    if (topic.back() == '/' && is_topic_digit(c)) topic += 'n';
    topic += c == '/' || is_topic_digit(c) || is_topic_letter(c) ? c : '_';
  }
  return topic + "/" + std::string(what);
}

}  // namespace simvis
