// The description of a message type: its .msg text and its type hash follow from the fields of its struct.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/program_api.h"
#include "exchange/messages/cdr.h"
#include "exchange/messages/field.h"

namespace simvis::ros {

struct TypeDescription;

/// The type of a field without its shape.
struct BaseType {
  std::string_view name;  ///< as in .msg files: "float32"; for a message its full name
  int id = 1;             ///< in type_description_interfaces/FieldType
  const TypeDescription* nested = nullptr;
};

enum class Shape : std::uint8_t { single, array, sequence };

struct FieldDescription {
  std::string_view name;
  BaseType type;
  Shape shape = Shape::single;
  std::size_t count = 0;  ///< of an array
};

struct TypeDescription {
  std::string_view name;       ///< "std_msgs/msg/Header"
  std::string_view constants;  ///< lines of its .msg file
  std::vector<FieldDescription> fields;
};

template <Message M>
const TypeDescription& describe();

template <typename T>
BaseType base_type() {
  if constexpr (Message<T>) return {T::kName, 1, &describe<T>()};
  if constexpr (std::same_as<T, std::int8_t>) return {"int8", 2};
  if constexpr (std::same_as<T, std::uint8_t>) return {"uint8", 3};
  if constexpr (std::same_as<T, std::int16_t>) return {"int16", 4};
  if constexpr (std::same_as<T, std::uint16_t>) return {"uint16", 5};
  if constexpr (std::same_as<T, std::int32_t>) return {"int32", 6};
  if constexpr (std::same_as<T, std::uint32_t>) return {"uint32", 7};
  if constexpr (std::same_as<T, std::int64_t>) return {"int64", 8};
  if constexpr (std::same_as<T, std::uint64_t>) return {"uint64", 9};
  if constexpr (std::same_as<T, float>) return {"float32", 10};
  if constexpr (std::same_as<T, double>) return {"float64", 11};
  if constexpr (std::same_as<T, bool>) return {"bool", 15};
  if constexpr (std::same_as<T, std::byte>) return {"byte", 16};
  if constexpr (std::same_as<T, std::string>) return {"string", 17};
}

template <typename T>
struct DescribedField {
  static FieldDescription of(std::string_view name) { return {name, base_type<T>()}; }
};
template <typename T, std::size_t kCount>
struct DescribedField<std::array<T, kCount>> {
  static FieldDescription of(std::string_view name) { return {name, base_type<T>(), Shape::array, kCount}; }
};
template <typename T>
struct DescribedField<std::vector<T>> {
  static FieldDescription of(std::string_view name) { return {name, base_type<T>(), Shape::sequence}; }
};

/// The reference is valid for the rest of the program.
template <Message M>
const TypeDescription& describe() {
  static const TypeDescription description = [] {
    TypeDescription made{M::kName, "", {}};
    if constexpr (requires { M::kConstants; }) made.constants = M::kConstants;
    std::string_view names = M::kFieldNames;
    M sample;
    for_each_field(sample,
                   [&]<typename T>(T&) { made.fields.push_back(DescribedField<T>::of(take_field_name(names))); });
    return made;
  }();
  return description;
}

/// The text of the type's .msg file followed by those of the types that it uses, as MCAP's schemas of encoding
/// "ros2msg" have it, without comments.
SIMVIS_PROGRAM_API std::string msg_text(const TypeDescription& type);

/// The type hash of REP 2016: "RIHS01_" and the SHA-256 of the description as JSON.
std::string type_hash(const TypeDescription& type);

}  // namespace simvis::ros
