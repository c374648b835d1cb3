// The state of objects as bytes: one function of a class both writes its state and reads it back, so that the two
// cannot differ.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <simvis/export.h>

namespace simvis {

class Group;

/// Writes values one after the other, or reads them in the same order.
///
/// Bytes    numbers are little-endian, without gaps. The bytes are read by the version of SimVis that wrote them.
/// Errors   InputError if what is read is too short, too long or not what the object takes. Values that were read
///          before stay read: the caller restores the former state.
/// Threads  one thread at a time.
class SIMVIS_API StateArchive {
 public:
  StateArchive() = default;  ///< writes
  /// Reads these bytes, which must outlive it.
  explicit StateArchive(std::string_view bytes) : is_reading_(true), unread_(bytes) {}

  /// For a state that is restored into the objects that wrote it: require() accepts all values, and the state also has
  /// what saved states omit.
  void keep_all() { keeps_all_ = true; }
  bool keeps_all() const { return keeps_all_; }          ///< whether keep_all() was called
  bool is_reading() const { return is_reading_; }        ///< whether values are read
  const std::string& bytes() const { return written_; }  ///< what was written

  /// Writes the values, or reads them: numbers, bool, text, vectors and matrices of glm, std::vector, std::array,
  /// std::map and std::optional of them, and structs with a member function `archive(StateArchive&)`.
  template <typename... Values>
  void operator()(Values&... values) {
    (value(values), ...);
  }
  /// A value of an enumeration whose values are 0 to `last`.
  template <typename Enum>
  void choice(Enum& value, Enum last) {
    auto number = static_cast<std::uint32_t>(value);
    raw(&number, sizeof number);
    require(number <= static_cast<std::uint32_t>(last));
    value = static_cast<Enum>(number);
  }
  /// Values of double, vectors and matrices of them, which must be finite, also when they are written.
  template <typename... Values>
  void finite(Values&... values) {
    (finite_value(values), ...);
  }
  /// The number of values that follow, of at least `size` bytes each: no more than there are bytes left.
  void count(std::size_t& values, std::size_t size);
  /// Calls `members` for what belongs to one object, whose title errors name: `element "BALL"`. It must read as many
  /// bytes as it wrote.
  void object(std::string_view title, const std::function<void()>& members);

  /// Throws InputError, naming the object, unless the value is one that the object takes.
  void require(bool is_taken) const {
    if (!is_taken && !keeps_all_) refuse("it holds a value that is not possible there");
  }
  /// Notes the times of the last frame and of the next one, between which the state stands.
  void set_frames(std::int64_t last_ns, std::int64_t next_ns) {
    last_ns_ = last_ns;
    next_ns_ = next_ns;
  }
  std::int64_t last_ns() const { return last_ns_; }  ///< simulated time of the last frame; 0: there is none
  /// Notes whether the sensor is on whose state follows: one that is off needs no state that nobody can write.
  void set_on(bool is_on) { is_on_ = is_on; }
  bool is_on() const { return is_on_; }  ///< that of set_on(); true before
  /// Notes the graph of the scene, which outlives the archive: what it has anyway is written as a number.
  void set_graph(const Group& root) { graph_ = &root; }
  const Group& graph() const { return *graph_; }  ///< that of set_graph(), which was called before
  /// As require(), of a time at which something was measured: a frame that failed has the time of the next one.
  void require_past(std::int64_t time_ns) const { require(!is_reading_ || (time_ns >= 0 && time_ns <= next_ns_)); }
  /// Throws InputError: "the state does not fit OBJECT: WHY", or "the state of OBJECT cannot be saved: WHY".
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  void raw(void* data, std::size_t size);
  static std::span<const double> numbers_of(const double& number) { return {&number, 1}; }
  template <typename T>
  static std::span<const double> numbers_of(const T& numbers) {
    return {glm::value_ptr(numbers), sizeof(T) / sizeof(double)};
  }
  template <typename T>
  void finite_value(T& numbers) {
    value(numbers);
    const std::span<const double> all = numbers_of(numbers);
    require(std::all_of(all.begin(), all.end(), [](double each) { return std::isfinite(each); }));
  }

  template <typename T>
  void value(T& each) {
    if constexpr (std::is_same_v<T, bool>) {
      auto byte = static_cast<std::uint8_t>(each);
      raw(&byte, 1);
      require(byte <= 1);
      each = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      raw(&each, sizeof each);
    } else {
      each.archive(*this);
    }
  }
  void value(std::string& text) {
    std::size_t size = text.size();
    count(size, 1);
    text.resize(size);
    raw(text.data(), size);
  }
  template <typename T>
  void value(std::vector<T>& all) {
    std::size_t size = all.size();
    constexpr bool kIsNumber = std::is_arithmetic_v<T>;
    count(size, kIsNumber ? sizeof(T) : 1);
    if constexpr (kIsNumber) {
      all.resize(size);
      raw(all.data(), size * sizeof(T));
    } else {  // one by one: memory follows what is there, not its number
      if (all.size() > size) all.resize(size);
      for (std::size_t i = 0; i < size; ++i) value(i < all.size() ? all[i] : all.emplace_back());
    }
  }
  template <typename T, std::size_t size>
  void value(std::array<T, size>& all) {
    for (T& each : all) value(each);
  }
  template <typename T>
  void value(std::optional<T>& one) {
    bool is_there = one.has_value();
    value(is_there);
    if (!is_there) return one.reset();
    if (!one) one = T{};
    value(*one);
  }
  template <typename Key, typename T>
  void value(std::map<Key, T>& all) {
    std::size_t size = all.size();
    count(size, 1);
    if (is_reading_) all.clear();
    for (auto next = all.begin(); size > 0; --size) {
      Key key{};
      if (!is_reading_) key = next->first;
      value(key);
      if (is_reading_) {
        require(!all.contains(key));
        value(all[key]);
      } else {
        value((next++)->second);
      }
    }
  }
  template <glm::length_t size, typename T, glm::qualifier q>
  void value(glm::vec<size, T, q>& vector) {
    raw(glm::value_ptr(vector), sizeof vector);
  }
  template <glm::length_t columns, glm::length_t rows, typename T, glm::qualifier q>
  void value(glm::mat<columns, rows, T, q>& matrix) {
    raw(glm::value_ptr(matrix), sizeof matrix);
  }
  template <typename T, glm::qualifier q>
  void value(glm::qua<T, q>& turn) {
    raw(glm::value_ptr(turn), sizeof turn);
  }

  bool is_reading_ = false, keeps_all_ = false, is_on_ = true;
  std::int64_t last_ns_ = 0, next_ns_ = 0;
  const Group* graph_ = nullptr;
  std::string written_;
  std::string_view unread_;
  std::vector<std::string> open_;  // titles of the objects that are under way, the innermost one last
};

/// An element or sensor with a state that later frames depend on, beside its parameters. What can be computed from
/// these, or again, is no part of it. An element or sensor without such a state does not derive from this class.
class SIMVIS_API Stateful {
 public:
  virtual ~Stateful() = default;
  /// Writes the state between two frames, or replaces it by one that an object of the same command has written. Of an
  /// element, update() with all values comes first.
  virtual void archive(StateArchive& state) = 0;
};

}  // namespace simvis
