#include "import/programs/meshes/ply_file.h"

#include <algorithm>
#include <cmath>

#include "engine/base/words.h"
#include "import/programs/clouds/text_points.h"

namespace simvis {
namespace {

using Words = std::vector<std::string_view>;

struct PlyType {
  std::string_view name, alias;
  NumberType type;
};
constexpr PlyType kPlyTypes[] = {
    {"char", "int8", {NumberType::Kind::whole, 1}},    {"uchar", "uint8", {NumberType::Kind::natural, 1}},
    {"short", "int16", {NumberType::Kind::whole, 2}},  {"ushort", "uint16", {NumberType::Kind::natural, 2}},
    {"int", "int32", {NumberType::Kind::whole, 4}},    {"uint", "uint32", {NumberType::Kind::natural, 4}},
    {"float", "float32", {NumberType::Kind::real, 4}}, {"double", "float64", {NumberType::Kind::real, 8}}};

class PlyHeader {
 public:
  PlyHeader(PartSource& source, std::string_view text) : source_(source) { file_.text = text; }

  PlyFile read() {
    std::string_view first = next_line();
    while (words_of(first).empty()) first = next_line();
    if (words_of(first) != Words{"ply"}) fail("expected a file that begins with \"ply\"");
    for (std::string_view line = next_line(); words_of(line) != Words{"end_header"}; line = next_line()) {
      read_line(words_of(line));
    }
    if (!has_format_) fail("the header names no format, expected \"format ascii|binary_..._endian 1.0\"");
    for (PlyElement& element : file_.elements) {
      for (PlyProperty& property : element.properties) {
        property.type.big_endian = file_.encoding == PlyEncoding::big_endian;
        if (property.length) property.length->big_endian = property.type.big_endian;
      }
    }
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    fail_at({.file = source_.file.string(), .line = file_.lines}, message);
  }

  void leave_out(const std::string& what) {
    source_.warn_at({.file = source_.file.string(), .line = file_.lines}, what + "; it is left out");
  }

  std::string_view next_line() {
    if (file_.body >= file_.text.size()) fail("the file ends too early");
    ++file_.lines;
    return line_of(file_.text, file_.body);
  }

  void read_line(const Words& words) {
    if (words.empty()) return leave_out("an empty line in the header");
    const std::string_view key = words[0];
    const bool in_element = !file_.elements.empty();
    if (key == "comment" || key == "obj_info") {
      read_comment(words);
    } else if (key == "format" && words.size() == 3 && words[2] == "1.0" && !has_format_) {
      read_format(words[1]);
    } else if (key == "element" && words.size() == 3) {
      add_element(words);
    } else if (key == "property" && in_element && (words.size() == 3 || words.size() == 5)) {
      add_property(words);
    } else if (key == "format" || key == "element" || key == "property" || key == "end_header") {
      fail("the header has a line that is not understood, beginning with " + in_quotes(key));
    } else {
      leave_out("a line of the header is not understood, beginning with " + in_quotes(key));
    }
  }

  // The name of a picture may have spaces.
  void read_comment(const Words& words) {
    if (words.size() < 3 || words[1] != "TextureFile") return;
    file_.picture = {words[2].data(), words.back().data() + words.back().size()};
  }

  void read_format(std::string_view name) {
    constexpr std::string_view kEncodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    const auto* const found = std::ranges::find(kEncodings, name);
    if (found == std::end(kEncodings)) {
      fail("unknown format " + in_quotes(name) + ", expected ascii, binary_little_endian or binary_big_endian");
    }
    file_.encoding = static_cast<PlyEncoding>(found - kEncodings);
    has_format_ = true;
  }

  void add_element(const Words& words) {
    constexpr double kMaxCount = 1e18;
    const double count = as_number<double>(words[2]).value_or(-1);
    if (!(count >= 0 && count <= kMaxCount) || count != std::floor(count)) {
      fail("element " + in_quotes(words[1]) + " has the count " + in_quotes(words[2]) + ", expected a whole number " +
           "that the file can hold");
    }
    if (std::ranges::count(file_.elements, words[1], &PlyElement::name) != 0) {
      fail("element " + in_quotes(words[1]) + " is declared twice");
    }
    if (words[1] == "material") fail("element \"material\" is not supported, expected faces without materials");
    file_.elements.push_back({words[1], static_cast<std::uint64_t>(count), file_.lines});
  }

  NumberType type_of(std::string_view name) const {
    const auto* const found =
        std::ranges::find_if(kPlyTypes, [&](const PlyType& type) { return name == type.name || name == type.alias; });
    if (found != std::end(kPlyTypes)) return found->type;
    fail("unknown type " + in_quotes(name) + ", expected one of char, uchar, short, ushort, int, uint, float, double");
  }

  void add_property(const Words& words) {
    PlyElement& element = file_.elements.back();
    PlyProperty property{words.back(), type_of(words[words.size() - 2])};
    if (words.size() == 5) {
      if (words[1] != "list") fail("a property with too many words");
      property.length = type_of(words[2]);
      if (property.length->kind == NumberType::Kind::real) {
        fail("the length of a list has a floating-point type, expected an integer type");
      }
    }
    if (element.find(property.name) != nullptr) fail("property " + in_quotes(property.name) + " is declared twice");
    element.properties.push_back(property);
  }

  PartSource& source_;
  PlyFile file_;
  bool has_format_ = false;
};

bool is_no_number(std::string_view word) {
  return word == "nan" || word == "-nan" || word == "inf" || word == "-inf" || word == "NaN" || word == "NAN";
}

}  // namespace

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto found = std::ranges::find(properties, property, &PlyProperty::name);
  return found != properties.end() ? &*found : nullptr;
}

PlyFile read_ply_header(PartSource& source, std::span<const std::uint8_t> bytes) {
  return PlyHeader(source, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}).read();
}

PlyBody::PlyBody(PartSource& source, const PlyFile& file)
    : source_(source), file_(file), at_(file.body), line_(file.lines) {}

const std::vector<std::vector<double>>& PlyBody::next(const PlyElement& element, std::uint64_t index) {
  element_ = element.name;
  index_ = index;
  if (file_.encoding == PlyEncoding::text) {
    do words_ = words_of(next_line());
    while (words_.empty() && at_ < file_.text.size());  // lines of white space
    used_ = 0;
  }
  values_.resize(element.properties.size());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    const bool may_be_no_number = property.type.kind == NumberType::Kind::real && !property.is_used;
    values_[i].clear();
    for (std::uint64_t left = length_of(property); left > 0; --left) {
      values_[i].push_back(value(property.type, may_be_no_number));
    }
  }
  if (file_.encoding == PlyEncoding::text && used_ < words_.size() && !has_more_) {
    has_more_ = true;
    source_.warn_at({.file = source_.file.string(), .line = line_},
                    "element " + std::string(element_) + " " + std::to_string(index_) +
                        " has more values than the header says; they are left out, here and in others");
  }
  return values_;
}

void PlyBody::fail(const std::string& message) const {
  fail_at({.file = source_.file.string(), .line = line_},
          "element " + std::string(element_) + " " + std::to_string(index_) + " " + message);
}

void PlyBody::finish() {
  while (file_.encoding == PlyEncoding::text && at_ < file_.text.size()) {
    if (words_of(next_line()).empty()) continue;
    source_.warn_at({.file = source_.file.string(), .line = line_}, "text after the last element is left out");
    break;
  }
}

std::string_view PlyBody::next_line() {
  if (at_ >= file_.text.size()) {
    fail_at({.file = source_.file.string(), .line = line_}, "the file ends too early");
  }
  ++line_;
  return line_of(file_.text, at_);
}

std::uint64_t PlyBody::length_of(const PlyProperty& property) {
  if (!property.length) return 1;
  const double length = value(*property.length, false);
  if (length < 0) fail("has a list of negative length");
  constexpr double kMaxLength = 1e18;  // the file ends long before
  return static_cast<std::uint64_t>(std::min(length, kMaxLength));
}

double PlyBody::value(const NumberType& type, bool may_be_no_number) {
  if (file_.encoding == PlyEncoding::text) return text_value(type, may_be_no_number);
  if (file_.text.size() - at_ < type.bytes) source_.fail("the file ends too early: its header claims more");
  const auto* const first = reinterpret_cast<const std::uint8_t*>(file_.text.data()) + at_;
  at_ += type.bytes;
  return PointColumn{first, 0, type}.at(0);
}

double PlyBody::text_value(const NumberType& type, bool may_be_no_number) {
  if (used_ >= words_.size()) fail("has too few values");
  const std::string_view word = words_[used_++];
  if (may_be_no_number && is_no_number(word)) return 0;
  const std::optional<double> value = as_number<double>(word);
  if (!value || !std::isfinite(*value)) fail("has a value that is not a finite number");
  if (type.kind != NumberType::Kind::real && *value != std::floor(*value)) {
    fail("has a value that is not a whole number");
  }
  return *value;
}

}  // namespace simvis
