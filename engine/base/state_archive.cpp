#include <simvis/state_archive.h>

#include <bit>
#include <cstring>
#include <utility>

#include <simvis/error.h>

namespace simvis {

static_assert(std::endian::native == std::endian::little);  // numbers are copied

void StateArchive::refuse(const std::string& why) const {
  const std::string object = open_.empty() ? "the simulation" : open_.back();
  throw InputError(is_reading_ ? "the state does not fit " + object + ": " + why
                               : "the state of " + object + " cannot be saved: " + why);
}

void StateArchive::raw(void* data, std::size_t size) {
  if (size == 0) return;
  if (!is_reading_) {
    written_.append(static_cast<const char*>(data), size);
    return;
  }
  if (size > unread_.size()) refuse("it ends too early");
  std::memcpy(data, unread_.data(), size);
  unread_.remove_prefix(size);
}

void StateArchive::count(std::size_t& values, std::size_t size) {
  std::uint64_t number = values;
  raw(&number, sizeof number);
  if (is_reading_ && number > unread_.size() / size) refuse("it ends too early");
  values = number;
}

void StateArchive::object(std::string_view title, const std::function<void()>& members) {
  std::string found(title);
  value(found);
  if (found != title) {
    throw InputError("the state has " + found + " where the simulation has " + std::string(title) +
                     ", expected the state of the same scene");
  }
  std::uint64_t size = 0;
  const std::size_t begin = written_.size();
  raw(&size, sizeof size);
  if (is_reading_ && size > unread_.size()) refuse("it ends too early");
  const std::string_view behind = is_reading_ ? unread_.substr(size) : std::string_view();
  if (is_reading_) unread_ = unread_.substr(0, size);
  open_.push_back(std::move(found));
  members();
  if (!unread_.empty()) refuse("it has " + std::to_string(unread_.size()) + " bytes too many");
  open_.pop_back();
  unread_ = behind;
  if (is_reading_) return;
  size = written_.size() - begin - sizeof size;
  std::memcpy(written_.data() + begin, &size, sizeof size);
}

}  // namespace simvis
