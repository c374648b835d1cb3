#include "import/programs/ply_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include "import/programs/ply_strips.h"

namespace simvis {
namespace {

struct Type {
  std::string_view name, alias;
  std::size_t bytes;
  bool is_signed, is_float;
};
constexpr Type kTypes[] = {{"char", "int8", 1, true, false},    {"uchar", "uint8", 1, false, false},
                           {"short", "int16", 2, true, false},  {"ushort", "uint16", 2, false, false},
                           {"int", "int32", 4, true, false},    {"uint", "uint32", 4, false, false},
                           {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};

struct Property {
  std::string_view name;
  const Type* type = nullptr;
  const Type* count = nullptr;  // type of a list's length; null: not a list
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

constexpr std::string_view kStrips = "tristrips";

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t i = 0;
  while ((i = line.find_first_not_of(" \t\r", i)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
    words.push_back(line.substr(i, end - i));
    i = end;
  }
  return words;
}

// The numbers of these properties are used; those of all others may be anything.
constexpr std::string_view kUsed[] = {"x",
                                      "y",
                                      "z",
                                      "nx",
                                      "ny",
                                      "nz",
                                      "s",
                                      "t",
                                      "u",
                                      "v",
                                      "texture_u",
                                      "texture_v",
                                      "red",
                                      "green",
                                      "blue",
                                      "diffuse_red",
                                      "diffuse_green",
                                      "diffuse_blue",
                                      "alpha"};

bool is_no_number(std::string_view word) {
  return word == "nan" || word == "-nan" || word == "inf" || word == "-inf" || word == "NaN" || word == "NAN";
}

bool is_index_list(const Property& property) {
  return property.name == "vertex_indices" || property.name == "vertex_index";
}

class PlyCheck {
 public:
  PlyCheck(std::string_view bytes, AssimpFile& file) : bytes_(bytes), read_(file), file_(file.file.string()) {}

  std::optional<std::string> run() {
    read_header();
    check_elements();
    const std::size_t body = at_;
    std::size_t strips = body, behind_strips = body;  // bytes of the strips
    for (const Element& element : elements_) {
      if (element.name == kStrips) strips = at_;
      for (std::uint64_t i = 0; i < element.count; ++i) check_instance(element, i);
      if (element.name == kStrips) behind_strips = at_;
    }
    while (encoding_ == PlyEncoding::text && at_ < bytes_.size()) {
      if (words_of(next_line()).empty()) continue;
      warn("text after the last element is left out");
      break;
    }
    const bool is_cut =
        encoding_ != PlyEncoding::text && body < bytes_.size() && bytes_[body] == '\n' && !ends_with_cr_;
    if (!is_odd_ && !is_cut) return std::nullopt;
    const std::string end = is_cut ? "end_header\r\n" : "end_header\n";
    if (!has_strips_) return "ply\n" + format_ + lines_ + end + std::string(bytes_.substr(body));
    lines_.insert(strips_line_, strips_.header());
    return "ply\n" + format_ + lines_ + end + std::string(bytes_.substr(body, strips - body)) +
           strips_.body(encoding_) + std::string(bytes_.substr(behind_strips));
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_at({.file = file_, .line = line_}, message); }

  std::string_view next_line() {
    if (at_ >= bytes_.size()) fail("the file ends too early");
    const std::size_t end = bytes_.find('\n', at_);
    const std::string_view line = bytes_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = end == std::string_view::npos ? bytes_.size() : end + 1;
    ++line_;
    return line;
  }

  const Type* type_of(std::string_view name) const {
    for (const Type& type : kTypes) {
      if (name == type.name || name == type.alias) return &type;
    }
    fail("unknown type " + in_quotes(name) + ", expected one of char, uchar, short, ushort, int, uint, float, double");
  }

  void read_header() {
    if (words_of(next_line()) != std::vector<std::string_view>{"ply"}) fail("expected a file that begins with \"ply\"");
    bool has_format = false;
    while (true) {
      const std::string_view line = next_line();
      const std::vector<std::string_view> words = words_of(line);
      ends_with_cr_ = line.ends_with('\r');
      if (words.empty()) {
        leave_out("an empty line in the header");
        continue;
      }
      is_odd_ = is_odd_ || (!has_format && words[0] != "format");
      const std::string kept = std::string(line.substr(0, line.size() - (ends_with_cr_ ? 1 : 0))) + "\n";
      // Assimp reads the name of a texture from a comment.
      if (words[0] == "comment" || words[0] == "obj_info") {
        lines_ += kept;
        continue;
      }
      if (words[0] == "end_header" && words.size() == 1) break;
      (words[0] == "format" ? format_ : lines_) += kept;
      if (words[0] == "format" && words.size() == 3 && words[2] == "1.0" && !has_format) {
        has_format = true;
        read_format(words[1]);
      } else if (words[0] == "element" && words.size() == 3) {
        add_element(words);
        if (words[1] == kStrips) leave_to_strips(kept);
      } else if (words[0] == "property" && !elements_.empty() && (words.size() == 3 || words.size() == 5)) {
        add_property(words);
        if (elements_.back().name == kStrips) leave_to_strips(kept);
      } else if (is_keyword(words[0])) {
        fail("the header has a line that is not understood, beginning with " + in_quotes(words[0]));
      } else {
        lines_.resize(lines_.size() - kept.size());
        leave_out("a line of the header is not understood, beginning with " + in_quotes(words[0]));
      }
    }
    if (!has_format) fail("the header names no format, expected \"format ascii|binary_..._endian 1.0\"");
  }

  static bool is_keyword(std::string_view word) {
    return word == "format" || word == "element" || word == "property" || word == "end_header";
  }

  void warn(const std::string& what) { read_.warn_at({.file = file_, .line = line_}, what); }

  void leave_out(const std::string& what) {
    is_odd_ = true;
    warn(what + "; it is left out");
  }

  // The declaration of faces takes the place of that of the strips.
  void leave_to_strips(const std::string& kept) {
    is_odd_ = has_strips_ = true;
    lines_.resize(lines_.size() - kept.size());
    strips_line_ = lines_.size();
  }

  void read_format(std::string_view name) {
    if (name == "ascii") {
      encoding_ = PlyEncoding::text;
    } else if (name == "binary_little_endian") {
      encoding_ = PlyEncoding::little_endian;
    } else if (name == "binary_big_endian") {
      encoding_ = PlyEncoding::big_endian;
    } else {
      fail("unknown format " + in_quotes(name) + ", expected ascii, binary_little_endian or binary_big_endian");
    }
  }

  void add_element(const std::vector<std::string_view>& words) {
    double count = 0;
    // Every element has at least one byte of the file, so a larger count is an error and never costs time.
    if (!parse_number(words[2], count) || count != std::floor(count) || count < 0 ||
        count > static_cast<double>(bytes_.size())) {
      fail("element " + in_quotes(words[1]) + " has the count " + in_quotes(words[2]) + ", expected a whole number " +
           "that the file can hold");
    }
    // Assimp takes digits at the beginning of a name for the count.
    if (words[1][0] >= '0' && words[1][0] <= '9') {
      fail("element " + in_quotes(words[1]) + " has a name that begins with a digit");
    }
    if (std::ranges::count(elements_, words[1], &Element::name) != 0) {
      fail("element " + in_quotes(words[1]) + " is declared twice");
    }
    if (words[1] == "material") fail("element \"material\" is not supported, expected faces without materials");
    elements_.push_back({words[1], static_cast<std::uint64_t>(count), {}});
  }

  void add_property(const std::vector<std::string_view>& words) {
    Element& element = elements_.back();
    Property property{words.back(), type_of(words[words.size() - 2])};
    if (words.size() == 5) {
      if (words[1] != "list") fail("a property with too many words");
      property.count = type_of(words[2]);
      if (property.count->is_float) fail("the length of a list has a floating-point type, expected an integer type");
    }
    if (std::ranges::count(element.properties, words.back(), &Property::name) != 0) {
      fail("property " + in_quotes(words.back()) + " is declared twice");
    }
    element.properties.push_back(property);
  }

  void check_elements() {
    if (elements_.empty() || elements_[0].name != "vertex") fail("expected the element vertex before all others");
    const Element& vertex = elements_[0];
    if (vertex.count == 0) read_.fail("holds nothing to draw");
    for (const std::string_view axis : {"x", "y", "z"}) {
      const auto found = std::ranges::find(vertex.properties, axis, &Property::name);
      if (found == vertex.properties.end() || !found->type->is_float || found->count != nullptr) {
        fail("element vertex has no property " + std::string(axis) + " of type float or double");
      }
    }
    // Assimp reads the first value of a property that it uses, and a list may have none.
    for (const Property& property : vertex.properties) {
      const bool is_used = std::ranges::count(kUsed, property.name) > 0;
      if (property.count != nullptr && is_used) fail("element vertex has the list " + in_quotes(property.name));
    }
    for (const Element& element : elements_) {
      if (element.properties.empty()) fail("element " + in_quotes(element.name) + " has no properties");
      if (element.name == "face" || element.name == kStrips) check_face(element);
      if (element.name == "face" && has_strips_) fail("the file has faces and tristrips, expected one of them");
      if (element.name == kStrips && element.properties.size() > 1) fail("element tristrips has other properties");
    }
  }

  void check_face(const Element& face) {
    if (std::ranges::count_if(face.properties, is_index_list) != 1) {
      fail("element " + std::string(face.name) + " has no list vertex_indices, or two of them");
    }
    for (const Property& property : face.properties) {
      const bool wants_list = is_index_list(property);
      if (wants_list && (property.count == nullptr || property.type->is_float)) {
        fail("property " + in_quotes(property.name) + " is not a list of whole numbers");
      }
    }
  }

  void check_instance(const Element& element, std::uint64_t index) {
    std::vector<std::string_view> words;
    std::size_t used = 0;
    if (encoding_ == PlyEncoding::text) words = words_of(next_line());
    const auto subject = [&] { return "element " + std::string(element.name) + " " + std::to_string(index); };
    const auto next = [&](const Type& type, bool may_be_nothing = false) {
      if (encoding_ != PlyEncoding::text) return binary_value(type);
      double value = 0;
      if (used >= words.size()) fail(subject() + " has too few values");
      if (may_be_nothing && is_no_number(words[used])) {
        ++used;
        return 0.0;
      }
      if (!parse_number(words[used++], value)) fail(subject() + " has a value that is not a finite number");
      if (!type.is_float && value != std::floor(value)) fail(subject() + " has a value that is not a whole number");
      return value;
    };
    std::uint64_t corners = 0, coordinates = 0;
    for (const Property& property : element.properties) {
      const double values = property.count == nullptr ? 1 : next(*property.count);
      if (values < 0) fail(subject() + " has a list of negative length");
      const bool may_be_nothing = property.type->is_float && std::ranges::count(kUsed, property.name) == 0;
      for (double k = 0; k < values; ++k) {
        const double value = next(*property.type, may_be_nothing);
        if (!is_index_list(property) || (element.name != "face" && element.name != kStrips)) continue;
        const bool ends_strip = element.name == kStrips && value == -1;
        if ((value < 0 || value >= static_cast<double>(elements_[0].count)) && !ends_strip) {
          fail(subject() + " has the vertex " + format_number(value) + ", but there are " +
               std::to_string(elements_[0].count));
        }
        if (element.name == kStrips) strips_.add(static_cast<std::int64_t>(value));
      }
      if (element.name == kStrips) strips_.end_strip();
      if (is_index_list(property)) corners = static_cast<std::uint64_t>(values);
      if (property.name == "texcoord" && property.count != nullptr) coordinates = static_cast<std::uint64_t>(values);
    }
    if (used < words.size() && !has_more_) {
      has_more_ = true;
      warn(subject() + " has more values than the header says; they are left out, here and in others");
    }
    if (element.name != "face") return;
    if (corners < 3) fail(subject() + " has " + std::to_string(corners) + " vertices, expected at least 3");
    if (coordinates != 0 && coordinates != 2 * corners) fail(subject() + " has texture coordinates that do not fit");
  }

  double binary_value(const Type& type) {
    if (bytes_.size() - at_ < type.bytes) {
      fail_at({.file = file_}, "the file ends too early: its header claims more");
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t place = encoding_ == PlyEncoding::little_endian ? i : type.bytes - 1 - i;
      bits |= std::uint64_t{static_cast<unsigned char>(bytes_[at_ + i])} << (8 * place);
    }
    at_ += type.bytes;
    if (type.is_float) return 0;  // convert_mesh() checks the numbers
    const unsigned unused = 64 - 8 * static_cast<unsigned>(type.bytes);
    return type.is_signed ? static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused)
                          : static_cast<double>(bits);
  }

  std::string_view bytes_;
  AssimpFile& read_;
  std::string file_, format_, lines_;  // the header's lines that Assimp reads
  bool is_odd_ = false, ends_with_cr_ = false, has_more_ = false, has_strips_ = false;
  PlyStrips strips_;
  std::size_t strips_line_ = 0;  // where the strips are declared, in lines_
  std::size_t at_ = 0;
  int line_ = 0;
  PlyEncoding encoding_ = PlyEncoding::text;
  std::vector<Element> elements_;
};

}  // namespace

std::optional<std::string> check_ply(AssimpFile& file) {
  return PlyCheck({reinterpret_cast<const char*>(file.bytes->data()), file.bytes->size()}, file).run();
}

}  // namespace simvis
