#include "import/programs/inventor/vrml_text.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include <simvis/location.h>
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"

namespace simvis {
namespace {

constexpr std::string_view kVrml97 = "#VRML V2.0 utf8", kVrml1 = "#VRML V1.0 ascii", kVrmlSpaces = " \t\r\n,";
constexpr int kMaxVrmlDepth = 1000;

struct NotUnderstood {};

struct VrmlToken {
  enum class Kind { end, word, literal, mark } kind = Kind::end;
  std::string_view text;
  std::size_t begin = 0;
  std::size_t end() const { return begin + text.size(); }
  bool is(std::string_view other) const { return text == other && kind != Kind::literal; }
};

// Numbers and quoted texts are literals, brackets marks.
class VrmlTokens {
 public:
  explicit VrmlTokens(std::string_view text) : text_(text) { read(); }
  const VrmlToken& now() const { return now_; }
  VrmlToken take() {
    VrmlToken taken = now_;
    read();
    return taken;
  }

 private:
  void read() {
    std::size_t at = now_.end();
    while (at < text_.size()) {
      at = std::min(text_.find_first_not_of(kVrmlSpaces, at), text_.size());
      if (at == text_.size() || text_[at] != '#') break;
      at = std::min(text_.find_first_of("\r\n", at), text_.size());
    }
    now_ = {.kind = VrmlToken::Kind::end, .text = text_.substr(at, 0), .begin = at};
    if (at == text_.size()) return;
    const char first = text_[at];
    if (first == '"') {
      now_.kind = VrmlToken::Kind::literal;
      now_.text = text_.substr(at, end_of_quotes(at) - at);
    } else if (std::string_view("[]{}").find(first) != std::string_view::npos) {
      now_.kind = VrmlToken::Kind::mark;
      now_.text = text_.substr(at, 1);
    } else {
      const std::size_t end = std::min(text_.find_first_of(" \t\r\n,#\"[]{}", at), text_.size());
      now_.text = text_.substr(at, end - at);
      const bool is_number = std::string_view("0123456789+-.").find(first) != std::string_view::npos;
      now_.kind =
          is_number || now_.text == "TRUE" || now_.text == "FALSE" ? VrmlToken::Kind::literal : VrmlToken::Kind::word;
    }
  }

  std::size_t end_of_quotes(std::size_t at) const {
    for (++at; at < text_.size() && text_[at] != '"'; ++at) {
      if (text_[at] == '\\') ++at;
    }
    if (at >= text_.size()) throw NotUnderstood();
    return at + 1;
  }

  std::string_view text_;
  VrmlToken now_;
};

class VrmlReader {
 public:
  VrmlReader(std::string_view text, const std::filesystem::path& file, const std::string& shown,
             const VrmlFields& fields)
      : text_(text), file_(file), shown_(shown), fields_(fields), tokens_(text) {}

  std::optional<VrmlText> run() {
    read_statements("");
    if (edits_.empty()) return std::nullopt;
    VrmlText made;
    std::size_t at = 0;
    for (const Edit& edit : edits_) {
      made.text += text_.substr(at, edit.begin - at);
      made.text += edit.text;
      for (const char c : text_.substr(edit.begin, edit.end - edit.begin)) {
        if (c == '\n' || c == '\r') made.text += c;
      }
      made.text += edit.text.empty() ? " " : "} ";
      at = edit.end;
    }
    made.text += text_.substr(at);
    for (const auto& [what, kind] : kinds_) {
      const std::string more = kind.count > 1 ? " (and " + std::to_string(kind.count - 1) + " more)" : "";
      made.warnings.push_back(to_string(kind.first) + ": " + what + "; it is left out" + more);
    }
    return made;
  }

 private:
  using Names = std::set<std::string, std::less<>>;
  struct Edit {
    std::size_t begin = 0, end = 0;
    std::string text;  // in its place, without the last bracket
  };
  struct Kind {
    Location first;
    int count = 0;
  };

  Location at(std::size_t offset) const {
    const std::string_view before = text_.substr(0, offset);
    const std::size_t line = before.rfind('\n');
    return {.file = shown_,
            .line = static_cast<int>(std::ranges::count(before, '\n')) + 1,
            .column = static_cast<int>(offset - (line == std::string_view::npos ? 0 : line + 1)) + 1};
  }

  void warn(const std::string& what, std::size_t offset) {
    constexpr std::size_t kMaxKinds = 50;
    const bool is_one_too_many = kinds_.size() >= kMaxKinds && !kinds_.contains(what);
    Kind& kind = kinds_[is_one_too_many ? "another field or node is unknown" : what];
    if (kind.count++ == 0) kind.first = at(offset);
  }

  // What was to be changed within is gone with it.
  void leave_out(std::size_t begin, std::size_t end, const std::string& text) {
    while (!edits_.empty() && edits_.back().begin >= begin) edits_.pop_back();
    edits_.push_back({begin, end, text});
  }

  VrmlToken expect(std::string_view mark) {
    if (!tokens_.now().is(mark)) throw NotUnderstood();
    return tokens_.take();
  }

  VrmlToken take_word() {
    if (tokens_.now().kind != VrmlToken::Kind::word) throw NotUnderstood();
    return tokens_.take();
  }

  // From an open bracket to the one that closes it. Returns the end.
  std::size_t skip_brackets() {
    std::string open;
    while (true) {
      const VrmlToken token = tokens_.take();
      if (token.kind == VrmlToken::Kind::end) throw NotUnderstood();
      if (token.kind != VrmlToken::Kind::mark) continue;
      if (token.text == "[" || token.text == "{") {
        open.push_back(token.text == "[" ? ']' : '}');
        continue;
      }
      if (open.empty() || open.back() != token.text.front()) throw NotUnderstood();
      open.pop_back();
      if (open.empty()) return token.end();
    }
  }

  void read_statements(std::string_view end) {
    while (end.empty() ? tokens_.now().kind != VrmlToken::Kind::end : !tokens_.now().is(end)) read_statement();
  }

  void read_statement() {
    const VrmlToken& now = tokens_.now();
    if (now.is("PROTO")) return read_proto();
    if (now.is("EXTERNPROTO")) return read_extern_proto();
    if (now.is("ROUTE")) return read_route();
    read_node();
  }

  // PROTO NAME [ interface ] { body }
  void read_proto() {
    tokens_.take();
    const std::string name(take_word().text);
    Names interface = read_interface(true);
    expect("{");
    protos_[name] = std::move(interface);
    open_protos_.push_back(name);
    const std::vector<std::string> defined = std::exchange(open_nodes_, {});
    read_statements("}");
    open_nodes_ = defined;
    open_protos_.pop_back();
    expect("}");
  }

  // EXTERNPROTO NAME [ interface ] "file" or [ "file" ... ]
  void read_extern_proto() {
    const VrmlToken start = tokens_.take();
    const std::string name(take_word().text);
    Names interface = read_interface(false);
    bool is_there = false;
    std::string first;
    std::size_t end = tokens_.now().end();
    const bool is_list = tokens_.now().is("[");
    if (is_list) tokens_.take();
    while (tokens_.now().kind == VrmlToken::Kind::literal) {
      const VrmlToken url = tokens_.take();
      end = url.end();
      if (url.text.size() < 2) throw NotUnderstood();
      const std::string_view written = url.text.substr(1, url.text.size() - 2);
      if (first.empty()) first = written;
      is_there = is_there || has_file(written);
    }
    if (is_list) end = expect("]").end();
    if (is_there) {
      protos_[name] = std::move(interface);
      return;
    }
    absent_.insert(name);
    warn("EXTERNPROTO " + in_quotes(name) + " names the file " + in_quotes(first) +
             ", which is not there, and has no nodes",
         start.begin);
    leave_out(start.begin, end, "");
  }

  bool has_file(std::string_view url) const {
    const std::filesystem::path named(url.substr(0, url.find('#')));
    const std::filesystem::path file = file_.parent_path() / named;
    return !named.empty() && is_readable(file) && is_input_file(file);
  }

  // The names of fields and events, with the defaults of fields if `has_values`.
  Names read_interface(bool has_values) {
    Names names;
    expect("[");
    while (!tokens_.now().is("]")) {
      const std::string access(take_word().text);
      take_word();  // the type
      names.emplace(take_word().text);
      const bool has_value = access == "field" || access == "exposedField";
      if (has_values && has_value) read_value();
    }
    expect("]");
    return names;
  }

  // ROUTE NODE.EVENT TO NODE.EVENT
  void read_route() {
    const VrmlToken start = tokens_.take();
    const VrmlToken from = take_word();
    if (!tokens_.take().is("TO")) throw NotUnderstood();
    const VrmlToken to = take_word();
    const auto is_gone = [&](std::string_view end) { return gone_.contains(end.substr(0, end.find('.'))); };
    if (is_gone(from.text) || is_gone(to.text)) leave_out(start.begin, to.end(), "");
  }

  // [DEF NAME] TYPE { fields }, USE NAME or NULL
  void read_node() {
    if (tokens_.now().is("NULL")) {
      tokens_.take();
      return;
    }
    if (tokens_.now().is("USE")) {
      const VrmlToken use = tokens_.take();
      const std::string name(take_word().text);
      if (std::ranges::count(open_nodes_, name) > 0) {
        fail_at(at(use.begin), "node " + in_quotes(name) + " is used within itself: a circle of DEF and USE");
      }
      return;
    }
    std::string name;
    if (tokens_.now().is("DEF")) {
      tokens_.take();
      name = take_word().text;
    }
    const VrmlToken type = take_word();
    if (!tokens_.now().is("{")) throw NotUnderstood();
    if (std::ranges::count(open_protos_, type.text) > 0) {
      fail_at(at(type.begin), "PROTO " + in_quotes(type.text) + " uses itself: a circle of prototypes");
    }
    if (++depth_ > kMaxVrmlDepth) throw NotUnderstood();
    open_nodes_.push_back(name);
    read_body(type, name);
    open_nodes_.pop_back();
    --depth_;
  }

  void read_body(const VrmlToken& type, const std::string& name) {
    const std::optional<Names> fields = fields_of(std::string(type.text));
    if (!fields) {
      if (!absent_.contains(type.text)) warn("node " + in_quotes(type.text) + " is unknown", type.begin);
      if (!name.empty()) gone_.insert(name);
      leave_out(type.begin, skip_brackets(), "Group {");
      return;
    }
    if (type.text == "Script") {  // it declares its own fields
      skip_brackets();
      return;
    }
    expect("{");
    if (is_vrml1(text_)) return read_fields_and_children(type, *fields);
    while (!tokens_.now().is("}")) {
      const VrmlToken& now = tokens_.now();
      if (now.is("PROTO") || now.is("EXTERNPROTO") || now.is("ROUTE")) {
        read_statement();
        continue;
      }
      const VrmlToken field = take_word();
      if (tokens_.now().is("IS") || fields->contains(field.text)) {
        read_value();
        continue;
      }
      const std::size_t end = skip_value();
      warn("field " + in_quotes(field.text) + " of a node " + in_quotes(type.text) + " is unknown", field.begin);
      leave_out(field.begin, std::max(end, field.end()), "");
    }
    expect("}");
  }

  // The body of a node of VRML 1, whose children stand among its fields, up to its bracket.
  void read_fields_and_children(const VrmlToken& type, const Names& fields) {
    while (!tokens_.now().is("}")) {
      if (begins_node()) {
        read_node();
        continue;
      }
      const VrmlToken field = take_word();
      const std::size_t end = skip_plain_value(fields);
      if (fields.contains(field.text)) continue;
      warn("field " + in_quotes(field.text) + " of a node " + in_quotes(type.text) + " is unknown", field.begin);
      leave_out(field.begin, std::max(end, field.end()), "");
    }
    expect("}");
  }

  bool begins_node() const {
    const VrmlToken& now = tokens_.now();
    if (now.kind != VrmlToken::Kind::word) return false;
    VrmlTokens ahead = tokens_;
    ahead.take();
    return now.is("DEF") || now.is("USE") || ahead.now().is("{");
  }

  // Numbers, texts, a list or names of choices, up to the next field or node. Returns the end; 0: there is nothing.
  std::size_t skip_plain_value(const Names& fields) {
    if (tokens_.now().is("[")) return skip_brackets();
    const VrmlToken::Kind kind = tokens_.now().kind;
    if (kind != VrmlToken::Kind::literal && kind != VrmlToken::Kind::word) return 0;
    std::size_t end = 0;
    while (tokens_.now().kind == kind && !fields.contains(tokens_.now().text) && !begins_node()) {
      end = tokens_.take().end();
    }
    return end;
  }

  std::optional<Names> fields_of(const std::string& type) {
    const auto proto = protos_.find(type);
    if (proto != protos_.end()) return proto->second;
    const auto [known, is_new] = nodes_.try_emplace(type);
    if (is_new) known->second = fields_(type);
    return known->second;
  }

  // Numbers and texts, a list in brackets, a node, or IS and a name; a field without a value has none of these. Returns
  // the end of what was read; 0: there was nothing.
  std::size_t read_value() {
    const VrmlToken first = tokens_.now();
    std::size_t end = 0;
    if (first.kind == VrmlToken::Kind::literal) {
      while (tokens_.now().kind == VrmlToken::Kind::literal) end = tokens_.take().end();
      return end;
    }
    if (first.is("[")) {
      tokens_.take();
      while (!tokens_.now().is("]")) {
        if (tokens_.now().kind == VrmlToken::Kind::literal) {
          tokens_.take();
        } else {
          read_statement();
        }
      }
      return tokens_.take().end();
    }
    if (first.kind != VrmlToken::Kind::word) return 0;
    if (first.is("IS")) {
      tokens_.take();
      return take_word().end();
    }
    return read_node_value();
  }

  // The same without a look at what is within.
  std::size_t skip_value() {
    if (tokens_.now().is("[")) return skip_brackets();
    if (tokens_.now().kind != VrmlToken::Kind::word) return read_value();
    if (tokens_.now().is("USE")) {
      tokens_.take();
      return take_word().end();
    }
    if (tokens_.now().is("DEF")) {
      tokens_.take();
      gone_.emplace(take_word().text);
    }
    VrmlTokens ahead = tokens_;
    const VrmlToken first = ahead.take();
    if (first.is("NULL")) return tokens_.take().end();
    if (!ahead.now().is("{")) return 0;
    tokens_.take();
    return skip_brackets();
  }

  // A word that no bracket follows is the next field.
  std::size_t read_node_value() {
    const VrmlToken first = tokens_.now();
    VrmlTokens ahead = tokens_;
    ahead.take();
    const bool is_node = ahead.now().is("{") || first.is("DEF") || first.is("USE") || first.is("NULL");
    if (!is_node) return 0;
    read_node();
    const std::string_view read = text_.substr(0, tokens_.now().begin);
    return read.find_last_not_of(kVrmlSpaces) + 1;
  }

  static bool is_vrml1(std::string_view text) { return text.starts_with(kVrml1); }

  std::string_view text_;
  const std::filesystem::path& file_;
  const std::string& shown_;
  const VrmlFields& fields_;
  VrmlTokens tokens_;
  std::vector<Edit> edits_;  // in order, none within another
  std::map<std::string, Kind> kinds_;
  std::map<std::string, Names, std::less<>> protos_;
  std::map<std::string, std::optional<Names>> nodes_;
  Names absent_;  // EXTERNPROTOs without a file
  Names gone_;    // names of nodes that are left out
  std::vector<std::string> open_nodes_, open_protos_;
  int depth_ = 0;
};

}  // namespace

void check_vrml(std::string_view text, const std::string& shown) {
  const std::string_view start = text.substr(std::min(text.find_first_not_of(" \t\r\n\xef\xbb\xbf"), text.size()));
  if (start.starts_with("<")) {
    fail_at({.file = shown}, "is XML, such as X3D, expected VRML or Inventor; Blender converts X3D to .glb");
  }
  if (text.substr(0, text.find('\n')).find("binary") != text.npos) return;
  int depth = 0, line = 1;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '#') at = std::min(text.find('\n', at), text.size()) - 1;
    if (c == '"') {
      for (++at; at < text.size() && text[at] != '"'; ++at) {
        line += text[at] == '\n' ? 1 : 0;
        if (text[at] == '\\') ++at;
      }
    }
    line += c == '\n' ? 1 : 0;
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (depth > kMaxVrmlDepth) {
      fail_at({.file = shown, .line = line}, "nodes are nested deeper than " + std::to_string(kMaxVrmlDepth));
    }
  }
}

std::optional<VrmlText> readable_vrml(std::string_view text, const std::filesystem::path& file,
                                      const std::string& shown, const VrmlFields& fields) {
  if (!text.starts_with(kVrml97) && !text.starts_with(kVrml1)) return std::nullopt;
  try {
    return VrmlReader(text, file, shown, fields).run();
  } catch (const NotUnderstood&) {
    return std::nullopt;
  }
}

}  // namespace simvis
