// What an element or sensor type can be given: one table per type. The same table checks the XML, gives the defaults,
// exports the parameters, prints `simvis-run --describe TYPE` and feeds the tests.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>

namespace simvis {

enum class AttributeKind : std::uint8_t {
  number,   ///< a finite double
  integer,  ///< a whole number
  choice,   ///< one of `choices`
  flags,    ///< several of `choices`, separated by spaces
  vector,   ///< three finite doubles
  text,     ///< anything
  part,     ///< the name of a part that stands by now
  element,  ///< the name of an element that stands by now
  sensor,   ///< the name of a sensor, which may come later in the scene
};

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// One row of a type's table.
struct AttributeSpec {
  std::string_view name;
  AttributeKind kind = AttributeKind::number;
  std::string_view default_value{};        ///< as it would be written; empty: not given means unset
  std::string_view unit{};                 ///< "m", "deg", "Hz", ""
  std::string_view text{};                 ///< one sentence for people
  double min = -kNoLimit, max = kNoLimit;  ///< both allowed, unless `open_min` or `open_max`
  bool open_min = false, open_max = false;
  std::string_view choices{};  ///< separated by spaces (choice, flags)
  bool live = false;           ///< a number that is exported as a parameter and can change while the scene runs
};

using AttributeTable = std::span<const AttributeSpec>;

/// The attributes of one command, checked against its type's table.
///
/// Every getter names a row of the table; to ask for another name or kind is our bug and asserts.
class AttributeValues {
 public:
  /// Besides the table's rows, `common` names are allowed and left alone (type, name, insert_at, ...).
  /// Throws InputError at the attribute: unknown name (nearest known suggested), not a number, not finite, out of
  /// range, unknown choice; the message says what was seen and what is allowed.
  AttributeValues(const Command& command, AttributeTable table, std::span<const std::string_view> common);

  bool is_set(std::string_view name) const;  ///< given, or has a default
  double number(std::string_view name) const;
  std::int64_t integer(std::string_view name) const;
  const std::string& choice(std::string_view name) const;
  bool flag(std::string_view name, std::string_view choice) const;
  const double (&vector(std::string_view name) const)[3];
  /// Of the kinds text, part, element and sensor.
  const std::string& text(std::string_view name) const;

  /// The place of the attribute, or of the command where it was not written.
  const Location& where(std::string_view name) const;

 private:
  struct Value {
    AttributeSpec spec;
    bool set = false;
    double number[3] = {0, 0, 0};
    std::int64_t integer = 0;
    std::vector<std::string> words;  // of text and names: the whole as one word
    Location where;
  };
  const Value* find(std::string_view name) const;
  const Value& value(std::string_view name, AttributeKind kind) const;
  static std::string read(std::string_view text, Value& value);
  friend std::string check_table(AttributeTable table);
  std::vector<Value> values_;
};

/// Whether values of this kind name something else in the scene: a part, an element or a sensor.
constexpr bool is_reference(AttributeKind kind) {
  return kind == AttributeKind::part || kind == AttributeKind::element || kind == AttributeKind::sensor;
}

/// Checks that `value` is finite and within the row's range; returns what is wrong, or an empty string.
std::string check_number(const AttributeSpec& spec, double value);

/// What is wrong with a table, or an empty string: two rows of one name, a default that the row itself does not allow,
/// a live row that is no number or has no default. For the registries, which stop the program on it.
std::string check_table(AttributeTable table);

/// The type as `--describe` prints it: its summary, its notes (paragraphs, separated by '\n'), then one aligned row per
/// attribute. Lines are at most 120 columns wide.
std::string describe(std::string_view type, std::string_view summary, AttributeTable table,
                     std::string_view notes = {});

/// The known name most like `seen`, or an empty string when none is near.
std::string nearest_name(std::string_view seen, std::span<const std::string_view> known);

/// ", did you mean \"NAME\"?" or, with none near, an empty string.
std::string suggestion(std::string_view seen, std::span<const std::string_view> known);

/// Exactly one finite number written in `text` and nothing else but spaces. False otherwise.
bool parse_number(std::string_view text, double& value);

/// Exactly values.size() finite numbers separated by spaces. False otherwise.
bool parse_numbers(std::string_view text, std::span<double> values);

/// The shortest text that reads back to the same double.
std::string format_number(double value);

}  // namespace simvis
