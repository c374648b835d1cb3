#include "python/core/written_type.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <utility>

#include "python/core/errors.h"

namespace nb = nanobind;

namespace simvis::python {
namespace {

thread_local bool scene_may_change = false;

nb::object value_of(const AttributeValues& values, const AttributeSpec& row) {
  if (!values.is_set(row.name)) return nb::none();
  switch (row.kind) {
    case AttributeKind::number:
      return nb::float_(values.number(row.name));
    case AttributeKind::integer:
      return nb::int_(values.integer(row.name));
    case AttributeKind::choice:
      return nb::cast(values.choice(row.name));
    case AttributeKind::vector: {
      const double(&v)[3] = values.vector(row.name);
      return nb::make_tuple(v[0], v[1], v[2]);
    }
    default:
      return nb::cast(values.text(row.name));
  }
}

constexpr std::pair<std::string_view, AttributeKind> kKinds[] = {
    {"number", AttributeKind::number},   {"integer", AttributeKind::integer}, {"choice", AttributeKind::choice},
    {"vector", AttributeKind::vector},   {"text", AttributeKind::text},       {"file", AttributeKind::file},
    {"part", AttributeKind::part},       {"object", AttributeKind::object},   {"objects", AttributeKind::objects},
    {"element", AttributeKind::element}, {"sensor", AttributeKind::sensor}};

std::string string_in(nb::handle row, const char* name) { return nb::cast<std::string>(row.attr(name)); }

void add_row(WrittenType& type, nb::handle row) {
  AttributeSpec spec{.name = store(type, string_in(row, "name"))};
  const std::string kind = string_in(row, "kind");
  const auto found = std::ranges::find(kKinds, std::string_view(kind), [](const auto& each) { return each.first; });
  if (found == std::end(kKinds))
    throw InputError("attribute " + in_quotes(spec.name) + ": unknown kind " + in_quotes(kind));
  spec.kind = found->second;
  spec.default_value = store(type, string_in(row, "default_text"));
  spec.unit = store(type, string_in(row, "unit"));
  spec.text = store(type, string_in(row, "text"));
  spec.choices = store(type, string_in(row, "choices"));
  spec.min = nb::cast<double>(row.attr("min"));
  spec.max = nb::cast<double>(row.attr("max"));
  spec.live = nb::cast<bool>(row.attr("live"));
  if (spec.live) type.live.push_back(spec.name);
  type.rows.push_back(spec);
}

bool same_rows(const std::vector<AttributeSpec>& a, const std::vector<AttributeSpec>& b) {
  return std::ranges::equal(a, b, [](const AttributeSpec& x, const AttributeSpec& y) {
    return x.name == y.name && x.kind == y.kind && x.default_value == y.default_value && x.unit == y.unit &&
           x.text == y.text && x.min == y.min && x.max == y.max && x.choices == y.choices && x.live == y.live;
  });
}

/// Throws InputError unless both have the same table: the registry keeps that.
void require_same_table(const WrittenType& known, const WrittenType& type) {
  if (same_rows(known.rows, type.rows) && known.values == type.values && known.summary == type.summary) return;
  throw InputError("type " + in_quotes(type.name) +
                   " is registered with another table of attributes, expected the same, another name or a new process");
}

}  // namespace

SceneChange::SceneChange() : before_(std::exchange(scene_may_change, true)) {}

SceneChange::~SceneChange() { scene_may_change = before_; }

void require_scene_change() {
  if (!scene_may_change) throw InputError("the scene can be changed in an element's __init__() and update() only");
}

nb::dict values_of(const AttributeValues& values, const std::vector<AttributeSpec>& rows) {
  nb::dict all;
  for (const AttributeSpec& row : rows) all[nb::str(row.name.data(), row.name.size())] = value_of(values, row);
  return all;
}

nb::object make_object(const WrittenType& type, CreationContext& creation, const Command& command) {
  const nb::object given = nb::cast(&creation, nb::rv_policy::copy);
  CreationContext& copy = nb::cast<CreationContext&>(given);
  struct End {
    CreationContext& creation;
    ~End() { creation.element = nullptr; }
  } const end{copy};
  const SceneChange change;
  try {
    return type.python_class(given);
  } catch (nb::python_error& error) {
    const std::string reason = nb::cast<std::string>(nb::str(nb::handle(error.value())));
    const std::string kind = nb::cast<std::string>(nb::handle(error.type()).attr("__name__"));
    keep_cause(std::move(error));
    fail_at(command.where, type.name + ": its Python class raised " + kind + ": " + reason);
  }
}

std::string_view store(WrittenType& type, std::string text) { return type.texts.emplace_back(std::move(text)); }

std::unique_ptr<WrittenType> describe_type(const nb::object& python_class, const std::string& name,
                                           const std::string& summary, nb::handle rows) {
  auto type = std::make_unique<WrittenType>();
  type->python_class = python_class;
  type->name = name;
  type->summary = summary;
  for (const nb::handle row : rows) add_row(*type, row);
  if (const std::string wrong = check_table(type->rows); !wrong.empty()) {
    throw InputError("type " + in_quotes(name) + ": " + wrong);
  }
  return type;
}

WrittenType* keep_type(WrittenTypes& known, std::unique_ptr<WrittenType> type, bool taken) {
  if (const auto before = known.find(type->name); before != known.end()) {
    require_same_table(*before->second, *type);
    before->second->python_class = type->python_class;
    return nullptr;
  }
  if (taken) throw InputError("type " + in_quotes(type->name) + " exists already, expected another name");
  WrittenType* const kept = type.release();
  known[kept->name] = kept;
  return kept;
}

}  // namespace simvis::python
