// Attribute rows that are bound to the members of a plain struct, a desc. The kind and the default of a row come from
// its member, and the same rows read the attributes of a command into a desc: each default is stated once.
//
//   struct TouchDesc {
//     double length_m = 0.1;
//     NoiseDesc noise{};
//     static AttributeRows<TouchDesc> rows();
//   };
//   AttributeRows<TouchDesc> TouchDesc::rows() {
//     return {row(&TouchDesc::length_m, "length", "m", kAboveZero, "length of the feeler along +x"),
//             nested(&TouchDesc::noise, noise_rows("", "the depth", "m")), kRateAttribute};
//   }
//
// Conditions  `only()` says for which commands a row is meant, by members that rows before it read:
//   row(&LightDesc::range_m, "range", "m", kNotNegative, "...").live().only("for a spot light", &LightDesc::is_spot)
// The other commands may not write it, and do not export it if it is live.
//
// Members  double, float: a number; integers: a whole number; glm::dvec3: a vector; bool and enums: a choice;
//          std::string: a text, a file or a name; std::optional of these: a row without a default.
#pragma once

#include <concepts>
#include <functional>
#include <glm/glm.hpp>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "engine/base/assert.h"

namespace simvis {

/// The unit of an attribute. The member is the attribute times `factor`.
struct AttributeUnit {
  constexpr AttributeUnit(const std::convertible_to<std::string_view> auto& unit, double of_one = 1)
      : name(unit), factor(of_one) {}

  std::string_view name;
  double factor;
};
inline constexpr AttributeUnit kDegrees{"deg", glm::radians(1.0)};  ///< of a member in radians

/// The numbers that a row allows, as in AttributeSpec.
struct AttributeLimits {
  double min = -kNoLimit, max = kNoLimit;
  bool open_min = false, open_max = false;
};
inline constexpr AttributeLimits kAnyNumber{}, kNotNegative{.min = 0}, kAboveZero{.min = 0, .open_min = true};

/// The words of a choice, in the order of the table, and the values that they stand for.
template <typename Value>
using AttributeWords = std::vector<std::pair<Value, std::string_view>>;

/// The word that stands for a value; empty if none does.
template <typename Value>
std::string_view word_of(const AttributeWords<Value>& words, const Value& value) {
  for (const auto& [each, word] : words) {
    if (each == value) return word;
  }
  return {};
}

/// Keeps a text for the rest of the program: tables hold views.
std::string_view keep_text(std::string text);

/// The rows of several tables as one, which lives as long as the program.
AttributeTable join_tables(const std::vector<std::vector<AttributeSpec>>& tables);

/// The shortest number for a scene from which `convert` makes `value`.
std::string written_number(double value, double (*convert)(double number, double factor), double factor);

/// Throws InputError at the attribute: `when` says for which commands it is meant.
[[noreturn]] void refuse_row(const CommandAttribute& written, std::string_view when);

/// One row, or a step between rows if it has no name.
template <typename Desc>
struct AttributeRow {
  AttributeSpec spec{};                                       ///< its default comes from `written`
  std::function<std::string(const Desc&)> written{};          ///< the member as in XML; null: no default
  std::function<void(Desc&, const AttributeValues&)> read{};  ///< null: nothing of the desc depends on the row
  /// Gives the member the value of a row of one number, in the unit of the row; null for other rows.
  std::function<void(Desc&, double)> set{};
  std::function<bool(const Desc&)> allowed{};  ///< whether a command with this desc has the row; null: always
  std::string_view when{};                     ///< the condition in words, "for a spot light"

  AttributeRow without_default() && {  ///< for a member whose default says "not given"
    written = nullptr;
    return std::move(*this);
  }
  AttributeRow live() && {  ///< exported as a parameter
    spec.live = true;
    return std::move(*this);
  }
  AttributeRow full_turn() && {  ///< an angle in degrees without limits
    spec.full_turn = true;
    return std::move(*this);
  }
  /// `holds` may be a member of the desc. A lambda, since a member's own type would be a name that the library exports.
  template <typename Holds>
  AttributeRow only(std::string_view condition, Holds holds) && {
    when = condition;
    allowed = [holds = std::move(holds)](const Desc& desc) -> bool { return std::invoke(holds, desc); };
    return std::move(*this);
  }
  bool is_allowed(const Desc& desc) const { return !allowed || allowed(desc); }
};

/// The rows of one desc, in the order of its table.
template <typename Desc>
class AttributeRows {
 public:
  AttributeRows(AttributeRow<Desc> row) { rows_.push_back(std::move(row)); }
  AttributeRows(const AttributeSpec& spec) { rows_.push_back({.spec = spec}); }
  AttributeRows(AttributeTable table) {
    for (const AttributeSpec& spec : table) rows_.push_back({.spec = spec});
  }
  AttributeRows(std::initializer_list<AttributeRows> parts) {
    for (const AttributeRows& part : parts) rows_.insert(rows_.end(), part.rows_.begin(), part.rows_.end());
  }

  void add(AttributeRow<Desc> row) { rows_.push_back(std::move(row)); }
  const std::vector<AttributeRow<Desc>>& list() const { return rows_; }

  /// The same condition for all of these rows.
  template <typename Holds>
  AttributeRows only(std::string_view condition, const Holds& holds) && {
    for (AttributeRow<Desc>& row : rows_) row = std::move(row).only(condition, holds);
    return std::move(*this);
  }

  /// The table, which lives as long as the program. Defaults are those of Desc().
  AttributeTable table() const {
    std::vector<AttributeSpec> specs;
    for (const AttributeRow<Desc>& row : rows_) {
      if (row.spec.name.empty()) continue;
      specs.push_back(row.spec);
      if (row.written) specs.back().default_value = keep_text(row.written(Desc()));
    }
    return join_tables({specs});
  }

  /// The desc of a command. Throws what the steps between the rows throw.
  Desc read(const AttributeValues& attributes) const {
    Desc desc;
    for (const AttributeRow<Desc>& row : rows_) {
      if (row.read) row.read(desc, attributes);
    }
    return desc;
  }

  /// The same. Throws InputError at an attribute that is written but not meant for such a command.
  Desc read(const Command& command, const AttributeValues& attributes) const {
    const Desc desc = read(attributes);
    for (const AttributeRow<Desc>& row : rows_) {
      if (row.is_allowed(desc)) continue;
      if (const CommandAttribute* const written = command.find(row.spec.name)) refuse_row(*written, row.when);
    }
    return desc;
  }

  /// Takes the rows away that are not meant for commands with this desc, as Element::adapt_parameters() does.
  void adapt(const Desc& desc, std::vector<AttributeSpec>& live_rows) const {
    for (const AttributeRow<Desc>& row : rows_) {
      if (row.is_allowed(desc)) continue;
      std::erase_if(live_rows, [&](const AttributeSpec& live) { return live.name == row.spec.name; });
    }
  }

  /// Gives the members of the live rows that are meant for this desc, which are all bound to one, these values, in the
  /// order of the table.
  void set(Desc& desc, std::span<const double> values) const {
    std::size_t next = 0;
    for (const AttributeRow<Desc>& row : rows_) {
      if (!row.spec.live || !row.is_allowed(desc)) continue;
      SIMVIS_ASSERT(row.set);
      row.set(desc, values[next++]);
    }
  }

 private:
  std::vector<AttributeRow<Desc>> rows_;
};

/// The rows of a desc, made once.
template <typename Desc>
const AttributeRows<Desc>& rows_of() {
  static const AttributeRows<Desc> rows = Desc::rows();
  return rows;
}

/// A step between rows, such as a check of those before it. `step` gets the desc and the attributes.
template <typename Desc, typename Step>
AttributeRow<Desc> checked(Step step) {
  return {.read = std::move(step)};
}

/// The rows of a member that is a desc of its own, with the defaults that the outer desc gives it.
template <typename Desc, typename Part>
AttributeRows<Desc> nested(Part Desc::*member, const AttributeRows<Part>& rows) {
  AttributeRows<Desc> lifted{};
  for (const AttributeRow<Part>& row : rows.list()) {
    AttributeRow<Desc> outer{.spec = row.spec};
    if (row.written) outer.written = [member, inner = row.written](const Desc& desc) { return inner(desc.*member); };
    if (row.read) {
      outer.read = [member, inner = row.read](Desc& desc, const AttributeValues& a) { inner(desc.*member, a); };
    }
    if (row.set) outer.set = [member, inner = row.set](Desc& desc, double value) { inner(desc.*member, value); };
    if (row.allowed) outer.allowed = [member, inner = row.allowed](const Desc& desc) { return inner(desc.*member); };
    outer.when = row.when;
    lifted.add(std::move(outer));
  }
  return lifted;
}

namespace rows_detail {

template <typename T>
struct Plain {
  using Type = T;
  static constexpr bool kIsOptional = false;
};
template <typename T>
struct Plain<std::optional<T>> {
  using Type = T;
  static constexpr bool kIsOptional = true;
};

template <typename Number>
Number converted(double number, double factor) {
  return static_cast<Number>(number * factor);
}

template <typename Value>
Value number(const AttributeValues& attributes, std::string_view name, double factor) {
  if constexpr (std::same_as<Value, glm::dvec3>) {
    const double(&v)[3] = attributes.vector(name);
    return factor * glm::dvec3(v[0], v[1], v[2]);
  } else if constexpr (std::integral<Value>) {
    return static_cast<Value>(attributes.integer(name));
  } else {
    return converted<Value>(attributes.number(name), factor);
  }
}

template <typename Value>
std::string written(const Value& value, double factor) {
  if constexpr (std::same_as<Value, glm::dvec3>) {
    return written(value.x, factor) + " " + written(value.y, factor) + " " + written(value.z, factor);
  } else if constexpr (std::same_as<Value, float>) {
    return written_number(
        value, [](double x, double by) -> double { return converted<float>(x, by); }, factor);
  } else {
    return written_number(static_cast<double>(value), converted<double>, factor);
  }
}

template <typename Value>
constexpr AttributeKind number_kind() {
  if (std::same_as<Value, glm::dvec3>) return AttributeKind::vector;
  return std::integral<Value> ? AttributeKind::integer : AttributeKind::number;
}

// `access` returns the number in a desc.
template <typename Desc, typename Access>
AttributeRow<Desc> number_row(Access access, std::string_view name, const AttributeUnit& unit,
                              const AttributeLimits& limits, std::string_view text) {
  using Member = std::remove_cvref_t<decltype(access(std::declval<Desc&>()))>;
  using Value = typename Plain<Member>::Type;
  AttributeRow<Desc> made{.spec = {.name = name,
                                   .kind = number_kind<Value>(),
                                   .unit = unit.name,
                                   .text = text,
                                   .min = limits.min,
                                   .max = limits.max,
                                   .open_min = limits.open_min,
                                   .open_max = limits.open_max}};
  if constexpr (!Plain<Member>::kIsOptional) {
    made.written = [access, factor = unit.factor](const Desc& desc) { return written(access(desc), factor); };
  }
  made.read = [access, name, factor = unit.factor](Desc& desc, const AttributeValues& attributes) {
    if (attributes.is_set(name)) access(desc) = number<Value>(attributes, name, factor);
  };
  if constexpr (std::floating_point<Value>) {
    made.set = [access, factor = unit.factor](Desc& desc, double value) {
      access(desc) = converted<Value>(value, factor);
    };
  }
  return made;
}

}  // namespace rows_detail

/// A number, a whole number or three numbers.
template <typename Desc, typename Member>
AttributeRow<Desc> row(Member Desc::*member, std::string_view name, const AttributeUnit& unit,
                       const AttributeLimits& limits, std::string_view text) {
  const auto access = [member](auto& desc) -> auto& { return desc.*member; };
  return rows_detail::number_row<Desc>(access, name, unit, limits, text);
}

/// Three live rows for the components of a colour: `prefix` stands in front of "red", "green" and "blue". A text that
/// begins with " of" has the component in front.
template <typename Desc>
AttributeRows<Desc> color_rows(glm::vec3 Desc::*member, const std::string& prefix, const AttributeLimits& limits,
                               const std::string& text) {
  const auto component = [&](glm::length_t i, const std::string& color) {
    const auto access = [ member, i ](auto& desc) -> auto& { return (desc.*member)[i]; };
    return rows_detail::number_row<Desc>(access, keep_text(prefix + color), "", limits,
                                         keep_text(text.starts_with(" of") ? color + text : text))
        .live();
  };
  return {component(0, "red"), component(1, "green"), component(2, "blue")};
}

/// One of several words, each of which stands for a value of the member.
template <typename Desc, typename Member>
AttributeRow<Desc> row(Member Desc::*member, std::string_view name,
                       const AttributeWords<std::type_identity_t<Member>>& words, std::string_view text) {
  SIMVIS_ASSERT(!words.empty());  // empty: a static variable that is initialized after the table
  std::string choices;
  for (const auto& [value, word] : words) choices += (choices.empty() ? "" : " ") + std::string(word);
  return {.spec = {.name = name, .kind = AttributeKind::choice, .text = text, .choices = keep_text(std::move(choices))},
          .written = [member, words](const Desc& desc) { return std::string(word_of(words, desc.*member)); },
          .read =
              [member, name, words](Desc& desc, const AttributeValues& attributes) {
                if (!attributes.is_set(name)) return;
                for (const auto& [value, word] : words) {
                  if (word == attributes.choice(name)) desc.*member = value;
                }
              }};
}

/// Several words that may stand together, each with a member that is true if the word is given. `further` are words
/// without a member, separated by spaces, which a step after the row reads.
template <typename Desc>
AttributeRow<Desc> flags_row(std::string_view name, const std::vector<std::pair<std::string_view, bool Desc::*>>& flags,
                             std::string_view text, std::string_view further = {}) {
  std::string choices;
  for (const auto& [word, member] : flags) choices += (choices.empty() ? "" : " ") + std::string(word);
  if (!further.empty()) choices += " " + std::string(further);
  return {.spec = {.name = name, .kind = AttributeKind::flags, .text = text, .choices = keep_text(std::move(choices))},
          .written =
              [flags](const Desc& desc) {
                std::string set;
                for (const auto& [word, member] : flags) {
                  if (desc.*member) set += (set.empty() ? "" : " ") + std::string(word);
                }
                return set;
              },
          .read =
              [name, flags](Desc& desc, const AttributeValues& attributes) {
                if (!attributes.is_set(name)) return;
                for (const auto& [word, member] : flags) desc.*member = attributes.flag(name, word);
              }};
}

/// A text, the name of a file, of a part, of an object, of an element or of a sensor, or patterns of objects. Only a
/// text and patterns have a default, unless it is empty.
template <typename Desc>
AttributeRow<Desc> row(std::string Desc::*member, AttributeKind kind, std::string_view name, std::string_view text) {
  AttributeRow<Desc> made{.spec = {.name = name, .kind = kind, .text = text}};
  if (kind == AttributeKind::text || kind == AttributeKind::objects)
    made.written = [member](const Desc& desc) { return desc.*member; };
  made.read = [member, name](Desc& desc, const AttributeValues& attributes) {
    if (attributes.is_set(name)) desc.*member = attributes.text(name);
  };
  return made;
}

}  // namespace simvis
