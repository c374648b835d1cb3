// Attribute tables: the rows that describe what a command may give to an element, sensor or effect type, and the
// checked values of one command. The same table checks the XML, holds the defaults, exports the parameters, prints
// `simvis-run --describe TYPE` and drives the tests.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/export.h>

namespace simvis {

/// What the value of an attribute is.
enum class AttributeKind : std::uint8_t {
  number,   ///< a finite double
  integer,  ///< a whole number
  choice,   ///< one of `choices`
  flags,    ///< one or more of `choices`, each at most once, separated by spaces
  vector,   ///< three finite doubles, each within the row's limits
  text,     ///< any text that does not consist of spaces alone
  part,     ///< the name of a part that an earlier command inserted
  object,   ///< the name or path of one object of Scene::objects() that an earlier command made; may be ROOT
  objects,  ///< names, paths and patterns of objects, separated by spaces; those of sensors may come later in the scene
  element,  ///< the name of an element that an earlier command made
  sensor,   ///< the name of a sensor, which may come later in the scene
  file,  ///< the name of a file, relative to the folder of the command; requests of others name files in no other way
};

/// The value of AttributeSpec::min and max that stands for "no limit".
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// One row of a type's table.
struct AttributeSpec {
  std::string_view name;                       ///< the attribute's name in XML
  AttributeKind kind = AttributeKind::number;  ///< what its value is
  std::string_view default_value{};            ///< as written in XML; empty: the attribute has no default
  std::string_view unit{};                     ///< "m", "deg", "Hz"; empty: no unit
  std::string_view text{};                     ///< one sentence for users
  double min = -kNoLimit,                      ///< smallest value; allowed itself unless `open_min`
      max = kNoLimit;                          ///< largest value; allowed itself unless `open_max`
  bool open_min = false,                       ///< `min` itself is not allowed
      open_max = false;                        ///< `max` itself is not allowed
  double rounding = 0;                         ///< a value at most so far beyond `min` or `max` counts as this limit
  std::string_view choices{};                  ///< allowed words, separated by spaces (choice, flags); of a file: how
                                               ///< values begin that name none
  bool live = false;  ///< a number that is exported as a parameter and can change while the scene runs
  /// An angle in degrees without limits: values that differ by 360 mean the same. Trajectories turn it the short way.
  bool full_turn = false;
};

/// The attributes of one type. The rows live as long as the type.
using AttributeTable = std::span<const AttributeSpec>;

/// The attributes of one command, checked against its type's table.
///
/// Every getter takes the name of a row. A name that is not in the table, a row of another kind, and (except for
/// is_set() and where()) a row that is not set are programming errors and assert.
///
/// Errors    the constructor throws InputError; the getters throw nothing.
/// Lifetime  values are copies; returned references live as long as this object. The strings of the table must outlive
///           it.
/// Threads   several threads may read at a time.
class SIMVIS_API AttributeValues {
 public:
  /// Attributes named in `common` (type, name, insert_at, ...) are allowed in addition to the table's rows and are not
  /// interpreted. Throws InputError at the attribute: unknown name (the nearest known name is suggested), not a number,
  /// not finite, out of range, unknown choice. The message says what was seen and what is allowed.
  AttributeValues(const Command& command, AttributeTable table, std::span<const std::string_view> common);

  bool is_set(std::string_view name) const;                         ///< the attribute was written or has a default
  double number(std::string_view name) const;                       ///< in the unit of the row
  std::int64_t integer(std::string_view name) const;                ///< a whole number
  const std::string& choice(std::string_view name) const;           ///< the chosen word
  bool flag(std::string_view name, std::string_view choice) const;  ///< whether `choice`, one of the row's, is listed
  const double (&vector(std::string_view name) const)[3];           ///< three numbers, in the unit of the row
  /// The value of a row of kind text, file, part, object, objects, element or sensor. That of a row of kind part or
  /// object is the object's name, also where its path was written.
  const std::string& text(std::string_view name) const;

  /// The place of the attribute, or of the command if the attribute was not written.
  const Location& where(std::string_view name) const;

 private:
  struct Value {
    AttributeSpec spec;
    bool set = false;
    double number[3] = {0, 0, 0};
    std::int64_t integer = 0;
    std::vector<std::string> words;  // text and names are one word, spaces included
    Location where;
  };
  const Value* find(std::string_view name) const;
  const Value& value(std::string_view name, AttributeKind kind) const;
  static std::string read(std::string_view text, Value& value);
  friend std::string check_table(AttributeTable table);
  std::vector<Value> values_;
};

/// Whether values of this kind name one part, object, element or sensor of the scene.
constexpr bool is_reference(AttributeKind kind) {
  return kind == AttributeKind::part || kind == AttributeKind::object || kind == AttributeKind::element ||
         kind == AttributeKind::sensor;
}

/// Whether the value of an attribute of this row names a file.
SIMVIS_API bool names_file(const AttributeSpec& spec, std::string_view value);

/// Checks that `value` is finite and within the row's range. Returns what is wrong, or an empty string.
SIMVIS_API std::string check_number(const AttributeSpec& spec, double value);

/// Returns what is wrong with a table, or an empty string: two rows of one name, a default that the row itself does not
/// allow, a live row that is not a number or has no default, a row
/// `full_turn` with limits or another unit. The registries refuse types with such a table.
SIMVIS_API std::string check_table(AttributeTable table);

/// The type as `--describe` prints it: its summary, its notes (paragraphs, separated by '\n'), then one aligned row per
/// attribute. Lines are at most 120 columns wide.
SIMVIS_API std::string describe(std::string_view type, std::string_view summary, AttributeTable table,
                                std::string_view notes = {});

/// Reads exactly one finite number; only white space may surround it. Returns false for any other text; `value` is then
/// unspecified.
SIMVIS_API bool parse_number(std::string_view text, double& value);

/// Reads exactly values.size() finite numbers, separated by white space. Returns false for any other text; `values` are
/// then unspecified.
SIMVIS_API bool parse_numbers(std::string_view text, std::span<double> values);

/// The shortest text that reads back to the same double. Whole numbers below 10^9 have no exponent.
SIMVIS_API std::string format_number(double value);

}  // namespace simvis
