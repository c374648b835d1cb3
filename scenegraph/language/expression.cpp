#include "scenegraph/language/expression.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include <simvis/pose.h>

namespace simvis {
namespace {

constexpr std::string_view kBegin = "${";
constexpr int kMaxNestedTerms = 64;  // nested parentheses and signs; the parser recurses
constexpr double kDegrees = 180 / glm::pi<double>();

struct Function {
  std::string_view name;
  std::size_t arguments;
  double (*call)(const double* arguments);
};

double remainder_of(double a, double b) { return a - b * std::floor(a / b); }

constexpr Function kFunctions[] = {
    {"abs", 1, [](const double* a) { return std::abs(a[0]); }},
    {"acos", 1, [](const double* a) { return std::acos(a[0]) * kDegrees; }},
    {"asin", 1, [](const double* a) { return std::asin(a[0]) * kDegrees; }},
    {"atan", 1, [](const double* a) { return std::atan(a[0]) * kDegrees; }},
    {"atan2", 2, [](const double* a) { return std::atan2(a[0], a[1]) * kDegrees; }},
    {"cos", 1, [](const double* a) { return sincos_deg(a[0]).cos; }},
    {"floor", 1, [](const double* a) { return std::floor(a[0]); }},
    {"max", 2, [](const double* a) { return std::max(a[0], a[1]); }},
    {"min", 2, [](const double* a) { return std::min(a[0], a[1]); }},
    {"mod", 2, [](const double* a) { return remainder_of(a[0], a[1]); }},
    {"round", 1, [](const double* a) { return std::round(a[0]); }},
    {"sin", 1, [](const double* a) { return sincos_deg(a[0]).sin; }},
    {"sqrt", 1, [](const double* a) { return std::sqrt(a[0]); }},
    {"tan", 1, [](const double* a) { return sincos_deg(a[0]).sin / sincos_deg(a[0]).cos; }},
};
constexpr std::string_view kPi = "pi";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Recursive descent. After the first mistake every function returns 0 and reads no further.
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, const VariableValues& variables) : rest_(text), variables_(variables) {}

  double whole() {
    const double value = sum();
    if (wrong_.empty() && next() != '\0') fail("unexpected " + in_quotes(rest_));
    return value + 0.0;  // -0 becomes 0
  }
  const std::string& wrong() const { return wrong_; }

 private:
  double fail(std::string what) {
    if (wrong_.empty()) wrong_ = std::move(what);
    rest_ = {};
    return 0;
  }

  double finite(double value, std::string_view of) {
    return std::isfinite(value) ? value : fail("the result of " + std::string(of) + " is not finite");
  }

  // The next character that is no space, or '\0' at the end.
  char next() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size()));
    return rest_.empty() ? '\0' : rest_.front();
  }

  bool take(char c) {
    if (next() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }

  double sum() {
    double value = product();
    while (wrong_.empty()) {
      if (take('+')) {
        value = finite(value + product(), "+");
      } else if (take('-')) {
        value = finite(value - product(), "-");
      } else {
        return value;
      }
    }
    return 0;
  }

  double product() {
    double value = factor();
    while (wrong_.empty()) {
      if (take('*')) {
        value = finite(value * factor(), "*");
      } else if (take('/')) {
        const double divisor = factor();
        if (wrong_.empty() && divisor == 0) return fail("division by zero");
        value = finite(value / divisor, "/");
      } else {
        return value;
      }
    }
    return 0;
  }

  double factor() {
    if (depth_ == kMaxNestedTerms) return fail("it is nested deeper than " + std::to_string(kMaxNestedTerms));
    ++depth_;
    const double value = signed_factor();
    --depth_;
    return value;
  }

  double signed_factor() {
    if (take('-')) return -factor();
    if (take('+')) return factor();
    if (take('(')) {
      const double value = sum();
      if (wrong_.empty() && !take(')')) return fail("\"(\" without \")\"");
      return value;
    }
    const char c = next();
    if (is_digit(c) || c == '.') return number();
    if (is_letter(c)) return name();
    return fail(c == '\0' ? "it ends where a value is expected" : "unexpected " + in_quotes(rest_));
  }

  double number() {
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error == std::errc::result_out_of_range) return fail("a number is out of range");
    if (error != std::errc()) return fail("unexpected " + in_quotes(rest_));
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

  double name() {
    const auto end = std::ranges::find_if(rest_, [](char c) { return !is_letter(c) && !is_digit(c); });
    const std::string_view name = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(name.size());
    if (take('(')) return call(name);
    if (name == kPi) return glm::pi<double>();
    if (const auto found = variables_.find(name); found != variables_.end()) return found->second;
    std::vector<std::string_view> known{kPi};
    for (const auto& [variable, value] : variables_) known.push_back(variable);
    return fail("there is no variable " + in_quotes(name) + suggestion(name, known));
  }

  double call(std::string_view name) {
    const auto* const function = std::ranges::find(kFunctions, name, &Function::name);
    if (function == std::end(kFunctions)) return unknown_function(name);
    double arguments[2] = {0, 0};
    for (std::size_t i = 0; i < function->arguments; ++i) {
      if (i > 0 && !take(',')) return wrong_count(*function);
      arguments[i] = sum();
      if (!wrong_.empty()) return 0;
    }
    if (!take(')')) return wrong_count(*function);
    return finite(function->call(arguments), name);
  }

  double wrong_count(const Function& function) {
    return fail(std::string(function.name) + " takes " + std::to_string(function.arguments) +
                (function.arguments == 1 ? " value" : " values, separated by \",\",") + " and a \")\" after it");
  }

  double unknown_function(std::string_view name) {
    std::vector<std::string_view> known;
    std::string list;
    for (const Function& function : kFunctions) {
      known.push_back(function.name);
      list += (list.empty() ? "" : ", ") + std::string(function.name);
    }
    return fail("there is no function " + in_quotes(name) + suggestion(name, known) + " (expected one of: " + list +
                ")");
  }

  std::string_view rest_;
  const VariableValues& variables_;
  std::string wrong_;
  int depth_ = 0;
};

}  // namespace

std::string evaluate(std::string_view text, const VariableValues& variables, double& value) {
  ExpressionParser parser(text, variables);
  value = parser.whole();
  return parser.wrong();
}

std::string substitute(std::string& text, const VariableValues& variables) {
  std::string result;
  for (std::string_view rest = text;;) {
    const std::size_t begin = rest.find(kBegin);
    result += rest.substr(0, begin);
    if (begin == rest.npos) break;
    const std::size_t end = rest.find('}', begin);
    if (end == rest.npos) return "\"${\" without \"}\"";
    const std::string_view expression = rest.substr(begin + kBegin.size(), end - begin - kBegin.size());
    double value = 0;
    const std::string wrong = evaluate(expression, variables, value);
    if (!wrong.empty()) return in_quotes(rest.substr(begin, end + 1 - begin)) + ": " + wrong;
    result += format_number(value);
    rest.remove_prefix(end + 1);
  }
  text = std::move(result);
  return "";
}

bool is_variable_name(std::string_view name) {
  const bool made_of = !name.empty() && !is_digit(name.front()) &&
                       std::ranges::all_of(name, [](char c) { return is_letter(c) || is_digit(c); });
  return made_of && name != kPi && std::ranges::count(kFunctions, name, &Function::name) == 0;
}

}  // namespace simvis
